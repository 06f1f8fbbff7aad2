//! The interface by which walks read a wide tree that may not be proved: copies of nodes instead of references.

use super::WideNode;
use crate::layout::{Address, Ids, Planes};

/// A wide tree: one that was proved, or one whose view checks every access.
///
/// # Safety
/// Every [`Address`] that [`WideNodes::child`] makes must be that of a node of this tree, and every id that a leaf names must be a triangle
/// of the mesh; or reading at any address and id must be checked.
pub(crate) unsafe trait WideNodes: Copy {
    /// The node at an address; its lanes are as many as it says.
    ///
    /// # Safety
    /// The address must come from this tree: the root, or an inner child of a node.
    unsafe fn read(self, at: Address) -> WideNode;

    /// An inner child.
    ///
    /// # Safety
    /// The node must come from this tree, and the lane must be that of an inner child.
    unsafe fn child(self, node: &WideNode, lane: usize) -> Address;

    /// The ids of a leaf; they lie in `buffer`.
    ///
    /// # Safety
    /// The node must come from this tree, and the lane must be that of a leaf.
    unsafe fn ids<'b>(self, node: &WideNode, lane: usize, buffer: &'b mut Ids) -> &'b [u32];

    /// The corners of a triangle.
    ///
    /// # Safety
    /// The id must come from a leaf of this tree.
    unsafe fn corners(self, triangle: u32) -> [[f32; 3]; 3];

    /// The coordinates of planes.
    fn planes(self) -> Planes;
}
