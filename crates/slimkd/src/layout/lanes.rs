//! What the stream kernel sees of a tree: a node a lane.
//!
//! Inner nodes are read in vector operations, the same bits as [`Nodes`] reads; so each layout decodes them twice, side by
//! side, and the kernels' tests compare both. Leaves differ too much in length: in lanes they took a quarter of a ray.

use super::nodes::{Address, Nodes, PIECE, SPILL};
use crate::simd::Simd;

/// The nodes at each lane's address. Each field is meaningful only in the lanes that its own doc names; other lanes hold anything.
pub(crate) struct LaneStep<S: Simd> {
    /// Where the node is a leaf.
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

    /// Whether the arrays are neither too short nor too long for what the lanes read. All else here needs it.
    fn fit_lanes(self) -> bool;

    /// Reads the nodes at the first 16 addresses.
    ///
    /// # Safety
    /// [`LaneNodes::fit_lanes`] must hold, and in every lane a node of this tree must stand at the address.
    unsafe fn fetch<S: Simd>(self, s: S, addresses: &[u32]) -> (S::U, S::U);

    /// What was read at an address says.
    fn decode<S: Simd>(self, s: S, address: S::U, words: (S::U, S::U)) -> LaneStep<S>;

    /// T-references of inner nodes: which have one, and its triangle there; 0 elsewhere.
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

    /// Takes the next ids off a leaf, ascending, at most [`PIECE`], and returns how many. What follows them in `to` may be overwritten
    /// with anything.
    ///
    /// # Safety
    /// The leaf must come from this tree.
    unsafe fn write(self, leaf: &mut Self::Leaf, to: &mut [u32; PIECE + SPILL]) -> usize;

    /// x, y, z of three corners of a triangle a lane.
    ///
    /// # Safety
    /// [`LaneNodes::fit_lanes`] must hold, and every lane must name a triangle of the mesh.
    unsafe fn lane_corners<S: Simd>(self, s: S, triangle: S::U) -> [[S::F; 3]; 3];
}
