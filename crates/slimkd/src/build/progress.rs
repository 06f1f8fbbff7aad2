//! How far a build has come, and how to stop it, from any thread.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

/// Shared between a running build and whoever watches it.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, Progress, TriangleMesh};
/// let progress = Progress::new();
/// KdTree::build_with_progress(TriangleMesh::default(), &BuildOptions::default(), &progress)?;
/// assert_eq!(progress.fraction(), 1.0);
/// # Ok::<(), slimkd::BuildError>(())
/// ```
#[derive(Debug, Default)]
pub struct Progress {
    /// Millionths done.
    done: AtomicU32,
    cancelled: AtomicBool,
}

impl Progress {
    /// Nothing done, not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Share of the work that is done, 0 to 1; never falls, and is 1 once the tree is there.
    pub fn fraction(&self) -> f64 {
        f64::from(self.done.load(Relaxed)) / 1e6
    }

    /// Asks the build to end with [`super::BuildError::Cancelled`] soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
    }

    /// True once [`Progress::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    pub(crate) fn set(&self, fraction: f64) {
        self.done.fetch_max((fraction.clamp(0.0, 1.0) * 1e6) as u32, Relaxed);
    }
}
