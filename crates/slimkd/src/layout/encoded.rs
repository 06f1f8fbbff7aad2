//! A whole tree in its layout: written, measured, and shown to kernels elsewhere, a GPU's for one.

use super::dense::{self, Dense};
use super::plain::{self, Plain};
use super::wide::Wide;
use crate::geometry::Aabb;
use crate::job::Job;
use crate::options::{BuildError, Layout};
use crate::plan::Plan;

/// The bytes of a tree in its layout, as they are. `docs/layouts.md` describes the layouts; every bit is in the sources named
/// below. What stands here was proved: addresses lie inside, ids name triangles of the mesh, the tree ends.
///
/// A traversal must treat each plane as a slab, or it loses hits: see `traverse/prepared.rs`.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum EncodedTree<'a> {
    /// 8-byte nodes; the root is node 0. Bits: `layout/plain/layout.rs`.
    Plain {
        /// Inner nodes, leaves, and T-references behind their child pairs.
        nodes: &'a [u64],
        /// Ids of leaves in 4-byte mode.
        indices_4byte: &'a [u32],
        /// Lower halves of the ids of leaves in 2-byte mode.
        indices_2byte: &'a [u16],
    },
    /// Nodes at any byte, little-endian; the root is at 0. Bits: `layout/dense/mod.rs` and `leaf.rs`.
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
    /// Nodes of 16 child boxes; the root is node 0. Bits: `layout/wide/node.rs` and `leaf.rs`.
    Wide {
        /// 256 bytes a node.
        nodes: &'a [[u8; 256]],
        /// Leaves; the last 8 bytes are padding.
        leaves: &'a [u8],
        /// Bytes of a leaf's header.
        header_bytes: u32,
        /// A place in grid units is `(x - low) · scale`.
        low: [f32; 3],
        /// Powers of two, one over scene units.
        scale: [f32; 3],
    },
}

/// The tree that a plan becomes: its bytes in one of the layouts.
#[derive(Clone, Debug)]
pub(crate) enum Encoded {
    Plain(Plain),
    Dense(Dense),
    Wide(Wide),
}

impl Encoded {
    /// Bytes that it takes.
    pub(crate) fn bytes(&self) -> u64 {
        match self {
            Self::Plain(plain) => {
                let (wide, narrow) = (plain.indices_4byte.len() as u64, plain.indices_2byte.len() as u64);
                8 * plain.nodes.len() as u64 + 4 * wide + 2 * narrow
            }
            Self::Dense(dense) => dense.bytes.len() as u64,
            Self::Wide(wide) => wide.bytes(),
        }
    }

    /// The bytes as kernels elsewhere read them.
    pub(crate) fn as_tree(&self) -> EncodedTree<'_> {
        match self {
            Self::Plain(plain) => EncodedTree::Plain {
                nodes: bytemuck::cast_slice(&plain.nodes),
                indices_4byte: &plain.indices_4byte,
                indices_2byte: &plain.indices_2byte,
            },
            Self::Dense(dense) => dense.view(),
            Self::Wide(wide) => EncodedTree::Wide {
                nodes: bytemuck::cast_slice(&wide.nodes),
                leaves: &wide.leaves,
                header_bytes: wide.code.header_bytes(),
                low: wide.grid.low,
                scale: wide.grid.scale,
            },
        }
    }
}

/// The layout that a plan is written in: [`Layout::TwoByte`] where the dense one cannot hold it.
fn layout_of(plan: &Plan, bounds: &Aabb, asked: Layout) -> Layout {
    let fits = plan.hoisted.is_empty() && dense::holds(bounds);
    match asked {
        Layout::Dense | Layout::Wide if !fits => Layout::TwoByte,
        // A plan of planes is no tree of boxes: `pipeline.rs` makes wide trees otherwise.
        Layout::Wide => Layout::Dense,
        asked => asked,
    }
}

/// Writes a plan over a job's mesh, in the layout that its options ask for if that can hold it.
pub(crate) fn encode(plan: &Plan, bounds: &Aabb, job: &Job<'_>) -> Result<Encoded, BuildError> {
    match layout_of(plan, bounds, job.options.layout) {
        Layout::Dense => Ok(Encoded::Dense(dense::encode(plan, bounds, job)?)),
        layout => Ok(Encoded::Plain(plain::encode(plan, layout == Layout::TwoByte, job)?)),
    }
}

/// Bytes that a plan takes once [`encode`] wrote it, without writing it.
pub(crate) fn size(plan: &Plan, bounds: &Aabb, job: &Job<'_>) -> Result<u64, BuildError> {
    match layout_of(plan, bounds, job.options.layout) {
        Layout::Dense => dense::size(plan, job),
        layout => plain::size(plan, layout == Layout::TwoByte, job),
    }
}
