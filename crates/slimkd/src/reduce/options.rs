//! When a triangle moves to an inner node: the paper's thresholds, and what its slides leave open.

/// How triangles are hoisted into inner nodes (Choi, Chang & Ihm 2013).
///
/// ```
/// use slimkd::{BuildOptions, HoistAlgorithm, Preset};
/// let mut options = BuildOptions::from(Preset::PaperFast);
/// let hoisting = options.hoisting.as_mut().unwrap();
/// assert_eq!((hoisting.occupancy, hoisting.frequency), (0.9, 0.7));
/// hoisting.algorithm = HoistAlgorithm::Rebuild;
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Hoisting {
    /// A triangle must have a larger occupancy measure than this, 0 to 1.
    pub occupancy: f32,
    /// A triangle must have a larger frequency measure than this, 0 to 1.
    pub frequency: f32,
    /// Whether subtrees are stripped or built anew after a pick.
    pub algorithm: HoistAlgorithm,
    /// What the occupancy measure is divided by. Open in the slides.
    pub occupancy_base: OccupancyBase,
    /// Which leaves the denominators count. Open in the slides.
    pub leaves: CountedLeaves,
    /// What happens where a leaf remains once the picked triangle is gone. Open in the slides.
    pub when_leaf_remains: WhenLeafRemains,
}

impl Hoisting {
    /// The paper's rule with these thresholds, and the reading of its slides that comes nearest to its tables.
    pub fn new(occupancy: f32, frequency: f32) -> Self {
        Self {
            occupancy,
            frequency,
            algorithm: HoistAlgorithm::Strip,
            occupancy_base: OccupancyBase::LeafAreas,
            leaves: CountedLeaves::All,
            when_leaf_remains: WhenLeafRemains::MakeLeaf,
        }
    }

    /// The thresholds with their names.
    pub(crate) fn thresholds(&self) -> [(&'static str, f32); 2] {
        [("occupancy", self.occupancy), ("frequency", self.frequency)]
    }
}

/// How the tree under a node changes once a triangle was picked there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum HoistAlgorithm {
    /// One pass over the finished tree: the triangle is taken out of the leaves, and nodes that the leaf rule ends now
    /// become leaves. Our answer to the paper's "future work".
    Strip,
    /// While building, by measures that are estimated before there is a subtree. One pass, no second look.
    Predict,
    /// The paper's: the subtree is built anew without the triangle, then searched again.
    Rebuild,
}

/// The denominator of the occupancy measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OccupancyBase {
    /// The summed surface area of the counted leaves: "normalized between 0 and 1".
    LeafAreas,
    /// The surface area of the node's voxel; may exceed 1.
    NodeArea,
}

/// Which leaves of a subtree the measures' denominators count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CountedLeaves {
    /// Every leaf.
    All,
    /// Leaves that hold a triangle.
    NotEmpty,
}

/// What happens to a pick under which only a leaf would remain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum WhenLeafRemains {
    /// The node becomes a leaf of all its triangles, the picked one included.
    MakeLeaf,
    /// The node keeps its split and no triangle is hoisted.
    DropPick,
}
