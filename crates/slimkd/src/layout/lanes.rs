//! The interface by which the stream kernel reads a tree: one node in each lane.
//!
//! Inner nodes are read by vector operations and give the same bits as [`Nodes`] does. So each layout has two decoders of inner nodes,
//! and the kernels' tests compare them. Leaves are read one at a time: their lengths differ so much that reading them in lanes took a
//! quarter of a ray's time.

use super::nodes::{Address, MOST_IDS, Nodes, SPILL};
use crate::simd::Simd;

/// The nodes at the lanes' addresses. A field has a meaning only in the lanes that its own doc names; other lanes hold any value.
pub(crate) struct LaneStep<S: Simd> {
    /// The lanes whose node is a leaf.
    pub(crate) leaf: S::M,
    /// Set for every leaf that holds a triangle, and perhaps for others; mask it with `leaf`.
    pub(crate) filled: S::M,
    /// Inner nodes: the axis, 0 to 2.
    pub(crate) axis: S::U,
    /// Inner nodes: the plane, in the layout's coordinates.
    pub(crate) split: S::F,
    /// Inner nodes: the addresses of both children.
    pub(crate) left: S::U,
    pub(crate) right: S::U,
}

/// A proved tree that 16 lanes can read at once, each at its own address.
///
/// # Safety
/// Where [`LaneNodes::fit_lanes`] holds, addresses that [`LaneNodes::decode`] returns for inner nodes must be nodes of this tree, and
/// ids that [`LaneNodes::write`] and [`LaneNodes::t_references`] give must be triangles of the mesh.
pub(crate) unsafe trait LaneNodes: Nodes {
    /// Whether inner nodes may have T-references.
    const T_REFERENCES: bool;

    /// Whether the arrays are neither too short nor too long for the vector reads. Every other function here requires this.
    fn fit_lanes(self) -> bool;

    /// Reads the nodes at the first 16 addresses.
    ///
    /// # Safety
    /// [`LaneNodes::fit_lanes`] must hold, and in every lane a node of this tree must stand at the address.
    unsafe fn fetch<S: Simd>(self, s: S, addresses: &[u32]) -> (S::U, S::U);

    /// Decodes the nodes at `address` from the words that [`LaneNodes::fetch`] read there.
    fn decode<S: Simd>(self, s: S, address: S::U, words: (S::U, S::U)) -> LaneStep<S>;

    /// The T-references of inner nodes: which lanes have one, and its triangle in these lanes; 0 in the others.
    ///
    /// # Safety
    /// [`LaneNodes::fit_lanes`] must hold, and in the lanes of `inner`, `words` must be what [`LaneNodes::fetch`] read of an inner node.
    unsafe fn t_references<S: Simd>(self, s: S, inner: S::M, words: (S::U, S::U)) -> (S::M, S::U);

    /// The leaf at an address.
    ///
    /// # Safety
    /// A leaf of this tree must stand there.
    unsafe fn leaf(self, address: Address) -> Self::Leaf;

    /// Whether all of a leaf's ids are taken.
    fn is_taken(leaf: &Self::Leaf) -> bool;

    /// Takes the next ids off a leaf, ascending, at most [`MOST_IDS`], and returns how many. What follows them in `to` may be overwritten
    /// with anything.
    ///
    /// # Safety
    /// The leaf must come from this tree.
    unsafe fn write(self, leaf: &mut Self::Leaf, to: &mut [u32; MOST_IDS + SPILL]) -> usize;

    /// x, y, z of three corners of a triangle a lane.
    ///
    /// # Safety
    /// [`LaneNodes::fit_lanes`] must hold, and every lane must name a triangle of the mesh.
    unsafe fn lane_corners<S: Simd>(self, s: S, triangle: S::U) -> [[S::F; 3]; 3];
}
