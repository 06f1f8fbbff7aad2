//! Reads of a proven wide tree.

use super::{LeafCode, PADDING, Wide, WideNode, WideNodes};
use crate::layout::mesh::MeshView;
use crate::layout::{Address, Ids, Planes};

/// A proven tree and its mesh.
#[derive(Clone, Copy)]
pub(crate) struct WideView<'a> {
    nodes: &'a [WideNode],
    leaves: &'a [u8],
    code: LeafCode,
    grid: &'a Planes,
    pub(crate) mesh: MeshView<'a>,
}

impl<'a> WideView<'a> {
    pub(crate) fn new(tree: &'a Wide, mesh: MeshView<'a>) -> Self {
        Self { nodes: &tree.nodes, leaves: &tree.leaves, code: tree.code, grid: &tree.grid, mesh }
    }

    /// The coordinates of planes.
    #[inline(always)]
    pub(crate) fn grid(self) -> &'a Planes {
        self.grid
    }

    /// # Safety
    /// The address must come from this tree: the root, or an inner child of a node.
    #[inline(always)]
    pub(crate) unsafe fn node(self, at: Address) -> &'a WideNode {
        debug_assert!((at.get() as usize) < self.nodes.len());
        // SAFETY: the caller says so.
        unsafe { self.nodes.get_unchecked(at.get() as usize) }
    }

    /// An inner child.
    ///
    /// # Safety
    /// The node must come from this tree, and the lane must be that of an inner child.
    #[inline(always)]
    pub(crate) unsafe fn child(self, node: &WideNode, lane: usize) -> Address {
        debug_assert!(lane < node.inner());
        // SAFETY: a proven node's inner children stand side by side.
        unsafe { Address::new(node.nodes + lane as u32) }
    }

    /// The ids of a leaf; they lie in `buffer`.
    ///
    /// # Safety
    /// The node must come from this tree, and the lane must be that of a leaf.
    #[inline(always)]
    pub(crate) unsafe fn ids<'b>(self, node: &WideNode, lane: usize, buffer: &'b mut Ids) -> &'b [u32] {
        // SAFETY: the caller's promise.
        let count = unsafe { self.decode(node, lane, buffer) };
        // SAFETY: that many were written.
        unsafe { buffer.written(count) }
    }

    /// The ids of a leaf in fours, the last one of them repeated at the end. They lie in `buffer`.
    ///
    /// # Safety
    /// That of [`WideView::ids`].
    #[inline(always)]
    pub(crate) unsafe fn fours<'b>(
        self,
        node: &WideNode,
        lane: usize,
        buffer: &'b mut Ids,
    ) -> &'b [[u32; 4]] {
        // SAFETY: the caller's promise.
        let count = unsafe { self.decode(node, lane, buffer) };
        // SAFETY: that many were written.
        unsafe { buffer.fours(count) }
    }

    /// Writes the ids of a leaf to `buffer`; returns how many.
    ///
    /// # Safety
    /// That of [`WideView::ids`].
    #[inline(always)]
    unsafe fn decode(self, node: &WideNode, lane: usize, buffer: &mut Ids) -> usize {
        debug_assert!(lane >= node.inner() && lane < node.children());
        let long = |at: u32| {
            debug_assert!(at as usize + PADDING <= self.leaves.len());
            // SAFETY: a proven leaf's codes lie before the padding, so 8 bytes from there are inside.
            u64::from_le(unsafe { self.leaves.as_ptr().add(at as usize).cast::<u64>().read_unaligned() })
        };
        self.code.read(node.leaves + u32::from(node.offsets[lane]), buffer, long)
    }
}

// SAFETY: a proved tree's inner children are nodes, and its ids name triangles of the mesh.
unsafe impl WideNodes for WideView<'_> {
    unsafe fn read(self, at: Address) -> WideNode {
        // SAFETY: the caller's promise.
        *unsafe { self.node(at) }
    }

    unsafe fn child(self, node: &WideNode, lane: usize) -> Address {
        // SAFETY: the caller's promise.
        unsafe { WideView::child(self, node, lane) }
    }

    unsafe fn ids<'b>(self, node: &WideNode, lane: usize, buffer: &'b mut Ids) -> &'b [u32] {
        // SAFETY: the caller's promise.
        unsafe { WideView::ids(self, node, lane, buffer) }
    }

    unsafe fn corners(self, triangle: u32) -> [[f32; 3]; 3] {
        // SAFETY: the caller's promise.
        unsafe { self.mesh.corners(triangle) }
    }

    fn planes(self) -> Planes {
        *self.grid
    }
}
