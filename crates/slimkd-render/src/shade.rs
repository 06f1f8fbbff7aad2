//! What a ray sees: Whitted, *An Improved Illumination Model for Shaded Display*, CACM 23(6), 1980, with Blinn-Phong
//! highlights and exact dielectric Fresnel.
//!
//! Conventions:
//! 1. A white surface that faces an irradiance of 1 shows 1: the factor 1/π sits in the lights' units.
//! 2. A material's light splits into mirror reflection (`reflection`), dielectric (`transmission` of the rest, split
//!    again by Fresnel) and diffuse (what remains); the highlight is added unsplit.
//! 3. Glass does not tint. Shadow rays go straight on through it, and each surface lets `transmission` pass.

use crate::fresnel::{dielectric_reflectance, refract};
use crate::progress::RenderStatistics;
use crate::sampling;
use crate::settings::RenderSettings;
use crate::surface::Surface;
use glam::Vec3;
use slimkd::{Hit, KdTree, Ray};
use slimkd_scene::{Light, Material, Scene};

/// Transparent surfaces that a shadow ray may pass before it counts as blocked.
const MAX_TRANSPARENT: u32 = 32;

/// Everything that shading reads; shared by all threads.
pub(crate) struct Shader<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) tree: &'a KdTree,
    pub(crate) lights: &'a [Light],
    pub(crate) settings: &'a RenderSettings,
    /// Unit vector.
    pub(crate) up: Vec3,
    /// Whether any material lets shadow rays pass.
    pub(crate) transparent: bool,
    /// Stands in when a scene has no material.
    pub(crate) fallback: Material,
    /// How far ambient occlusion reaches, scene units.
    pub(crate) occlusion_reach: f32,
}

/// A ray's place in the tree of rays of a sample.
#[derive(Clone, Copy)]
pub(crate) struct Path {
    /// Mirrored or refracted how often.
    pub(crate) depth: u32,
    /// Its influence on the pixel, 0 to 1.
    pub(crate) weight: f32,
    /// Random bits of this pixel.
    pub(crate) seed: u32,
    /// Which of the pixel's samples it belongs to.
    pub(crate) sample: u32,
}

