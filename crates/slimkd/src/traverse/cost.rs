//! What one ray costs in a tree, whatever the machine: for heat maps and comparisons of trees.

use super::conditions::NO_TRIANGLE;
use super::{Closest, Sink};
use crate::geometry::{Hit, Intersection};

/// What the walk of one ray took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RayCost {
    /// Nodes visited, leaves included.
    pub nodes: u32,
    /// Triangles tested; one that is met in several leaves counts every time.
    pub tests: u32,
}

/// The nearest hit, and what it took to find it.
pub(crate) struct Costed {
    sink: Closest,
    pub(crate) cost: RayCost,
}

impl Costed {
    pub(crate) fn new(t_max: f32) -> Self {
        Self { sink: Closest::new(t_max, NO_TRIANGLE), cost: RayCost::default() }
    }

    pub(crate) fn into_parts(self) -> (Option<Hit>, RayCost) {
        (self.sink.into_hit(), self.cost)
    }
}

impl Sink for Costed {
    const MEASURED: bool = true;

    fn offer(&mut self, found: Intersection, triangle: u32) -> bool {
        self.sink.offer(found, triangle)
    }

    fn limit(&self) -> f32 {
        self.sink.limit()
    }

    fn visit(&mut self) {
        self.cost.nodes += 1;
    }

    fn test(&mut self) {
        self.cost.tests += 1;
    }
}
