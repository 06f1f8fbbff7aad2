//! How far a report has come, and how to stop it.

use slimkd_render::RenderProgress;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};

/// Work inside a unit that listens to a cancel of its own.
#[derive(Clone)]
enum Inner {
    Build(Arc<slimkd::Progress>),
    Render(Arc<RenderProgress>),
}

/// Shared between a running report and whoever watches it.
#[derive(Default)]
pub struct Progress {
    /// Expected seconds of all work, in thousandths; only their ratio counts.
    total: AtomicU64,
    done: AtomicU64,
    cancelled: AtomicBool,
    inner: Mutex<Option<Inner>>,
}

impl Progress {
    /// Nothing done, not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Share of the work that is done, 0 to 1, by estimates of what each unit takes.
    pub fn fraction(&self) -> f64 {
        (self.done.load(Relaxed) as f64 / self.total.load(Relaxed).max(1) as f64).min(1.0)
    }

    /// Asks the report to end with [`crate::ReportError::Cancelled`] soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
        match &*self.inner.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(Inner::Build(progress)) => progress.cancel(),
            Some(Inner::Render(progress)) => progress.cancel(),
            None => {}
        }
    }

    /// True once [`Progress::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    /// More work is known of; `weight` in expected milliseconds.
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

    pub(crate) fn building(&self) -> Arc<slimkd::Progress> {
        let progress = Arc::new(slimkd::Progress::new());
        self.set(Inner::Build(Arc::clone(&progress)));
        progress
    }

    /// The progress of one picture, which is cancelled with the report.
    pub fn rendering(&self) -> Arc<RenderProgress> {
        let progress = Arc::new(RenderProgress::new());
        self.set(Inner::Render(Arc::clone(&progress)));
        progress
    }

    fn set(&self, inner: Inner) {
        *self.inner.lock().unwrap_or_else(PoisonError::into_inner) = Some(inner);
        // Whoever cancelled just before must not be missed.
        if self.is_cancelled() {
            self.cancel();
        }
    }
}
