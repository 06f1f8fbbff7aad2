//! What the stream kernel sees of a tree: a node a lane.
//!
//! The same bits as [`Nodes`] reads, in vector operations; so each layout decodes twice, side by side, and the kernels'
//! tests compare both.

use super::nodes::Nodes;
use crate::traverse::Simd;

/// The nodes at each lane's address. A field counts only in the lanes that it is said to.
pub(crate) struct LaneStep<S: Simd> {
    /// Where the node is a leaf.
    pub(crate) leaf: S::M,
    /// Leaves that hold a triangle.
    pub(crate) filled: S::M,
    /// Inner nodes: the axis, 0 to 2.
    pub(crate) axis: S::U,
    /// Inner nodes: the plane, in the layout's coordinates.
    pub(crate) split: S::F,
    /// Inner nodes: the address of the left child.
    pub(crate) left: S::U,
    /// Inner nodes: from there to the right child.
    pub(crate) stride: S::U,
}

/// A proven tree that 16 lanes can read at once, each at its own address.
pub(crate) trait LaneNodes: Nodes {
    /// Whether inner nodes may have T-references.
    const T_REFERENCES: bool;
    /// Leaves in reading, one a lane.
    type Leaves<S: Simd>;

    /// False where an array is too short or too long for what the lanes read; then this trait must not be used.
    fn fit_lanes(self) -> bool;

    /// Reads the nodes at addresses of this tree, one for every lane.
    fn fetch<S: Simd>(self, s: S, addresses: &[u32]) -> (S::U, S::U);

    /// What was read there says.
    fn decode<S: Simd>(self, s: S, address: S::U, words: (S::U, S::U)) -> LaneStep<S>;

    /// T-references of inner nodes: which have one, and its triangle there; 0 elsewhere.
    fn t_references<S: Simd>(self, s: S, inner: S::M, words: (S::U, S::U)) -> (S::M, S::U);

    /// Begins to read leaves, in the lanes of `valid`. Every lane must hold an address of this tree.
    fn open<S: Simd>(self, s: S, valid: S::M, addresses: &[u32]) -> Self::Leaves<S>;

    /// The next triangle of each leaf, and which leaves still had one; the others give a triangle of the mesh.
    fn next<S: Simd>(self, s: S, leaves: &mut Self::Leaves<S>) -> (S::M, S::U);

    /// x, y, z of three corners of a triangle a lane. Every lane must name a triangle of the mesh.
    fn lane_corners<S: Simd>(self, s: S, triangle: S::U) -> [[S::F; 3]; 3];
}
