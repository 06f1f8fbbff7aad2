//! How far loading has come, and how to stop it, from any thread.

use super::LoadError;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

/// Shared between a running load and whoever watches it.
///
/// ```
/// use slimkd_scene::{LoadError, LoadOptions, LoadProgress, load_with};
/// let progress = LoadProgress::new();
/// progress.cancel();
/// let error = load_with("missing.ply", &LoadOptions::new(), &progress).unwrap_err();
/// assert!(matches!(error, LoadError::Cancelled));
/// ```
#[derive(Debug, Default)]
pub struct LoadProgress {
    /// Millionths done.
    done: AtomicU32,
    cancelled: AtomicBool,
}

impl LoadProgress {
    /// Nothing done, not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Share of the work that is done, 0 to 1; never falls, and is 1 once the scene is there.
    pub fn fraction(&self) -> f64 {
        f64::from(self.done.load(Relaxed)) / 1e6
    }

    /// Asks the load to end with [`LoadError::Cancelled`] soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
    }

    /// True once [`LoadProgress::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    pub(super) fn set(&self, fraction: f64) {
        self.done.fetch_max((fraction.clamp(0.0, 1.0) * 1e6) as u32, Relaxed);
    }

    /// Notes `fraction`, and ends the load if it was cancelled.
    pub(super) fn reach(&self, fraction: f64) -> Result<(), LoadError> {
        if self.is_cancelled() {
            return Err(LoadError::Cancelled);
        }
        self.set(fraction);
        Ok(())
    }

    /// Like [`LoadProgress::reach`], for `done` of `total` steps of the parse that follows reading.
    pub(super) fn parsed(&self, done: usize, total: usize) -> Result<(), LoadError> {
        self.reach(READ_SHARE + (1.0 - READ_SHARE) * done as f64 / total.max(1) as f64)
    }
}

/// Share of the whole that reading and decompressing takes; of a zstd PLY it is some 80 %, of plain files little.
pub(super) const READ_SHARE: f64 = 0.6;
