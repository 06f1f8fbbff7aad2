//! Reads of a wide tree that nobody has proved.

use super::nodes::WideNodes;
use super::{LANES, LeafCode, PADDING, WideNode};
use crate::geometry::Aabb;
use crate::layout::checked::{CheckedMesh, Guard, bytes_at};
use crate::layout::{Address, Ids, Planes};

/// The sections' bytes, and what follows from the mesh.
#[derive(Clone, Copy)]
pub(crate) struct CheckedWide<'a> {
    pub(crate) nodes: &'a [u8],
    pub(crate) leaves: &'a [u8],
    /// [`CheckedWide::grid`]'s.
    pub(crate) grid: &'a Planes,
    pub(crate) triangles: usize,
    pub(crate) mesh: CheckedMesh<'a>,
    pub(crate) guard: &'a Guard,
}

impl CheckedWide<'_> {
    /// The planes over these bounds; `None` where no such tree has this layout.
    pub(crate) fn grid(leaf_bytes: usize, bounds: &Aabb, triangles: usize) -> Option<Planes> {
        super::fits(leaf_bytes, triangles).then(|| super::grid(bounds))?
    }

    fn node(self, at: usize) -> Option<WideNode> {
        self.guard.node()?;
        let bytes =
            bytes_at::<{ size_of::<WideNode>() }>(self.nodes, at.checked_mul(size_of::<WideNode>())?)?;
        let node: WideNode = bytemuck::pod_read_unaligned(&bytes);
        let node = if cfg!(target_endian = "big") { node.swapped() } else { node };
        (node.inner() <= node.children() && node.children() <= LANES).then_some(node)
    }

    /// How many ids there are.
    fn leaf(self, node: &WideNode, lane: usize, buffer: &mut Ids) -> Option<usize> {
        let start = node.leaves.checked_add(node.offsets[lane].into())?;
        let long = |at: u32| {
            let bytes = bytes_at::<PADDING>(self.leaves, at as usize);
            bytes.map_or_else(|| self.guard.breaks().unwrap_or(0), u64::from_le_bytes)
        };
        let count = LeafCode::new(self.triangles).read(start, buffer, long);
        self.guard.references(count as u32)?;
        (!self.guard.is_broken()).then_some(count)
    }
}

// SAFETY: every access is checked, whatever the address, the lane or the id.
unsafe impl WideNodes for CheckedWide<'_> {
    unsafe fn read(self, at: Address) -> WideNode {
        let node = self.node(at.get() as usize).or_else(|| self.guard.breaks());
        node.unwrap_or_else(bytemuck::Zeroable::zeroed)
    }

    unsafe fn child(self, node: &WideNode, lane: usize) -> Address {
        // SAFETY: this view checks every address.
        unsafe { Address::new(node.nodes.wrapping_add(lane as u32)) }
    }

    unsafe fn ids<'b>(self, node: &WideNode, lane: usize, buffer: &'b mut Ids) -> &'b [u32] {
        let count = self.leaf(node, lane, buffer).or_else(|| self.guard.breaks()).unwrap_or(0);
        // SAFETY: that many were written.
        unsafe { buffer.written(count) }
    }

    unsafe fn corners(self, triangle: u32) -> [[f32; 3]; 3] {
        self.mesh.corners(self.guard, triangle)
    }

    fn planes(self) -> Planes {
        *self.grid
    }
}
