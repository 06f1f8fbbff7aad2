//! Size and shape of any tree.

use crate::schema::Shape;
use slimkd::{KdTree, TreeStatistics};

pub(super) fn shape(tree: &KdTree, statistics: &TreeStatistics) -> Shape {
    Shape {
        nodes: statistics.into(),
        references: statistics.into(),
        bytes: (&tree.memory()).into(),
        max_depth: statistics.max_depth,
        sah_cost: statistics.sah_cost,
    }
}
