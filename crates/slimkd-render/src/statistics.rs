//! How many rays a picture took.

use std::ops::AddAssign;

/// Rays by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RenderStatistics {
    /// From the camera.
    pub primary: u64,
    /// To lights; one more for every transparent surface that a shadow ray passes.
    pub shadow: u64,
    /// Mirrored, by mirrors and dielectrics.
    pub reflection: u64,
    /// Refracted into or out of dielectrics.
    pub refraction: u64,
    /// Short ones that measure ambient occlusion.
    pub occlusion: u64,
}

impl RenderStatistics {
    /// Rays of all kinds.
    pub fn total(&self) -> u64 {
        self.primary + self.shadow + self.reflection + self.refraction + self.occlusion
    }
}

impl AddAssign for RenderStatistics {
    fn add_assign(&mut self, more: Self) {
        self.primary += more.primary;
        self.shadow += more.shadow;
        self.reflection += more.reflection;
        self.refraction += more.refraction;
        self.occlusion += more.occlusion;
    }
}
