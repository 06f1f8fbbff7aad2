//! Reads of a proven plain tree.

use super::{Packed, Plain};
use crate::traverse::Planes;
use crate::tree::nodes::{Inner, MeshView, Nodes, Step};
use crate::tree::statistics::LeafMode;

/// A proven tree and its mesh as plain slices.
#[derive(Clone, Copy)]
pub(crate) struct PlainView<'a> {
    nodes: &'a [Packed],
    indices_4byte: &'a [u32],
    indices_2byte: &'a [u16],
    mesh: MeshView<'a>,
}

impl<'a> PlainView<'a> {
    pub(in crate::tree) fn new(tree: &'a Plain, mesh: MeshView<'a>) -> Self {
        let Plain { nodes, indices_4byte, indices_2byte } = tree;
        Self { nodes, indices_4byte, indices_2byte, mesh }
    }

    #[inline(always)]
    fn packed(&self, index: u32) -> Packed {
        debug_assert!((index as usize) < self.nodes.len());
        // SAFETY: `index` is the root, a child of a node of this tree, or the T-reference slot behind its children; a
        // proven tree's pointers lie inside the array.
        unsafe { *self.nodes.get_unchecked(index as usize) }
    }

    #[inline(always)]
    fn indices_4byte(&self, first: u32, count: u32) -> &'a [u32] {
        debug_assert!(first as usize + count as usize <= self.indices_4byte.len());
        // SAFETY: a proven tree's leaf ranges lie inside the array.
        unsafe { self.indices_4byte.get_unchecked(first as usize..first as usize + count as usize) }
    }

    #[inline(always)]
    fn indices_2byte(&self, first: u32, count: u32) -> &'a [u16] {
        debug_assert!(first as usize + count as usize <= self.indices_2byte.len());
        // SAFETY: a proven tree's leaf ranges lie inside the array.
        unsafe { self.indices_2byte.get_unchecked(first as usize..first as usize + count as usize) }
    }
}

impl Nodes for PlainView<'_> {
    type Leaf = Packed;

    #[inline(always)]
    fn node(self, address: u32) -> Step<Packed> {
        let node = self.packed(address);
        if node.is_leaf() {
            return Step::Leaf(node);
        }
        let left = node.pointer();
        let t_reference = node.has_t_reference().then(|| self.packed(left + 2).triangle());
        Step::Inner(Inner { axis: node.axis(), split: node.split(), left, stride: 1, t_reference })
    }

    #[inline(always)]
    fn triangles(self, leaf: Packed, mut visit: impl FnMut(u32) -> bool) -> bool {
        let first = leaf.pointer();
        if leaf.is_2byte() {
            let upper = leaf.upper();
            self.indices_2byte(first, leaf.count_2byte()).iter().any(|&lower| visit(upper | u32::from(lower)))
        } else {
            self.indices_4byte(first, leaf.count_4byte()).iter().any(|&id| visit(id))
        }
    }

    fn mode(leaf: Packed) -> LeafMode {
        if leaf.is_2byte() { LeafMode::TwoByte } else { LeafMode::FourByte }
    }

    #[inline(always)]
    fn corners(self, triangle: u32) -> [[f32; 3]; 3] {
        self.mesh.corners(triangle)
    }

    #[inline(always)]
    fn planes(self) -> Planes {
        Planes::WORLD
    }
}
