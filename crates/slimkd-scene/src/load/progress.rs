//! What a loader does with the progress that it reports to.

use super::LoadError;
use slimkd::Progress;

/// Share of the whole that reading and decompressing takes; of a zstd PLY it is some 80 %, of plain files little.
pub(super) const READ_SHARE: f64 = 0.6;

/// How far loading has come.
pub(super) trait Loading {
    /// Notes `fraction`, and ends the load if it was cancelled.
    fn reach(&self, fraction: f64) -> Result<(), LoadError>;

    /// Like [`Loading::reach`], for `done` of `total` steps of the parse that follows reading.
    fn parsed(&self, done: usize, total: usize) -> Result<(), LoadError> {
        self.reach(READ_SHARE + (1.0 - READ_SHARE) * done as f64 / total.max(1) as f64)
    }
}

impl Loading for Progress {
    fn reach(&self, fraction: f64) -> Result<(), LoadError> {
        if self.is_cancelled() {
            return Err(LoadError::Cancelled);
        }
        self.set(fraction);
        Ok(())
    }
}
