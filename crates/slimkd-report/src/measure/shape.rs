//! Size and shape of any tree.

use crate::data::{Bytes, Nodes, References, Shape};
use slimkd::{KdTree, MemoryReport, TreeStatistics};

pub(super) fn shape(tree: &KdTree, statistics: &TreeStatistics) -> Shape {
    let (n, r) = (&statistics.nodes, &statistics.leaf_references);
    let memory = tree.memory();
    let MemoryReport { nodes, t_references, indices, other, .. } = memory;
    Shape {
        nodes: Nodes { inner: n.inner, t_inner: n.t_inner, leaf: n.leaf, empty_leaf: n.empty_leaf },
        references: References {
            leaf_4byte: r.four_byte,
            leaf_2byte: r.two_byte,
            leaf_other: r.other,
            t: statistics.t_references,
        },
        bytes: Bytes { nodes, t_references, indices, other, tree: memory.tree() },
        max_depth: statistics.max_depth,
        sah_cost: statistics.sah_cost,
    }
}
