//! The tree that users hold. Read `pipeline.rs` first: it is how a tree comes to be.

mod boxes;
mod complete;
mod covered;
mod kdtree;
mod memory;
mod pipeline;
mod queries;
mod statistics;
mod walk;

pub use complete::CompletenessError;
pub use kdtree::KdTree;
pub use memory::MemoryReport;
pub use statistics::{LeafReferences, NodeCounts, TreeStatistics};
pub(crate) use walk::for_each_reference;
