//! What every other room needs: numbers, medians, the machine, progress, errors, vectors and colours.

pub(crate) mod error;
pub mod machine;
pub mod median;
pub mod number;
pub mod palette;
mod progress;
pub mod soup;
pub mod vector;

pub use error::{DeviceError, ReportError};
pub use progress::Progress;
