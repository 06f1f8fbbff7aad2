//! The finished tree: its bytes, its size, its shape.

mod encode;
mod file;
mod kdtree;
mod layout;
mod memory;
mod statistics;
mod view;
mod walk;

pub use file::FileError;
pub use kdtree::KdTree;
pub(crate) use layout::Packed;
pub use memory::MemoryReport;
pub use statistics::{LeafReferences, NodeCounts, TreeStatistics};
pub(crate) use view::TreeView;
