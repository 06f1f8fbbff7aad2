//! What a build may take: every large block is asked for here before it is taken.
//!
//! Memory depends on the scene: a triangle that reaches many leaves is held many times. So a build is refused at once where
//! even its least need is too much, and otherwise at the block that would go beyond the limit, before that block is taken.

use super::{BuildError, BuildOptions};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// What one worker keeps beside the large blocks: scratch, and the subtree at hand.
const WORKER: u64 = 2 << 20;

/// Bytes that a build holds, and the most it may.
#[derive(Debug)]
pub(crate) struct Budget {
    limit: u64,
    held: AtomicU64,
}

impl Budget {
    pub(crate) fn new(options: &BuildOptions) -> Result<Self, BuildError> {
        let budget = Self { limit: options.max_bytes.unwrap_or(u64::MAX), held: AtomicU64::new(0) };
        // Small scenes have few workers' blocks.
        if options.max_bytes.is_some() {
            budget.take(WORKER * rayon::current_num_threads() as u64)?;
        }
        Ok(budget)
    }

    /// Asks for a block of `bytes`.
    pub(crate) fn take(&self, bytes: u64) -> Result<(), BuildError> {
        let needed = self.held.fetch_add(bytes, Relaxed) + bytes;
        if needed <= self.limit {
            return Ok(());
        }
        self.give_back(bytes);
        Err(BuildError::TooMuchMemory { needed, limit: self.limit })
    }

    /// After a block was freed.
    pub(crate) fn give_back(&self, bytes: u64) {
        self.held.fetch_sub(bytes, Relaxed);
    }
}
