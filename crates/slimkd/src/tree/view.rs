//! What a traversal reads: nodes, indices and corners of a proven tree, without bounds checks.
//!
//! A [`KdTree`] comes only from the encoder, whose output holds these facts by construction, or from `KdTree::read`, which
//! proves them (`walk::validate`): every child, T-reference slot and leaf range lies inside its array, and every id names
//! a triangle. [`TriangleMesh`](crate::TriangleMesh) proves its vertex indices. None of it can change afterwards. Leaving
//! the checks out and making the ray's axis a constant took a sixth off every ray together.

use super::KdTree;
use super::layout::Packed;

/// A proven tree and its mesh as plain slices.
#[derive(Clone, Copy)]
pub(crate) struct TreeView<'a> {
    nodes: &'a [Packed],
    indices_4byte: &'a [u32],
    indices_2byte: &'a [u16],
    triangles: &'a [[u32; 3]],
    vertices: &'a [[f32; 3]],
}

impl<'a> TreeView<'a> {
    pub(crate) fn new(tree: &'a KdTree) -> Self {
        Self {
            nodes: &tree.encoded.nodes,
            indices_4byte: &tree.encoded.indices_4byte,
            indices_2byte: &tree.encoded.indices_2byte,
            triangles: tree.mesh.triangles(),
            vertices: tree.mesh.vertices(),
        }
    }

    /// Node 0, a child of a node of this tree, or the T-reference slot behind its children.
    #[inline(always)]
    pub(crate) fn node(&self, index: u32) -> Packed {
        debug_assert!((index as usize) < self.nodes.len());
        // SAFETY: the caller got `index` from a node of this tree, and a proven tree's pointers lie inside the array.
        unsafe { *self.nodes.get_unchecked(index as usize) }
    }

    /// The range of a 4-byte leaf of this tree.
    #[inline(always)]
    pub(crate) fn indices_4byte(&self, first: u32, count: u32) -> &'a [u32] {
        debug_assert!(first as usize + count as usize <= self.indices_4byte.len());
        // SAFETY: a proven tree's leaf ranges lie inside the array.
        unsafe { self.indices_4byte.get_unchecked(first as usize..first as usize + count as usize) }
    }

    /// The range of a 2-byte leaf of this tree.
    #[inline(always)]
    pub(crate) fn indices_2byte(&self, first: u32, count: u32) -> &'a [u16] {
        debug_assert!(first as usize + count as usize <= self.indices_2byte.len());
        // SAFETY: a proven tree's leaf ranges lie inside the array.
        unsafe { self.indices_2byte.get_unchecked(first as usize..first as usize + count as usize) }
    }

    /// Corners of a triangle that a leaf or a T-reference of this tree names.
    #[inline(always)]
    pub(crate) fn corners(&self, triangle: u32) -> [[f32; 3]; 3] {
        debug_assert!((triangle as usize) < self.triangles.len());
        // SAFETY: a proven tree names existing triangles only, and the mesh's vertex indices were checked when it was made.
        unsafe {
            self.triangles.get_unchecked(triangle as usize).map(|v| *self.vertices.get_unchecked(v as usize))
        }
    }
}