impl Shader<'_> {
    /// Radiance that arrives along `ray`, whose direction has unit length.
    pub(crate) fn radiance(
        &self,
        ray: &Ray,
        hit: Option<&Hit>,
        path: Path,
        rays: &mut RenderStatistics,
    ) -> Vec3 {
        let direction = Vec3::from(ray.direction);
        match hit.and_then(|hit| Some((hit, self.surface(ray, hit)?))) {
            Some((hit, surface)) => self.shade(direction, hit, &surface, path, None, rays),
            None => self.sky(direction),
        }
    }

    /// What a ray finds where it hits; `None` on a triangle without an area.
    pub(crate) fn surface(&self, ray: &Ray, hit: &Hit) -> Option<Surface> {
        Surface::new(self.scene, self.tree.mesh(), hit, ray.direction.into())
    }

    /// Radiance from where nothing is.
    pub(crate) fn sky(&self, direction: Vec3) -> Vec3 {
        self.settings.sky.radiance(direction.dot(self.up))
    }

    /// Radiance that leaves a surface against `direction`. `blocked` says for each light whether something stands before
    /// it, where the caller knows.
    pub(crate) fn shade(
        &self,
        direction: Vec3,
        hit: &Hit,
        surface: &Surface,
        path: Path,
        blocked: Option<&[bool]>,
        rays: &mut RenderStatistics,
    ) -> Vec3 {
        let material = self.material(hit.triangle);
        let [reflection, transmission, opaque] = shares(material);

        let direct = self.direct(material, surface, direction, opaque, path, blocked, rays);
        let mut colour = material.emission + direct;
        if path.depth >= self.settings.max_depth {
            return colour;
        }
        let mut mirrored = reflection;
        if transmission > 0.0 {
            let ior = if material.ior.is_finite() && material.ior > 0.0 { material.ior } else { 1.0 };
            let eta = if surface.outside { ior } else { 1.0 / ior };
            match refract(direction, surface.shading, eta) {
                None => mirrored += transmission,
                Some(refracted) => {
                    let fresnel = dielectric_reflectance(-direction.dot(surface.shading), eta);
                    mirrored += transmission * fresnel;
                    // Below the shading normal's horizon but above the triangle's: straight on.
                    let through = refracted.dot(surface.geometric) < 0.0;
                    let refracted = if through { refracted } else { direction };
                    let share = transmission * (1.0 - fresnel);
                    if path.weight * share >= self.settings.min_contribution {
                        rays.refraction += 1;
                        colour += share * self.follow(surface, refracted, path, share, rays);
                    }
                }
            }
        }
        if mirrored > 0.0 && path.weight * mirrored >= self.settings.min_contribution {
            rays.reflection += 1;
            let mut reflected = direction.reflect(surface.shading);
            if reflected.dot(surface.geometric) <= 0.0 {
                reflected = direction.reflect(surface.geometric);
            }
            colour += mirrored * self.follow(surface, reflected, path, mirrored, rays);
        }
        colour
    }

    /// The material of a triangle.
    fn material(&self, triangle: u32) -> &Material {
        if self.scene.materials.is_empty() { &self.fallback } else { self.scene.material(triangle) }
    }

    /// Radiance along a secondary ray.
    fn follow(
        &self,
        surface: &Surface,
        direction: Vec3,
        path: Path,
        share: f32,
        rays: &mut RenderStatistics,
    ) -> Vec3 {
        let direction = direction.normalize();
        let ray = Ray::new(surface.start(direction), direction);
        let hit = self.tree.closest_hit(&ray);
        let path = Path { depth: path.depth + 1, weight: path.weight * share, ..path };
        self.radiance(&ray, hit.as_ref(), path, rays)
    }

    /// Light from the lights and the sky; `opaque` is the diffuse share.
    #[allow(clippy::too_many_arguments)]
    fn direct(
        &self,
        material: &Material,
        surface: &Surface,
        direction: Vec3,
        opaque: f32,
        path: Path,
        blocked: Option<&[bool]>,
        rays: &mut RenderStatistics,
    ) -> Vec3 {
        let diffuse = self.diffuse(material, surface, opaque);
        let mut colour = Vec3::ZERO;
        if diffuse != Vec3::ZERO {
            let ambient = self.settings.sky.irradiance(surface.shading.dot(self.up));
            colour = diffuse * ambient * self.openness(surface, path, rays);
        }
        for (index, light) in self.lights.iter().enumerate() {
            let Some((seen, ray)) = self.lit(light, material, surface, direction, diffuse, path.weight)
            else {
                continue;
            };
            colour += seen
                * match blocked {
                    Some(blocked) => f32::from(!blocked[index]),
                    None => self.visibility(ray, rays),
                };
        }
        colour
    }

    /// The diffuse colour where the ray hit, times its share.
    fn diffuse(&self, material: &Material, surface: &Surface, opaque: f32) -> Vec3 {
        let texture = material.texture.and_then(|index| self.scene.textures.get(index as usize));
        let colour = match (texture, surface.uv) {
            (Some(texture), Some(uv)) => material.diffuse * texture.sample(uv),
            _ => material.diffuse,
        };
        colour * opaque
    }

    /// What a light would add if nothing stood before it, and the ray that finds out; `None` when it adds nothing.
    fn lit(
        &self,
        light: &Light,
        material: &Material,
        surface: &Surface,
        direction: Vec3,
        diffuse: Vec3,
        weight: f32,
    ) -> Option<(Vec3, Ray)> {
        let (towards, distance, irradiance) = arriving(light, surface.position)?;
        let cos = surface.shading.dot(towards);
        if cos <= 0.0 || surface.geometric.dot(towards) <= 0.0 {
            return None;
        }
        let half = (towards - direction).normalize_or(surface.shading);
        let highlight = surface.shading.dot(half).max(0.0).powf(material.shininess.max(1.0));
        let seen = irradiance * (diffuse * cos + material.specular * highlight);
        if seen.max_element() * weight <= 0.0 {
            return None;
        }
        let origin = surface.shadow_origin + surface.geometric * surface.offset;
        // From the point where the ray really starts, so that it ends at the light; the end is pulled in because a
        // lamp may stand on a surface.
        let ray = match light {
            Light::Directional { .. } => Ray::new(origin, towards).with_range(0.0, distance),
            Light::Point { position, .. } => Ray::new(origin, *position - origin).with_range(0.0, 1.0 - 1e-4),
        };
        Some((seen, ray))
    }

    /// The rays that a picture's first hits send to light `index`, where blocked or not is all that matters: not when
    /// something transparent may stand in the way.
    pub(crate) fn shadow_ray(
        &self,
        index: usize,
        direction: Vec3,
        hit: &Hit,
        surface: &Surface,
    ) -> Option<Ray> {
        let material = self.material(hit.triangle);
        let diffuse = self.diffuse(material, surface, shares(material)[2]);
        self.lit(&self.lights[index], material, surface, direction, diffuse, 1.0).map(|(_, ray)| ray)
    }

    /// Share of a light that arrives along a shadow ray.
    fn visibility(&self, mut ray: Ray, rays: &mut RenderStatistics) -> f32 {
        if !self.transparent {
            rays.shadow += 1;
            return if self.tree.any_hit(&ray) { 0.0 } else { 1.0 };
        }
        // Asking for any hit first would save nothing: what blocks must be known, and a free way costs the same.
        let mut visible = 1.0;
        for _ in 0..MAX_TRANSPARENT {
            rays.shadow += 1;
            let Some(hit) = self.tree.closest_hit(&ray) else { return visible };
            let material = self.material(hit.triangle);
            visible *= (1.0 - material.reflection.clamp(0.0, 1.0)) * material.transmission.clamp(0.0, 1.0);
            if visible < self.settings.min_contribution {
                return 0.0;
            }
            ray.t_min = hit.t.next_up();
        }
        0.0
    }

    /// Share of the ambient light that is not blocked nearby; 1 without occlusion rays and behind mirrors.
    fn openness(&self, surface: &Surface, path: Path, rays: &mut RenderStatistics) -> f32 {
        let count = self.settings.occlusion;
        if count == 0 || path.depth > 0 {
            return 1.0;
        }
        let total = count * self.settings.samples;
        let (tangent, bitangent) = surface.shading.any_orthonormal_pair();
        let mut open = 0.0;
        for index in 0..count {
            let point = sampling::stratified(path.seed, path.sample * count + index, total);
            // Cosine-weighted directions (Malley's method).
            let (radius, angle) = (point.x.sqrt(), point.y * std::f32::consts::TAU);
            let height = (1.0 - point.x).max(0.0).sqrt();
            let (sin, cos) = angle.sin_cos();
            let towards = (tangent * cos + bitangent * sin) * radius + surface.shading * height;
            if towards.dot(surface.geometric) <= 0.0 {
                continue;
            }
            rays.occlusion += 1;
            let origin = surface.shadow_origin + surface.geometric * surface.offset;
            // Blockers fade with distance, or else every room would be dark.
            let ray = Ray::new(origin, towards).with_range(0.0, self.occlusion_reach);
            open += self.tree.closest_hit(&ray).map_or(1.0, |hit| hit.t / self.occlusion_reach);
        }
        open / count as f32
    }
}

/// How a material splits light: mirrored, let through, diffuse.
fn shares(material: &Material) -> [f32; 3] {
    let reflection = material.reflection.clamp(0.0, 1.0);
    let transmission = (1.0 - reflection) * material.transmission.clamp(0.0, 1.0);
    [reflection, transmission, 1.0 - reflection - transmission]
}

/// Direction to the light, distance and irradiance at `position`; `None` when they coincide.
fn arriving(light: &Light, position: Vec3) -> Option<(Vec3, f32, Vec3)> {
    match *light {
        Light::Point { position: lamp, intensity } => {
            let towards = lamp - position;
            let distance = towards.length();
            let direction = towards.try_normalize()?;
            Some((direction, distance, intensity / (distance * distance).max(f32::MIN_POSITIVE)))
        }
        Light::Directional { direction, irradiance } => {
            Some(((-direction).try_normalize()?, f32::INFINITY, irradiance))
        }
    }
}
