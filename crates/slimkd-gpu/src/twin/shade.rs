//! `shaders/shade.wgsl` in Rust.

use super::picture::Picture;
use super::surface::Surface;
use glam::{Vec2, Vec3, Vec4};
use slimkd::Ray;

const MATERIAL: u32 = 16;

pub(super) fn hash(x: u32, y: u32, z: u32) -> u32 {
    let pcg = |v: u32| {
        let state = v.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let mixed = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        (mixed >> 22) ^ mixed
    };
    pcg(x.wrapping_add(pcg(y.wrapping_add(pcg(z)))))
}

fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}

pub(super) fn stratified(seed: u32, index: u32, count: u32) -> Vec2 {
    let x = (index as f32 + unit(hash(seed, index, 1))) / count as f32;
    Vec2::new(x.min(1.0 - f32::EPSILON), unit(index.reverse_bits() ^ hash(seed, 0, 2)))
}

impl Picture<'_> {
    pub(super) fn sky_radiance(&self, height: f32) -> Vec3 {
        let far = if height >= 0.0 { self.frame.zenith } else { self.frame.ground };
        rgb(self.frame.horizon).lerp(rgb(far), height.abs().min(1.0).sqrt())
    }

    pub(super) fn sky_irradiance(&self, height: f32) -> Vec3 {
        let [zenith, horizon, ground] = [self.frame.zenith, self.frame.horizon, self.frame.ground].map(rgb);
        let (above, below) = (0.5 * (zenith + horizon), 0.5 * (ground + horizon));
        below.lerp(above, 0.5 + 0.5 * height.clamp(-1.0, 1.0)) * self.frame.zenith[3]
    }

    /// Word of a triangle's material.
    pub(super) fn material(&self, triangle: u32) -> u32 {
        let frame = self.frame;
        let known = triangle < frame.material_id_count;
        let id = if known { self.twin.word(frame.material_ids + triangle) } else { 0 };
        frame.materials + MATERIAL * id
    }

    pub(super) fn float(&self, at: u32) -> f32 {
        self.twin.float(at)
    }

    pub(super) fn colour(&self, at: u32) -> Vec3 {
        self.twin.floats(at).into()
    }

    fn texture(&self, texture: u32, uv: Vec2) -> Vec3 {
        let record = self.frame.textures + 4 * texture;
        let [first, width, height] = self.twin.triple(record);
        if width == 0 || height == 0 || !uv.is_finite() {
            return Vec3::ONE;
        }
        let x = (uv.x - uv.x.floor()) * width as f32 - 0.5;
        let y = (1.0 - (uv.y - uv.y.floor())) * height as f32 - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let texel = |dx: i32, dy: i32| {
            let column = (left as i32 + dx).rem_euclid(width as i32) as u32;
            let row = (top as i32 + dy).rem_euclid(height as i32) as u32;
            self.colour(self.frame.textures + first + 3 * (row * width + column))
        };
        let upper = texel(0, 0).lerp(texel(1, 0), x - left);
        upper.lerp(texel(0, 1).lerp(texel(1, 1), x - left), y - top)
    }

    /// The diffuse colour times its share.
    pub(super) fn diffuse(&self, material: u32, surface: &Surface) -> Vec3 {
        let mut colour = self.colour(material);
        let texture = self.twin.word(material + 3);
        if let (true, Some(uv)) = (texture != u32::MAX, surface.uv) {
            colour *= self.texture(texture, uv);
        }
        colour * self.float(material + 14)
    }

    /// What a light would add if nothing stood before it, and the ray that finds out.
    pub(super) fn lit(
        &self,
        light: &[f32; 8],
        material: u32,
        surface: &Surface,
        direction: Vec3,
        diffuse: Vec3,
        weight: f32,
    ) -> Option<(Vec3, Ray)> {
        let place = Vec3::new(light[1], light[2], light[3]);
        let mut irradiance = Vec3::new(light[4], light[5], light[6]);
        let near = light[0] == 0.0;
        let mut towards = place;
        if near {
            let way = place - surface.position;
            towards = way.try_normalize()?;
            irradiance /= way.dot(towards).powi(2).max(f32::MIN_POSITIVE);
        }
        let cosine = surface.shading.dot(towards);
        if cosine <= 0.0 || surface.geometric.dot(towards) <= 0.0 {
            return None;
        }
        let half = (towards - direction).normalize_or(surface.shading);
        let highlight = surface.shading.dot(half).clamp(0.0, 1.0).powf(self.float(material + 7));
        let seen = irradiance * (diffuse * cosine + self.colour(material + 4) * highlight);
        if seen.max_element() * weight <= 0.0 {
            return None;
        }
        let origin = surface.lifted();
        let ray = if near {
            Ray::new(origin, place - origin).with_range(0.0, 0.9999)
        } else {
            Ray::new(origin, towards)
        };
        Some((seen, ray))
    }

    /// Direction number `index` of a pixel's ambient occlusion.
    pub(super) fn occlusion_direction(&self, surface: &Surface, seed: u32, index: u32) -> Vec3 {
        let point = stratified(seed, index, self.frame.occlusion * self.frame.samples);
        let (tangent, bitangent) = (surface.shading + Vec3::ZERO).any_orthonormal_pair();
        let (sine, cosine) = (point.y * std::f32::consts::TAU).sin_cos();
        let flat = (tangent * cosine + bitangent * sine) * point.x.sqrt();
        flat + surface.shading * (1.0 - point.x).max(0.0).sqrt()
    }
}

pub(super) fn rgb(v: [f32; 4]) -> Vec3 {
    Vec4::from(v).truncate()
}
