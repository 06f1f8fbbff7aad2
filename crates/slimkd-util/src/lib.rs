//! Small tools that several crates of slimkd share, each of them here once.

pub mod alloc;
pub mod exr;
pub mod png;
mod required;
mod rng;
pub mod whole_file;

pub use required::missing;
pub use rng::Rng;
