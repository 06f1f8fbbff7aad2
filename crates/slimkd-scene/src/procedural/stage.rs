//! What a scene says beside its geometry: views, lights, and where the last triangles may go.

use super::builder::{Builder, Paint};
use crate::{Camera, Light};
use glam::Vec3;

/// A flat box to scatter blades on: pile of a carpet, grass.
pub(crate) struct Filler {
    pub(crate) paint: Paint,
    /// Corners of the boxes; a blade stands on the lower side.
    pub(crate) areas: Vec<(Vec3, Vec3)>,
    /// Length of a blade, metres.
    pub(crate) length: f32,
    /// Width of a blade, metres.
    pub(crate) width: f32,
}

impl Filler {
    /// Emits exactly `count` triangles.
    pub(crate) fn fill(&self, b: &mut Builder, count: usize) {
        b.paint(self.paint);
        b.blades(count, self.width, |rng| {
            let (min, max) = self.areas[rng.below(self.areas.len() as u32) as usize];
            let lean = rng.direction() * 0.45;
            let way = Vec3::new(lean.x, 1.0, lean.z) * (self.length * rng.range(0.6, 1.0));
            (rng.point(min, max).with_y(min.y), way)
        });
    }
}

/// See the module's head.
pub(crate) struct Stage {
    pub(crate) cameras: Vec<Camera>,
    pub(crate) lights: Vec<Light>,
    pub(crate) filler: Filler,
}

/// A view with y upwards.
pub(crate) fn view(eye: [f32; 3], target: [f32; 3], fov: f32) -> Camera {
    Camera { eye: eye.into(), target: target.into(), up: Vec3::Y, fov }
}

/// A lamp that gives an irradiance of `color` at `reach` metres.
pub(crate) fn lamp(position: [f32; 3], reach: f32, color: [f32; 3]) -> Light {
    Light::Point { position: position.into(), intensity: Vec3::from(color) * (reach * reach) }
}

/// The sun, or the light of a whole sky side.
pub(crate) fn sun(direction: [f32; 3], color: [f32; 3]) -> Light {
    Light::Directional { direction: direction.into(), irradiance: color.into() }
}
