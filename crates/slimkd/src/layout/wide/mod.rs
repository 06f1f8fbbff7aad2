//! The wide layout: nodes of 16 child boxes, and leaves as byte codes.
//!
//! Sources: Ernst & Greiner 2008, *Multi Bounding Volume Hierarchies*, and Wald, Benthin & Boulos 2008, *Getting Rid of Packets*, for
//! wide nodes; Ylitie, Karras & Laine 2017 for child boxes on a grid of the node's own.
//!
//! Deviations
//! 1. 16 children with planes of 16 bits: with 8 bits, a ray that starts on a surface lies inside the boxes of leaves around it.
//! 2. Leaves name triangles of the mesh by byte codes of gaps and runs; nothing of the mesh is copied.
//!
//! `node.rs` has the bits of nodes, `leaf.rs` those of leaves.

mod checked;
mod encode;
mod leaf;
mod node;
mod nodes;
mod validate;
mod view;

pub(crate) use checked::CheckedWide;
pub(crate) use encode::{encode, holds, least_size, size};
use encode::{fits, grid};
pub(crate) use leaf::LeafCode;
pub(crate) use node::{LANES, STEP_BITS, WideNode};
pub(crate) use nodes::WideNodes;
pub(crate) use validate::validate;
pub(crate) use view::WideView;

use crate::layout::Planes;

/// Bytes behind the last leaf, so that reading 8 bytes at any code stays inside.
const PADDING: usize = 8;

/// The encoded tree. The root is node 0; without any triangle, it has no children.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wide {
    pub(crate) nodes: Vec<WideNode>,
    /// Leaves, then [`PADDING`] zeros.
    pub(crate) leaves: Vec<u8>,
    pub(crate) grid: Planes,
    pub(crate) code: LeafCode,
}

impl Wide {
    /// Bytes that it takes.
    pub(crate) fn bytes(&self) -> u64 {
        (self.nodes.len() * size_of::<WideNode>() + self.leaves.len()) as u64
    }

    /// Bytes that hold nothing.
    pub(crate) fn padding(&self) -> u64 {
        PADDING as u64
    }
}
