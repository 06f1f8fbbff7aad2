//! What every step of one build shares: the mesh, the options, the account of memory, the progress.

pub(crate) mod memory;
mod progress;

use crate::geometry::TriangleMesh;
use crate::options::{BuildError, BuildOptions};
use memory::Memory;
pub use progress::Progress;

/// One build, from its first step to its last.
pub(crate) struct Job<'a> {
    pub(crate) mesh: &'a TriangleMesh,
    pub(crate) options: &'a BuildOptions,
    pub(crate) progress: &'a Progress,
    pub(crate) memory: Memory,
}

impl<'a> Job<'a> {
    pub(crate) fn new(mesh: &'a TriangleMesh, options: &'a BuildOptions, progress: &'a Progress) -> Self {
        Self { mesh, options, progress, memory: Memory::new(options.max_build_bytes) }
    }

    /// An error once the build was cancelled.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        self.progress.check()
    }

    /// [`Job::check`] at some of the calls only: for loops over a whole tree, which pass their index.
    #[inline]
    pub(crate) fn check_at(&self, index: usize) -> Result<(), BuildError> {
        self.progress.check_at(index)
    }
}
