//! How far work of many pieces has come, and how to stop it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};

/// Shared between running measurements and whoever watches them.
#[derive(Default)]
pub struct Progress {
    /// What all pieces weigh, in any unit; only ratios count.
    total: AtomicU64,
    done: AtomicU64,
    cancelled: AtomicBool,
    /// The piece at hand, if it listens to a cancel of its own.
    piece: Mutex<Option<Arc<slimkd::Progress>>>,
}

impl Progress {
    /// Nothing done, not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Share of the work that is done, 0 to 1, by estimates of what each piece takes.
    pub fn fraction(&self) -> f64 {
        (self.done.load(Relaxed) as f64 / self.total.load(Relaxed).max(1) as f64).min(1.0)
    }

    /// Asks the work to end with [`crate::ReportError::Cancelled`] soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
        if let Some(piece) = &*self.piece.lock().unwrap_or_else(PoisonError::into_inner) {
            piece.cancel();
        }
    }

    /// True once [`Progress::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    /// An error once the work was cancelled.
    pub(crate) fn check(&self) -> Result<(), crate::basics::ReportError> {
        if self.is_cancelled() { Err(crate::basics::ReportError::Cancelled) } else { Ok(()) }
    }

    /// More work is known of.
    pub(crate) fn expect(&self, weight: u64) {
        self.total.fetch_add(weight, Relaxed);
    }

    pub(crate) fn done(&self, weight: u64) {
        self.done.fetch_add(weight, Relaxed);
    }

    /// All is there, measured now or before.
    pub(crate) fn finish(&self) {
        let total = self.total.fetch_max(1, Relaxed).max(1);
        self.done.store(total, Relaxed);
    }

    /// The progress of one piece, a build or a picture, which is cancelled with the whole.
    pub fn piece(&self) -> Arc<slimkd::Progress> {
        let progress = Arc::new(slimkd::Progress::new());
        *self.piece.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::clone(&progress));
        // Whoever cancelled just before must not be missed.
        if self.is_cancelled() {
            self.cancel();
        }
        progress
    }
}
