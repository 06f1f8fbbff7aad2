//! What a tree costs in memory, exact to the byte.

use super::{KdTree, walk};
use crate::layout::Encoded;

/// Bytes of a tree by part. Everything but `mesh` is what the acceleration structure adds to the bare indexed mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MemoryReport {
    /// Inner and leaf nodes, without T-reference slots.
    pub nodes: u64,
    /// T-reference slots.
    pub t_references: u64,
    /// Triangle indices of the leaves.
    pub indices: u64,
    /// Padding, and anything else.
    pub other: u64,
    /// The indexed mesh: 12 bytes a vertex, 12 bytes a triangle.
    pub mesh: u64,
}

impl MemoryReport {
    pub(super) fn of(tree: &KdTree) -> Self {
        let mesh = tree.mesh.memory_bytes();
        match &tree.encoded {
            Encoded::Plain(plain) => {
                let t_references = walk::t_references(tree);
                Self {
                    nodes: 8 * (plain.nodes.len() as u64 - t_references),
                    t_references: 8 * t_references,
                    indices: 4 * plain.indices_4byte.len() as u64 + 2 * plain.indices_2byte.len() as u64,
                    other: 0,
                    mesh,
                }
            }
            Encoded::Wide(wide) => Self {
                nodes: size_of_val(wide.nodes.as_slice()) as u64,
                t_references: 0,
                indices: wide.leaves.len() as u64 - wide.padding(),
                other: wide.padding(),
                mesh,
            },
            Encoded::Dense(dense) => Self {
                nodes: dense.bytes.len() as u64 - dense.index_bytes - dense.padding(),
                t_references: 0,
                indices: dense.index_bytes,
                other: dense.padding(),
                mesh,
            },
        }
    }

    /// Everything that the structure adds to the mesh.
    pub fn tree(&self) -> u64 {
        self.nodes + self.t_references + self.indices + self.other
    }

    /// All that must stay in memory to trace and to report public ids.
    pub fn resident(&self) -> u64 {
        self.tree() + self.mesh
    }
}
