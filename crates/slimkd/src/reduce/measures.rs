//! The two measures and the choice that they make.
//!
//! Source: Choi, Chang & Ihm 2013, "Two Heuristic Metrics for Triangle Selection".
//! - occupancy `f_occ(t, T_I) = Σ_{L ∋ t} p(L) / Σ_L p(L)`, p = surface area of the leaf's voxel;
//! - frequency `f_freq(t, T_I) = |{L ∋ t}| / |{L}|`;
//! - `pick_triangle(T_I)`: of the triangles whose occupancy exceeds its threshold, by falling occupancy, the first whose
//!   frequency exceeds its own.
//!
//! Deviation: "the first by falling occupancy" is found as a maximum; equal occupancies fall to the lowest id.

use super::options::{CountedLeaves, Hoisting, OccupancyBase};
use super::work::Work;

/// What the leaves under a node say about one triangle.
#[derive(Clone, Copy, Debug)]
struct Tally {
    id: u32,
    leaves: u32,
    area: f64,
}

/// Tallies the triangles of a subtree; reused from node to node.
pub(crate) struct Picker<'a> {
    hoisting: &'a Hoisting,
    /// Position in `tallies` by triangle; `u32::MAX` where it has none.
    slots: Vec<u32>,
    tallies: Vec<Tally>,
}

impl<'a> Picker<'a> {
    pub(crate) fn new(hoisting: &'a Hoisting, triangles: usize) -> Self {
        Self { hoisting, slots: vec![u32::MAX; triangles], tallies: Vec::new() }
    }

    /// `pick_triangle` for the subtree at `at`.
    pub(crate) fn pick(&mut self, work: &Work, at: usize) -> Option<u32> {
        let (mut leaves, mut leaf_area) = (0u32, 0.0f64);
        for (leaf, first, count) in work.leaves(at) {
            let area = f64::from(work.areas[leaf]);
            if count > 0 || self.hoisting.leaves == CountedLeaves::All {
                leaves += 1;
                leaf_area += area;
            }
            for &id in work.ids(first, count) {
                let slot = &mut self.slots[id as usize];
                if *slot == u32::MAX {
                    *slot = self.tallies.len() as u32;
                    self.tallies.push(Tally { id, leaves: 0, area: 0.0 });
                }
                let tally = &mut self.tallies[*slot as usize];
                tally.leaves += 1;
                tally.area += area;
            }
        }
        let base = match self.hoisting.occupancy_base {
            OccupancyBase::LeafAreas => leaf_area,
            OccupancyBase::NodeArea => f64::from(work.areas[at]),
        };
        let (least_area, least_leaves) = (
            f64::from(self.hoisting.occupancy) * base,
            f64::from(self.hoisting.frequency) * f64::from(leaves),
        );
        let best = self
            .tallies
            .iter()
            .filter(|tally| tally.area > least_area && f64::from(tally.leaves) > least_leaves)
            .max_by(|a, b| a.area.total_cmp(&b.area).then(b.id.cmp(&a.id)))
            .map(|tally| tally.id);
        for tally in self.tallies.drain(..) {
            self.slots[tally.id as usize] = u32::MAX;
        }
        best
    }
}
