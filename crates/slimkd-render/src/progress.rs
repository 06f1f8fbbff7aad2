//! How far a picture has come, how to stop it, and how many rays it took.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering::Relaxed};

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

/// Shared between a running render and whoever watches it.
#[derive(Debug, Default)]
pub struct RenderProgress {
    /// Millionths done.
    done: AtomicU32,
    cancelled: AtomicBool,
    primary: AtomicU64,
    shadow: AtomicU64,
    reflection: AtomicU64,
    refraction: AtomicU64,
    occlusion: AtomicU64,
}

impl RenderProgress {
    /// Nothing done, not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Share of the tiles that are done, 0 to 1; never falls, and is 1 once the picture is there.
    pub fn fraction(&self) -> f64 {
        f64::from(self.done.load(Relaxed)) / 1e6
    }

    /// Asks the render to end with [`crate::RenderError::Cancelled`] soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
    }

    /// True once [`RenderProgress::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    /// Rays traced so far; whole tiles only, so exact once the picture is there.
    pub fn statistics(&self) -> RenderStatistics {
        RenderStatistics {
            primary: self.primary.load(Relaxed),
            shadow: self.shadow.load(Relaxed),
            reflection: self.reflection.load(Relaxed),
            refraction: self.refraction.load(Relaxed),
            occlusion: self.occlusion.load(Relaxed),
        }
    }

    /// Says how far the picture is, 0 to 1; for whoever renders it.
    pub fn set(&self, fraction: f64) {
        self.done.fetch_max((fraction.clamp(0.0, 1.0) * 1e6) as u32, Relaxed);
    }

    /// Adds rays to the statistics; for whoever traces them.
    pub fn count(&self, rays: &RenderStatistics) {
        self.primary.fetch_add(rays.primary, Relaxed);
        self.shadow.fetch_add(rays.shadow, Relaxed);
        self.reflection.fetch_add(rays.reflection, Relaxed);
        self.refraction.fetch_add(rays.refraction, Relaxed);
        self.occlusion.fetch_add(rays.occlusion, Relaxed);
    }
}
