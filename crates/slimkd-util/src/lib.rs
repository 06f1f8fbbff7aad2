//! Small tools that several crates of slimkd share, each of them here once.

pub mod alloc;
mod rng;
pub mod whole_file;

pub use rng::Rng;
