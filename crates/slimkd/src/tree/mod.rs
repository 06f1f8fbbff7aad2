//! The finished tree: its bytes, its size, its shape.

mod file;
mod kdtree;
mod memory;
mod statistics;

pub use file::FileError;
pub use kdtree::KdTree;
pub use memory::MemoryReport;
pub use statistics::{LeafReferences, NodeCounts, TreeStatistics};
