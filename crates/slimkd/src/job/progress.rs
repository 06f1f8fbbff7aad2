//! How far a build, or other long work, has come, and how to stop it, from any thread.
//!
//! A build goes through phases (`pace.rs`), each with its share of the whole. What a phase adds never goes beyond its end, so a
//! share that was estimated too small costs a standstill, never a step back.

use crate::options::BuildError;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// 1.0 in fixed point: fine enough that a million additions do not round visibly.
const ONE: f64 = (1u64 << 50) as f64;
/// Indices between two looks of loops over a whole tree: some 20 µs of them.
const INDICES_A_LOOK: usize = 1 << 12;

/// Shared between a running build and whoever watches it; loading a scene and rendering a picture take one too.
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
    /// Where the phase at hand ends, in the same units.
    end: AtomicU64,
    /// What [`Progress::check_at`] adds, in the same units.
    step: AtomicU64,
    cancelled: AtomicBool,
}

impl Progress {
    /// Nothing done, not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Share of the work that is done, 0 to 1, in proportion to its time as far as that can be told; never falls, and is 1 once
    /// the tree is there.
    pub fn fraction(&self) -> f64 {
        (self.done.load(Relaxed) as f64 / ONE).min(1.0)
    }

    /// Asks the work to end soon: a build ends with [`BuildError::Cancelled`].
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
    }

    /// True once [`Progress::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    /// Says how far work other than a build has come, 0 to 1; for whoever does that work.
    pub fn set(&self, fraction: f64) {
        self.done.fetch_max(units(fraction.min(1.0)), Relaxed);
    }

    /// Ends the phase at hand, and begins one that takes that share of the whole.
    pub(crate) fn begin(&self, share: f64) {
        self.begin_loops(share, 0);
    }

    /// [`Progress::begin`] of a phase whose loops call [`Progress::check_at`] with about so many indices in all.
    pub(crate) fn begin_loops(&self, share: f64, indices: usize) {
        let start = self.end.load(Relaxed);
        self.done.fetch_max(start, Relaxed);
        // Only a tree that is there is all.
        let end = (start + units(share)).min(ONE as u64 - 1);
        self.end.store(end, Relaxed);
        let steps = indices as f64 / INDICES_A_LOOK as f64;
        self.step.store(if indices == 0 { 0 } else { units(share / steps.max(1.0)) }, Relaxed);
    }

    /// Adds a share of the whole work, 0 to 1.
    pub(crate) fn advance(&self, share: f64) {
        self.add(units(share));
    }

    fn add(&self, units: u64) {
        let end = self.end.load(Relaxed);
        let more = |done: u64| (units > 0 && done < end).then(|| end.min(done + units));
        // Nothing to add is no failure.
        let _ = self.done.fetch_update(Relaxed, Relaxed, more);
    }

    /// All is done, whatever rounding left.
    pub(crate) fn finish(&self) {
        self.set(1.0);
    }

    /// [`Progress::check`] now and then: for loops over a whole tree, which call it with their index.
    #[inline]
    pub(crate) fn check_at(&self, index: usize) -> Result<(), BuildError> {
        if !index.is_multiple_of(INDICES_A_LOOK) {
            return Ok(());
        }
        if index > 0 {
            self.add(self.step.load(Relaxed));
        }
        self.check()
    }

    /// An error once the build was cancelled.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        if self.is_cancelled() { Err(BuildError::Cancelled) } else { Ok(()) }
    }
}

fn units(share: f64) -> u64 {
    (share.max(0.0) * ONE) as u64
}
