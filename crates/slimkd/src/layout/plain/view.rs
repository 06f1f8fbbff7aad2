//! Reads of a proven plain tree.

use super::{Packed, Plain};
use crate::layout::Planes;
use crate::layout::mesh::MeshView;
use crate::layout::nodes::LeafMode;
use crate::layout::nodes::{Address, Ids, Inner, Nodes, PIECE, Step};

/// A proven tree and its mesh as plain slices.
#[derive(Clone, Copy)]
pub(crate) struct PlainView<'a> {
    pub(super) nodes: &'a [Packed],
    pub(super) indices_4byte: &'a [u32],
    pub(super) indices_2byte: &'a [u16],
    pub(super) mesh: MeshView<'a>,
}

impl<'a> PlainView<'a> {
    pub(crate) fn new(tree: &'a Plain, mesh: MeshView<'a>) -> Self {
        let Plain { nodes, indices_4byte, indices_2byte } = tree;
        Self { nodes, indices_4byte, indices_2byte, mesh }
    }

    /// An entry of the node array.
    ///
    /// # Safety
    /// The index must be that of the root, of a child of a node of this tree, or of the T-reference behind its children.
    #[inline(always)]
    pub(super) unsafe fn packed(&self, index: u32) -> Packed {
        debug_assert!((index as usize) < self.nodes.len());
        // SAFETY: a proved tree's pointers lie inside the array.
        unsafe { *self.nodes.get_unchecked(index as usize) }
    }
}

/// A leaf in reading.
#[derive(Clone, Copy)]
pub(crate) struct Leaf {
    pub(super) first: u32,
    pub(super) left: u32,
    /// The shared upper half in 2-byte mode.
    pub(super) upper: u32,
    pub(super) mode: LeafMode,
}

impl Leaf {
    pub(super) const EMPTY: Self = Self { first: 0, left: 0, upper: 0, mode: LeafMode::FourByte };

    #[inline(always)]
    pub(super) fn new(node: Packed) -> Self {
        let first = node.pointer();
        if node.is_2byte() {
            Self { first, left: node.count_2byte(), upper: node.upper(), mode: LeafMode::TwoByte }
        } else {
            Self { first, left: node.count_4byte(), upper: 0, mode: LeafMode::FourByte }
        }
    }
}

// SAFETY: a proved tree's pointers lie inside the array, and its ids name triangles of the mesh.
unsafe impl Nodes for PlainView<'_> {
    type Leaf = Leaf;

    #[inline(always)]
    unsafe fn node(self, address: Address) -> Step<Leaf> {
        // SAFETY: the caller says that the address comes from this tree.
        let node = unsafe { self.packed(address.get()) };
        if node.is_leaf() {
            return Step::Leaf(Leaf::new(node));
        }
        let left = node.pointer();
        // SAFETY: of a proved tree, a type-II node's T-reference stands behind its children.
        let t_reference = node.has_t_reference().then(|| unsafe { self.packed(left + 2).triangle() });
        // SAFETY: of a proved tree, both children stand there.
        Step::Inner(unsafe { Inner::new(node.axis(), node.split(), left, 1, t_reference) })
    }

    #[inline(always)]
    unsafe fn take<'b>(self, leaf: &mut Leaf, buffer: &'b mut Ids) -> &'b [u32]
    where
        Self: 'b,
    {
        let first = leaf.first as usize;
        if leaf.mode == LeafMode::FourByte {
            let count = std::mem::take(&mut leaf.left) as usize;
            debug_assert!(first + count <= self.indices_4byte.len());
            // SAFETY: a proven tree's leaf ranges lie inside the array.
            return unsafe { self.indices_4byte.get_unchecked(first..first + count) };
        }
        let count = PIECE.min(leaf.left as usize);
        debug_assert!(first + count <= self.indices_2byte.len());
        // SAFETY: a proven tree's leaf ranges lie inside the array.
        let lower = unsafe { self.indices_2byte.get_unchecked(first..first + count) };
        for (id, &lower) in buffer.0.iter_mut().zip(lower) {
            id.write(leaf.upper | u32::from(lower));
        }
        leaf.first += count as u32;
        leaf.left -= count as u32;
        // SAFETY: `count` of them were written above.
        unsafe { buffer.written(count) }
    }

    fn mode(leaf: Leaf) -> LeafMode {
        leaf.mode
    }

    #[inline(always)]
    unsafe fn corners(self, triangle: u32) -> [[f32; 3]; 3] {
        // SAFETY: the caller says that this tree names the triangle.
        unsafe { self.mesh.corners(triangle) }
    }

    #[inline(always)]
    fn planes(self) -> Planes {
        Planes::WORLD
    }
}
