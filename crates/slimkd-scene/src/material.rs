//! Whitted-style materials and their textures.

use glam::{Vec2, Vec3};

/// What a surface looks like. Colours are linear sRGB, 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the file, or empty.
    pub name: String,
    /// Diffuse colour.
    pub diffuse: Vec3,
    /// Index of the diffuse texture in [`crate::Scene::textures`]; multiplies `diffuse`.
    pub texture: Option<u32>,
    /// Blinn-Phong specular colour.
    pub specular: Vec3,
    /// Blinn-Phong exponent, 1 and up.
    pub shininess: f32,
    /// Share of mirror reflection, 0 to 1.
    pub reflection: f32,
    /// Share of refracted transmission, 0 (opaque) to 1; Fresnel splits it.
    pub transmission: f32,
    /// Index of refraction, for `transmission > 0`.
    pub ior: f32,
    /// Light that it gives off by itself.
    pub emission: Vec3,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            diffuse: Vec3::splat(0.7),
            texture: None,
            specular: Vec3::ZERO,
            shininess: 32.0,
            reflection: 0.0,
            transmission: 0.0,
            ior: 1.5,
            emission: Vec3::ZERO,
        }
    }
}

/// An sRGB-decoded texture, repeated in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Linear RGB, rows from the top.
    pub texels: Vec<[f32; 3]>,
}

impl Texture {
    /// Bilinear sample at `uv`; (0, 0) is the lower left corner.
    pub fn sample(&self, uv: Vec2) -> Vec3 {
        if self.texels.is_empty() || !uv.is_finite() {
            return Vec3::ONE;
        }
        let x = (uv.x - uv.x.floor()) * self.width as f32 - 0.5;
        let y = (1.0 - (uv.y - uv.y.floor())) * self.height as f32 - 0.5;
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let at = |dx: i64, dy: i64| {
            let column = (x0 as i64 + dx).rem_euclid(i64::from(self.width));
            let row = (y0 as i64 + dy).rem_euclid(i64::from(self.height));
            Vec3::from(self.texels[(row * i64::from(self.width) + column) as usize])
        };
        at(0, 0).lerp(at(1, 0), fx).lerp(at(0, 1).lerp(at(1, 1), fx), fy)
    }
}
