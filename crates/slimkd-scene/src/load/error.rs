//! Why a scene file was refused.

use super::Format;
use std::{fmt, io, path::PathBuf};
use thiserror::Error;

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of a text file, from 1.
    Line(u64),
    /// A byte offset in the (decompressed) file, from 0.
    Byte(u64),
    /// An entry of a glTF list, such as `accessors[3]`.
    Entry(&'static str, usize),
    /// The file as a whole.
    Whole,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, " at line {line}"),
            Self::Byte(byte) => write!(f, " at byte {byte}"),
            Self::Entry(list, index) => write!(f, " in {list}[{index}]"),
            Self::Whole => Ok(()),
        }
    }
}

/// Why a scene was not loaded. Each message is one line: what, where in the file, how to fix it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file could not be read: check the path and the permissions.
    #[error("cannot read {path:?}: {source}; check the path and its permissions")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A directory, a pipe or a device: give a regular file.
    #[error(
        "{path:?} is not a regular file; give a .ply, .obj, .stl, .off, .gltf, .glb, .xml, .serialized, .json, .jsonl, .asc or .npy file"
    )]
    NotAFile {
        /// What was given.
        path: PathBuf,
    },
    /// The name's ending is none that is known: rename or convert the file.
    #[error(
        "{path:?} has no known extension; use .ply, .obj, .stl, .off, .gltf, .glb, .xml, .serialized, .json, .jsonl, .asc or .npy, with .zst or .gz behind it when compressed"
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// There is not a single byte: write the file again.
    #[error("the file is empty; write or download it again")]
    Empty,
    /// The compressed data is damaged or cut off: compress or download it again.
    #[error(
        "damaged {compression} data after {decoded} decompressed bytes: {reason}; compress or download it again"
    )]
    Decompress {
        /// `zst` or `gz`.
        compression: &'static str,
        /// Bytes that came out well.
        decoded: u64,
        /// What the decoder said.
        reason: String,
    },
    /// The content is out of proportion to the file, as in a decompression bomb: check where the file comes from;
    /// if it is sound, decompress it (or write the instances out) beforehand.
    #[error("{what} would take more than {limit} bytes out of a file of {input}; if it is sound, {fix}")]
    OutOfProportion {
        /// What grows.
        what: &'static str,
        /// How much is allowed, bytes.
        limit: u64,
        /// Size of the file, bytes.
        input: u64,
        /// What to do.
        fix: &'static str,
    },
    /// The content breaks the format's rules.
    #[error("not a valid {format} file{place}: {what}; {fix}")]
    Invalid {
        /// The format.
        format: Format,
        /// Where.
        place: Place,
        /// What is wrong.
        what: String,
        /// What to do.
        fix: &'static str,
    },
    /// Valid, but needs what this crate cannot do: convert the file.
    #[error("{format} file{place}: {what} is not supported; {fix}")]
    Unsupported {
        /// The format.
        format: Format,
        /// Where.
        place: Place,
        /// What is needed.
        what: String,
        /// What to do.
        fix: &'static str,
    },
    /// More vertices or triangles than 32-bit ids can name: split the scene.
    #[error(transparent)]
    Mesh(#[from] slimkd::MeshError),
    /// [`slimkd::Progress::cancel`] was called.
    #[error("loading was cancelled; run it again")]
    Cancelled,
}

/// Text of a file for a message: one line, printable, short.
pub(super) fn quoted(text: &[u8]) -> String {
    const LONGEST: usize = 40; // characters; enough to find the place
    let text = String::from_utf8_lossy(&text[..text.len().min(4 * LONGEST)]);
    let mut short: String = text.chars().take(LONGEST).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    format!("{short:?}")
}

/// What another crate says, for a message: one line, not too long whatever the file has in it.
pub(super) fn short(what: &dyn fmt::Display) -> String {
    const LONGEST: usize = 200;
    let line = what.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    let mut short: String = line.chars().take(LONGEST).collect();
    if short.len() < line.len() {
        short.push('…');
    }
    short
}
