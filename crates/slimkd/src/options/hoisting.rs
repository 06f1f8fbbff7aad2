//! When a triangle moves to an inner node: the paper's thresholds, and how the tree below is made anew.

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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Hoisting {
    /// A triangle must have a larger occupancy measure than this, 0 to 1.
    pub occupancy: f32,
    /// A triangle must have a larger frequency measure than this, 0 to 1.
    pub frequency: f32,
    /// Whether subtrees are stripped or built anew after a pick.
    pub algorithm: HoistAlgorithm,
}

impl Hoisting {
    /// The paper's rule with these thresholds, and the reading of its slides that comes nearest to its tables.
    pub fn new(occupancy: f32, frequency: f32) -> Self {
        Self { occupancy, frequency, algorithm: HoistAlgorithm::Strip }
    }

    /// The thresholds with their names.
    pub(crate) fn thresholds(&self) -> [(&'static str, f32); 2] {
        [("occupancy", self.occupancy), ("frequency", self.frequency)]
    }
}

/// How the tree under a node changes once a triangle was picked there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[repr(u8)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum HoistAlgorithm {
    /// One pass over the finished tree: the triangle is taken out of the leaves, and nodes that the leaf rule ends now
    /// become leaves. Our answer to the paper's "future work".
    Strip = 0,
    /// The paper's: the subtree is built anew without the triangle, then searched again.
    Rebuild = 1,
}
