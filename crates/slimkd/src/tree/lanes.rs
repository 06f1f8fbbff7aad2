//! What the stream kernel sees of a tree: a node a lane.
//!
//! Inner nodes are read in vector operations, the same bits as [`Nodes`] reads; so each layout decodes them twice, side by
//! side, and the kernels' tests compare both. Leaves differ too much in length: in lanes they took a quarter of a ray.

use super::nodes::{Nodes, PIECE, SPILL};
use crate::traverse::Simd;

/// The nodes at each lane's address. A field counts only in the lanes that it is said to.
pub(crate) struct LaneStep<S: Simd> {
    /// Where the node is a leaf.
    pub(crate) leaf: S::M,
    /// Leaves that hold a triangle, and some of the others.
    pub(crate) filled: S::M,
    /// Inner nodes: the axis, 0 to 2.
    pub(crate) axis: S::U,
    /// Inner nodes: the plane, in the layout's coordinates.
    pub(crate) split: S::F,
    /// Inner nodes: the addresses of both children.
    pub(crate) left: S::U,
    pub(crate) right: S::U,
}

/// A proven tree that 16 lanes can read at once, each at its own address.
pub(crate) trait LaneNodes: Nodes {
    /// Whether inner nodes may have T-references.
    const T_REFERENCES: bool;

    /// False where an array is too short or too long for what the lanes read; then this trait must not be used.
    fn fit_lanes(self) -> bool;

    /// Reads the nodes at addresses of this tree, one for every lane.
    fn fetch<S: Simd>(self, s: S, addresses: &[u32]) -> (S::U, S::U);

    /// What was read there says.
    fn decode<S: Simd>(self, s: S, address: S::U, words: (S::U, S::U)) -> LaneStep<S>;

    /// T-references of inner nodes: which have one, and its triangle there; 0 elsewhere.
    fn t_references<S: Simd>(self, s: S, inner: S::M, words: (S::U, S::U)) -> (S::M, S::U);

    /// The leaf at an address of this tree where one stands.
    fn leaf(self, address: u32) -> Self::Leaf;

    /// Whether all of a leaf's ids are taken.
    fn is_taken(leaf: &Self::Leaf) -> bool;

    /// Takes the next ids off a leaf, ascending, at most [`PIECE`]: how many. What follows them in `to` may be overwritten with anything.
    fn write(self, leaf: &mut Self::Leaf, to: &mut [u32; PIECE + SPILL]) -> usize;

    /// x, y, z of three corners of a triangle a lane. Every lane must name a triangle of the mesh.
    fn lane_corners<S: Simd>(self, s: S, triangle: S::U) -> [[S::F; 3]; 3];
}
