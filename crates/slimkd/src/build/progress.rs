//! How far a build has come, and how to stop it, from any thread.

use super::BuildError;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// 1.0 in fixed point: fine enough that a million additions do not round visibly.
const ONE: f64 = (1u64 << 50) as f64;

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
    /// Share done, in units of 1 / [`ONE`].
    done: AtomicU64,
    cancelled: AtomicBool,
}

impl Progress {
    /// Nothing done, not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Share of the work that is done, 0 to 1; never falls, and is 1 once the tree is there.
    pub fn fraction(&self) -> f64 {
        (self.done.load(Relaxed) as f64 / ONE).min(1.0)
    }

    /// Asks the build to end with [`BuildError::Cancelled`] soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
    }

    /// True once [`Progress::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    /// Adds a share of the whole work, 0 to 1.
    pub(crate) fn advance(&self, share: f64) {
        self.done.fetch_add((share.max(0.0) * ONE) as u64, Relaxed);
    }

    /// All is done, whatever rounding left.
    pub(crate) fn finish(&self) {
        self.done.fetch_max(ONE as u64, Relaxed);
    }

    /// [`Progress::check`] now and then: for loops over a whole tree, which call it with their index.
    #[inline]
    pub(crate) fn check_at(&self, index: usize) -> Result<(), BuildError> {
        if index.is_multiple_of(1 << 16) { self.check() } else { Ok(()) }
    }

    /// An error once the build was cancelled.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        if self.is_cancelled() { Err(BuildError::Cancelled) } else { Ok(()) }
    }
}
