//! The `.skd` file.

use thiserror::Error;

/// Why a `.skd` file could not be written or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileError {
    /// The first bytes are not a `.skd` file's: build one with `slimkd build SCENE -o tree.skd`.
    #[error("not a .skd tree; make one with `slimkd build SCENE -o tree.skd`")]
    NotATree,
    /// Written by another version of the format: build it again from the scene.
    #[error("format version {found}, this build reads {expected}; build the tree again from its scene")]
    Version {
        /// What the file says.
        found: u32,
        /// What is understood.
        expected: u32,
    },
    /// The contents contradict themselves: the file is damaged, build it again from the scene.
    #[error("damaged tree: {0}; build it again from its scene")]
    Damaged(String),
    /// The operating system refused: see the source.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}
