//! What a picture is made with.

use glam::Vec3;
use std::num::NonZeroUsize;

/// The gradient around the scene, which also lights it gently. Linear sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Straight up.
    pub zenith: Vec3,
    /// At eye level.
    pub horizon: Vec3,
    /// Straight down.
    pub ground: Vec3,
    /// Irradiance from this sky, as a factor on its colours; 0 leaves shadows black.
    pub ambient: f32,
}

impl Default for Sky {
    fn default() -> Self {
        Self {
            zenith: Vec3::new(0.30, 0.46, 0.72),
            horizon: Vec3::new(0.80, 0.86, 0.92),
            ground: Vec3::new(0.36, 0.36, 0.37),
            ambient: 0.55,
        }
    }
}

impl Sky {
    /// What a ray sees that leaves the scene; `height` is the cosine between its direction and up.
    pub(crate) fn radiance(&self, height: f32) -> Vec3 {
        // The square root makes the band near the horizon narrow, as haze does.
        let far = if height >= 0.0 { self.zenith } else { self.ground };
        self.horizon.lerp(far, height.abs().min(1.0).sqrt())
    }

    /// Irradiance on a surface whose normal has this cosine with up.
    pub(crate) fn irradiance(&self, height: f32) -> Vec3 {
        let (above, below) = (0.5 * (self.zenith + self.horizon), 0.5 * (self.ground + self.horizon));
        below.lerp(above, 0.5 + 0.5 * height.clamp(-1.0, 1.0)) * self.ambient
    }
}

/// Size, quality and surroundings of a picture.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RenderSettings {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Samples per pixel; powers of two are stratified best.
    pub samples: u32,
    /// How often a ray may be mirrored or refracted.
    pub max_depth: u32,
    /// A mirrored or refracted ray with less influence on the pixel than this (0 to 1) is not traced.
    pub min_contribution: f32,
    /// Ambient occlusion rays per primary hit, for soft shading in corners; 0 takes the ambient light as it is.
    pub occlusion: u32,
    /// What surrounds the scene.
    pub sky: Sky,
    /// Threads to render with; `None` uses the current rayon pool. The picture is the same at any count.
    pub threads: Option<NonZeroUsize>,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            width: 1024,
            height: 1024,
            samples: 4,
            max_depth: 5,
            min_contribution: 1.0 / 256.0,
            // Four a pixel: two each look hardly better and cost up to a third of the time.
            occlusion: 1,
            sky: Sky::default(),
            threads: None,
        }
    }
}

impl RenderSettings {
    /// The defaults at another size, pixels.
    pub fn sized(width: u32, height: u32) -> Self {
        Self { width, height, ..Self::default() }
    }
}
