//! Why there is no report.

use slimkd::BuildError;
use slimkd_render::{CameraError, RenderError};
use std::path::PathBuf;
use thiserror::Error;

/// Why a report was not written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReportError {
    /// [`crate::Progress::cancel`] was called. What was measured is kept: run again to go on.
    #[error("the report was cancelled; run it again to go on where it stopped")]
    Cancelled,
    /// The time limit passed. What was measured is kept: run again to go on.
    #[error("time is up with {left} measurements left; run the same command again to go on")]
    TimeUp {
        /// Units of work that are still to be done in this scene.
        left: usize,
    },
    /// A tree cannot be built: see the reason.
    #[error("{scene}: {tree}: {error}")]
    Build {
        /// The scene's name.
        scene: String,
        /// The tree's name.
        tree: String,
        /// What the builder said.
        error: BuildError,
    },
    /// A picture cannot be rendered: see the reason.
    #[error("{scene}: view {view}: {error}")]
    Render {
        /// The scene's name.
        scene: String,
        /// Number of the view.
        view: usize,
        /// What the renderer or its device said.
        error: DeviceError,
    },
    /// Two trees show different pictures, which is a bug in slimkd: report it.
    #[error(
        "{0} and {1} show view {2} differently, so no rate is reported; this is a bug in slimkd, please report it"
    )]
    Differ(String, String, usize),
    /// Two trees, or a device and the CPU, answer a ray differently, which is a bug in slimkd or in a driver: report it.
    #[error("{0}")]
    Answers(String),
    /// A device failed: it says why.
    #[error("{0}")]
    Device(String),
    /// A camera looks nowhere: choose another.
    #[error(transparent)]
    Camera(CameraError),
    /// No view of the scene was found: give the file cameras.
    #[error("{0}: found no view of it; give the scene cameras")]
    NoView(String),
    /// A file cannot be read or written: see the reason, and choose another folder.
    #[error("{}: {reason}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// What the system or the parser said, and what to do.
        reason: String,
    },
    /// A picture cannot be encoded.
    #[error("a picture cannot be encoded: {0}")]
    Picture(String),
    /// The system gave no threads: ask for fewer.
    #[error("cannot start {0} threads; ask for fewer")]
    Threads(usize),
}

impl ReportError {
    pub(crate) fn file(path: impl Into<PathBuf>, reason: impl std::fmt::Display) -> Self {
        Self::File { path: path.into(), reason: reason.to_string() }
    }
}

/// Why a device shows no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// It cannot be rendered anywhere, or was cancelled.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The device failed: it says why.
    #[error("{0}")]
    Failed(String),
}
