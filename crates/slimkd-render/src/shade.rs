//! What a ray sees: Whitted, *An Improved Illumination Model for Shaded Display*, CACM 23(6), 1980, with Blinn-Phong
//! highlights and exact dielectric Fresnel.
//!
//! Conventions:
//! 1. A white surface that faces an irradiance of 1 shows 1: the factor 1/π sits in the lights' units.
//! 2. A material's light splits into mirror reflection (`reflection`), dielectric (`transmission` of the rest, split
//!    again by Fresnel) and diffuse (what remains); the highlight is added unsplit.
//! 3. Glass does not tint. Shadow rays go straight on through it, and each surface lets `transmission` pass.

use crate::fresnel::{dielectric_reflectance, refract};
use crate::settings::RenderSettings;
use crate::surface::Surface;
use glam::Vec3;
use slimkd::{Hit, KdTree, Ray};
use slimkd_scene::{Light, Material, Scene};

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
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path {
    /// Which of the tile's pixels it adds to.
    pub(crate) pixel: usize,
    /// Mirrored or refracted how often.
    pub(crate) depth: u32,
    /// Its influence on the pixel, 0 to 1.
    pub(crate) weight: f32,
    /// Random bits of this pixel.
    pub(crate) seed: u32,
}

/// What a ray has found.
pub(crate) struct Seen<'a> {
    pub(crate) path: Path,
    /// Of the ray, unit length.
    pub(crate) direction: Vec3,
    pub(crate) surface: Surface,
    pub(crate) material: &'a Material,
}

/// Where a ray goes on.
pub(crate) type Onward = Option<(Ray, Path)>;

impl Shader<'_> {
    /// What a ray finds where it hits; `None` on a triangle without an area.
    pub(crate) fn seen(&self, ray: &Ray, path: Path, hit: &Hit) -> Option<Seen<'_>> {
        let direction = ray.direction.into();
        let surface = Surface::new(self.scene, self.tree.mesh(), hit, direction)?;
        Some(Seen { path, direction, surface, material: self.material(hit.triangle) })
    }

    /// Radiance from where nothing is.
    pub(crate) fn sky(&self, direction: Vec3) -> Vec3 {
        self.settings.sky.radiance(direction.dot(self.up))
    }

    /// The material of a triangle.
    pub(crate) fn material(&self, triangle: u32) -> &Material {
        if self.scene.materials.is_empty() { &self.fallback } else { self.scene.material(triangle) }
    }

    /// The refracted and the mirrored ray.
    pub(crate) fn onward(&self, seen: &Seen<'_>) -> (Onward, Onward) {
        let Seen { path, direction, surface, material } = seen;
        if path.depth >= self.settings.max_depth {
            return (None, None);
        }
        let (direction, mut refraction) = (*direction, None);
        let [mut mirrored, transmission, _] = shares(material);
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
                    refraction = self.follow(surface, refracted, path, transmission * (1.0 - fresnel));
                }
            }
        }
        let mut reflected = direction.reflect(surface.shading);
        if reflected.dot(surface.geometric) <= 0.0 {
            reflected = direction.reflect(surface.geometric);
        }
        (refraction, self.follow(surface, reflected, path, mirrored))
    }

    /// A secondary ray, if it matters enough.
    fn follow(&self, surface: &Surface, direction: Vec3, path: &Path, share: f32) -> Onward {
        let weight = path.weight * share;
        if share <= 0.0 || weight < self.settings.min_contribution {
            return None;
        }
        let direction = direction.normalize();
        let ray = Ray::new(surface.start(direction), direction);
        Some((ray, Path { depth: path.depth + 1, weight, ..*path }))
    }

    /// The diffuse colour where a ray hit, times its share.
    pub(crate) fn diffuse(&self, seen: &Seen<'_>) -> Vec3 {
        let material = seen.material;
        let texture = material.texture.and_then(|index| self.scene.textures.get(index as usize));
        let colour = match (texture, seen.surface.uv) {
            (Some(texture), Some(uv)) => material.diffuse * texture.sample(uv),
            _ => material.diffuse,
        };
        colour * shares(material)[2]
    }

    /// What a light would add if nothing stood before it, and the ray that finds out; `None` when it adds nothing.
    pub(crate) fn lit(&self, light: &Light, seen: &Seen<'_>, diffuse: Vec3) -> Option<(Vec3, Ray)> {
        let Seen { path, direction, surface, material } = seen;
        let (towards, distance, irradiance) = arriving(light, surface.position)?;
        let cos = surface.shading.dot(towards);
        if cos <= 0.0 || surface.geometric.dot(towards) <= 0.0 {
            return None;
        }
        let half = (towards - *direction).normalize_or(surface.shading);
        let highlight = surface.shading.dot(half).max(0.0).powf(material.shininess.max(1.0));
        let radiance = irradiance * (diffuse * cos + material.specular * highlight);
        if radiance.max_element() * path.weight <= 0.0 {
            return None;
        }
        let origin = surface.outer();
        // From the point where the ray really starts, so that it ends at the light; the end is pulled in because a
        // lamp may stand on a surface.
        let ray = match light {
            Light::Directional { .. } => Ray::new(origin, towards).with_range(0.0, distance),
            Light::Point { position, .. } => Ray::new(origin, *position - origin).with_range(0.0, 1.0 - 1e-4),
        };
        Some((radiance, ray))
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
