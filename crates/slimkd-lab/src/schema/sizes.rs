//! Nodes, references and bytes of a tree, as the JSON of `slimkd build`, of `slimkd inspect` and of a report shows them.

use serde::{Deserialize, Serialize};
use slimkd::{MemoryReport, TreeStatistics};

/// Nodes by kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Nodes {
    /// Without a T-reference.
    pub inner: u64,
    /// With one.
    pub t_inner: u64,
    /// Empty ones included.
    pub leaf: u64,
    /// Empty ones.
    pub empty_leaf: u64,
}

/// References by mode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct References {
    /// In 4-byte leaves.
    pub leaf_4byte: u64,
    /// In 2-byte leaves.
    pub leaf_2byte: u64,
    /// In the dense layout's leaves.
    pub leaf_other: u64,
    /// T-references.
    pub t: u64,
}

/// Bytes by part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bytes {
    /// Without T-reference slots.
    pub nodes: u64,
    /// T-reference slots.
    pub t_references: u64,
    /// Indices of the leaves.
    pub indices: u64,
    /// Anything else.
    pub other: u64,
    /// All of these.
    pub tree: u64,
}

impl From<&TreeStatistics> for Nodes {
    fn from(statistics: &TreeStatistics) -> Self {
        let nodes = &statistics.nodes;
        Self { inner: nodes.inner, t_inner: nodes.t_inner, leaf: nodes.leaf, empty_leaf: nodes.empty_leaf }
    }
}

impl From<&TreeStatistics> for References {
    fn from(statistics: &TreeStatistics) -> Self {
        let leaf = &statistics.leaf_references;
        Self {
            leaf_4byte: leaf.four_byte,
            leaf_2byte: leaf.two_byte,
            leaf_other: leaf.other,
            t: statistics.t_references,
        }
    }
}

impl From<&MemoryReport> for Bytes {
    fn from(memory: &MemoryReport) -> Self {
        let &MemoryReport { nodes, t_references, indices, other, .. } = memory;
        Self { nodes, t_references, indices, other, tree: memory.tree() }
    }
}
