//! From a mesh to a tree: options, presets, progress.

mod options;
mod progress;

pub use options::{BuildError, BuildOptions, Preset, SahConstants};
pub use progress::Progress;
