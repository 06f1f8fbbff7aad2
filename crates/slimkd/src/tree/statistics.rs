//! The shape of a tree in numbers.

use crate::layout::LeafMode;

/// Nodes by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct NodeCounts {
    /// Inner nodes without a T-reference.
    pub inner: u64,
    /// Inner nodes that hold a T-reference.
    pub t_inner: u64,
    /// Leaves, empty ones included.
    pub leaf: u64,
    /// Leaves without a triangle.
    pub empty_leaf: u64,
}

/// Triangle references of the leaves by mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LeafReferences {
    /// In 4-byte mode.
    pub four_byte: u64,
    /// In 2-byte mode.
    pub two_byte: u64,
    /// In any other mode: the dense layout's byte codes.
    pub other: u64,
}

impl LeafReferences {
    pub(super) fn of(&mut self, mode: LeafMode) -> &mut u64 {
        match mode {
            LeafMode::FourByte => &mut self.four_byte,
            LeafMode::TwoByte => &mut self.two_byte,
            LeafMode::Coded => &mut self.other,
        }
    }
}

/// What a tree looks like.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TreeStatistics {
    /// Triangles of the mesh, degenerate ones included.
    pub triangles: u64,
    /// Triangles that can never hit: collinear or not finite.
    pub degenerate: u64,
    /// Nodes by kind.
    pub nodes: NodeCounts,
    /// References of the leaves by mode.
    pub leaf_references: LeafReferences,
    /// References held by inner nodes.
    pub t_references: u64,
    /// Depth of the deepest leaf; the root has depth 0.
    pub max_depth: u32,
    /// Leaves by depth: element d counts those at depth d.
    pub leaf_depths: Vec<u64>,
    /// Triangles by number of references in the intervals of [`TreeStatistics::DUPLICATION_INTERVALS`].
    pub duplication: Vec<u64>,
    /// Expected cost of a random ray that meets the root's voxel, by SAH.
    pub sah_cost: f64,
}

impl TreeStatistics {
    /// Inclusive intervals of [`TreeStatistics::duplication`]: 0, the slides' 31, and above 15,000.
    pub const DUPLICATION_INTERVALS: &[(u32, u32)] = &[
        (0, 0),
        (1, 10),
        (11, 20),
        (21, 30),
        (31, 40),
        (41, 50),
        (51, 60),
        (61, 70),
        (71, 80),
        (81, 90),
        (91, 100),
        (101, 200),
        (201, 300),
        (301, 400),
        (401, 500),
        (501, 600),
        (601, 700),
        (701, 800),
        (801, 900),
        (901, 1000),
        (1001, 1100),
        (1101, 1200),
        (1201, 1300),
        (1301, 1400),
        (1401, 1500),
        (1501, 2000),
        (2001, 3000),
        (3001, 4000),
        (4001, 5000),
        (5001, 9000),
        (9001, 10000),
        (10001, 15000),
        (15001, u32::MAX),
    ];

    /// Triangles by number of references; `degenerate` ones are not in the tree by design and not counted.
    pub(super) fn intervals(per_triangle: &[u32], degenerate: u64) -> Vec<u64> {
        let mut duplication = vec![0u64; Self::DUPLICATION_INTERVALS.len()];
        for &count in per_triangle {
            duplication[Self::DUPLICATION_INTERVALS.partition_point(|&(_, last)| last < count)] += 1;
        }
        duplication[0] -= degenerate;
        duplication
    }

    /// All references, in leaves and in inner nodes.
    pub fn references(&self) -> u64 {
        let r = &self.leaf_references;
        r.four_byte + r.two_byte + r.other + self.t_references
    }

    /// References per triangle, T-references included: the slides' "triangle redundancy".
    pub fn redundancy(&self) -> f64 {
        self.references() as f64 / self.triangles.max(1) as f64
    }
}
