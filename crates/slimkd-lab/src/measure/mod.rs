//! Measuring, one unit of work after the other. Each is kept on disk before the next begins.

mod ablation;
mod frames;
mod heat;
mod pictures;
pub mod rates;
pub mod savings;
mod scaling;
mod session;
mod shape;
mod store;
mod sweep;
mod trees;

pub use frames::{Cpu, Device, DeviceError, Ready};
#[cfg(feature = "page")]
pub(crate) use pictures::slug;
pub use session::{Session, day};
#[cfg(feature = "page")]
pub(crate) use store::write;
