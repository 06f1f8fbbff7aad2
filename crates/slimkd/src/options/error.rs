//! Why a build ends without a tree.

use std::fmt;
use thiserror::Error;

/// Why a build ended without a tree.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// [`Progress::cancel`](crate::Progress::cancel) was called: nothing is left behind, build again when wanted.
    #[error("the build was cancelled")]
    Cancelled,
    /// A constant is out of its range: set it to a finite number above 0 (a byte weight may be 0).
    #[error("the {name} is {value}; set it to a finite number above 0")]
    InvalidOption {
        /// Which constant.
        name: &'static str,
        /// What it was.
        value: f64,
    },
    /// A threshold is out of its range: set it between 0 and 1.
    #[error("the {name} threshold is {value}; set it between 0 and 1")]
    InvalidThreshold {
        /// Which threshold.
        name: &'static str,
        /// What it was.
        value: f64,
    },
    /// Even one leaf of all triangles is larger than [`BuildOptions::max_tree`](super::BuildOptions::max_tree): allow more bytes, or use [`Layout::Dense`](super::Layout::Dense) if
    /// that is not the layout yet.
    #[error("the smallest tree takes {needed} bytes, {limit} are allowed; allow more")]
    TreeTooLarge {
        /// Bytes of the smallest tree.
        needed: u64,
        /// Bytes that were allowed.
        limit: u64,
    },
    /// The build would hold more than [`BuildOptions::max_build_bytes`](super::BuildOptions::max_build_bytes): allow more, or use [`Preset::Slim`](super::Preset::Slim) or [`Preset::Tiny`](super::Preset::Tiny)
    /// in place of the others, since these also take less memory to build.
    #[error("the build needs {needed} bytes or more, {limit} are allowed; allow more")]
    BuildTooLarge {
        /// Bytes that it would have held, as far as it had come.
        needed: u64,
        /// Bytes that were allowed.
        limit: u64,
    },
    /// There was no memory for a block of the build: free some, or use [`Preset::Slim`](super::Preset::Slim) or [`Preset::Tiny`](super::Preset::Tiny) in place of the
    /// others.
    #[error("no memory for a block of {bytes} bytes; free some")]
    OutOfMemory {
        /// Bytes of the block.
        bytes: u64,
    },
    /// The operating system gave no threads: ask for fewer.
    #[error("cannot start the build's threads ({0}); ask for fewer")]
    Threads(String),
    /// A layout's field cannot address the tree: use a smaller preset, a higher traversal cost, or split the mesh.
    #[error(
        "the tree needs {needed} {what}, the layout holds {limit}; use a smaller preset or split the mesh"
    )]
    TooLarge {
        /// What there is too much of.
        what: Countable,
        /// How many the tree needs.
        needed: u64,
        /// How many fit.
        limit: u64,
    },
}

/// What a layout counts, in fields that have an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Countable {
    /// Triangles of the mesh.
    Triangles,
    /// Triangles of one leaf.
    TrianglesOfALeaf,
    /// Nodes, T-references included.
    Nodes,
    /// References of 4 bytes.
    FourByteReferences,
    /// References of 2 bytes.
    TwoByteReferences,
    /// Bytes of the whole tree.
    Bytes,
}

impl fmt::Display for Countable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Triangles => "triangles",
            Self::TrianglesOfALeaf => "triangles in a leaf",
            Self::Nodes => "nodes",
            Self::FourByteReferences => "4-byte references",
            Self::TwoByteReferences => "2-byte references",
            Self::Bytes => "bytes",
        })
    }
}
