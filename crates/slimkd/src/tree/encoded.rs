//! A tree's bytes as they lie in memory, for kernels of others: a GPU's, for one.

use super::{Encoded, KdTree};

/// The bytes of a tree in its layout, as they are. `docs/layouts.md` describes the layouts; every bit is in the sources named
/// below. What stands here was proved: addresses lie inside, ids name triangles of the mesh, the tree ends.
///
/// A traversal must treat each plane as a slab, or it loses hits: see `traverse/prepared.rs`.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum EncodedTree<'a> {
    /// 8-byte nodes; the root is node 0. Bits: `tree/plain/layout.rs`.
    Plain {
        /// Inner nodes, leaves, and T-references behind their child pairs.
        nodes: &'a [u64],
        /// Ids of leaves in 4-byte mode.
        indices_4byte: &'a [u32],
        /// Lower halves of the ids of leaves in 2-byte mode.
        indices_2byte: &'a [u16],
    },
    /// Nodes at any byte, little-endian; the root is at 0. Bits: `tree/dense/mod.rs` and `leaf.rs`.
    Dense {
        /// Nodes and leaves; the last 8 bytes are padding.
        bytes: &'a [u8],
        /// Bytes of a leaf's header.
        header_bytes: u32,
        /// Bits of its count, above the two that say "leaf".
        count_bits: u32,
        /// Mask of its first id, above the count.
        id_mask: u32,
        /// A plane's coordinate is `(x - low) · scale + 1`, in [1, 2).
        low: [f32; 3],
        /// Powers of two, one over scene units.
        scale: [f32; 3],
        /// How far a plane may stand from where it was chosen, scene units.
        cell: [f32; 3],
    },
}

impl KdTree {
    /// The tree's bytes.
    pub fn encoded(&self) -> EncodedTree<'_> {
        match &self.encoded {
            Encoded::Plain(plain) => EncodedTree::Plain {
                nodes: bytemuck::cast_slice(&plain.nodes),
                indices_4byte: &plain.indices_4byte,
                indices_2byte: &plain.indices_2byte,
            },
            Encoded::Dense(dense) => dense.view(),
        }
    }

    /// Depth of the deepest leaf; the root has depth 0.
    pub fn depth(&self) -> u32 {
        self.depth
    }
}
