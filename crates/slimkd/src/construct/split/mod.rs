//! The best plane of a node: read `search.rs` first.

mod bins;
mod pairs;
mod sah;
mod search;
mod sweep;

pub(super) use search::Scratch;
pub(super) use sweep::Split;
