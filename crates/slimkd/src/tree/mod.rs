//! The finished tree: its bytes, its size, its shape.

mod checked;
mod complete;
mod dense;
mod encoded;
mod file;
mod kdtree;
mod lanes;
mod memory;
mod nodes;
mod plain;
mod queries;
mod statistics;
mod walk;

pub use complete::CompletenessError;
pub use encoded::EncodedTree;
pub use file::{FileError, OpenTree};
pub use kdtree::KdTree;
pub(crate) use lanes::{LaneNodes, LaneStep};
pub use memory::MemoryReport;
pub(crate) use nodes::{Ids, Inner, Nodes, PIECE, SPILL, Step, View, with_nodes};
pub use statistics::{LeafReferences, NodeCounts, TreeStatistics};

/// A tree's bytes in its layout.
#[derive(Clone, Debug)]
enum Encoded {
    Plain(plain::Plain),
    Dense(dense::Dense),
}

impl Encoded {
    /// Bytes that it takes.
    fn bytes(&self) -> u64 {
        match self {
            Self::Plain(plain) => {
                let (wide, narrow) = (plain.indices_4byte.len() as u64, plain.indices_2byte.len() as u64);
                8 * plain.nodes.len() as u64 + 4 * wide + 2 * narrow
            }
            Self::Dense(dense) => dense.bytes.len() as u64,
        }
    }
}
