//! The two measures and the choice that they make.
//!
//! Source: Choi, Chang & Ihm 2013, "Two Heuristic Metrics for Triangle Selection".
//! - occupancy `f_occ(t, T_I) = Σ_{L ∋ t} p(L) / Σ_L p(L)`, p = surface area of the leaf's voxel;
//! - frequency `f_freq(t, T_I) = |{L ∋ t}| / |{L}|`;
//! - `pick_triangle(T_I)`: of the triangles whose occupancy exceeds its threshold, by falling occupancy, the first whose
//!   frequency exceeds its own.
//!
//! Deviation: "the first by falling occupancy" is found as a maximum; equal occupancies fall to the lowest id.

use crate::job::Job;
use crate::job::memory::filled;
use crate::options::BuildError;
use crate::options::Hoisting;
use crate::plan::Work;

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
    pub(crate) fn new(hoisting: &'a Hoisting, triangles: usize) -> Result<Self, BuildError> {
        Ok(Self { hoisting, slots: filled(u32::MAX, triangles)?, tallies: Vec::new() })
    }

    /// `pick_triangle` for the subtree at `at`.
    pub(crate) fn pick(&mut self, work: &Work, at: usize, job: &Job<'_>) -> Result<Option<u32>, BuildError> {
        let (mut leaves, mut leaf_area) = (0u32, 0.0f64);
        for (steps, (leaf, first, count)) in work.leaves(at).enumerate() {
            if steps % (1 << 12) == (1 << 12) - 1 {
                job.check()?;
            }
            let area = f64::from(work.areas[leaf]);
            leaves += 1;
            leaf_area += area;
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
        let (least_area, least_leaves) = (
            f64::from(self.hoisting.occupancy) * leaf_area,
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
        Ok(best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::construct::Builder;
    use crate::construct::Pace;
    use crate::geometry::{Aabb, TriangleMesh};
    use crate::job::Progress;
    use crate::options::BuildOptions;
    use crate::plan::{Plan, PlanNode};
    use std::collections::BTreeMap;

    /// Twelve walls across a cube, so that some triangles lie in most leaves, and fifty crumbs.
    fn mesh() -> TriangleMesh {
        let mut vertices: Vec<[f32; 3]> = Vec::new();
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        for i in 0..62 {
            let size = if i < 12 { 2.0 } else { 0.05 };
            let center: [f32; 3] = std::array::from_fn(|_| random());
            for _ in 0..3 {
                vertices.push(center.map(|x| x + size * (random() - 0.5)));
            }
        }
        let triangles = (0..62).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        TriangleMesh::new(vertices, triangles).unwrap()
    }

    /// The slides' formulas, leaf by leaf, with sets and maps.
    fn naive_pick(work: &Work, at: usize, hoisting: &Hoisting) -> Option<u32> {
        let leaves: Vec<(f64, Vec<u32>)> = (at..work.ends[at] as usize)
            .filter_map(|node| match work.plan.nodes[node] {
                PlanNode::Leaf { first, count } => {
                    Some((f64::from(work.areas[node]), work.ids(first, count).to_vec()))
                }
                PlanNode::Inner { .. } => None,
            })
            .collect();
        let all_area: f64 = leaves.iter().map(|(area, _)| area).sum();
        let mut measures: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
        for (area, ids) in &leaves {
            for &id in ids {
                let entry = measures.entry(id).or_default();
                entry.0 += area / all_area;
                entry.1 += 1.0 / leaves.len() as f64;
            }
        }
        let mut candidates: Vec<_> =
            measures.into_iter().filter(|&(_, (occ, _))| occ > f64::from(hoisting.occupancy)).collect();
        candidates.sort_by(|a, b| b.1.0.total_cmp(&a.1.0));
        candidates.into_iter().find(|&(_, (_, freq))| freq > f64::from(hoisting.frequency)).map(|(id, _)| id)
    }

    #[test]
    fn picks_agree_with_the_formulas_written_out() {
        let mesh = mesh();
        let (ids, bounds) = mesh.valid_triangles();
        let (options, progress) = (BuildOptions::default(), Progress::new());
        let job = Job::new(&mesh, &options, &progress);
        let builder = Builder::new(&job, bounds, None).unwrap();
        let plan = builder.build(&ids, &Pace::of(&options, ids.len(), 1)).unwrap();
        let nodes = plan.nodes.len();
        let work = Work::new(plan, &bounds, &job).unwrap();
        let mut found = 0;
        for (occupancy, frequency) in [(0.9, 0.7), (0.5, 0.4), (0.3, 0.2), (0.02, 0.01)] {
            let hoisting = Hoisting::new(occupancy, frequency);
            let mut picker = Picker::new(&hoisting, mesh.len()).unwrap();
            for at in 0..nodes {
                let picked = picker.pick(&work, at, &job).unwrap();
                let expected = naive_pick(&work, at, &hoisting);
                assert_eq!(picked, expected, "node {at}, thresholds {occupancy}, {frequency}");
                found += usize::from(picked.is_some());
            }
        }
        assert!(found > 50, "only {found} picks: the test proves nothing");
    }

    #[test]
    fn a_triangle_in_every_leaf_has_both_measures_one() {
        let plan = Plan {
            nodes: vec![
                PlanNode::Inner { axis: 0, split: 0.5, right: 2 },
                PlanNode::Leaf { first: 0, count: 2 },
                PlanNode::Leaf { first: 2, count: 1 },
            ],
            references: vec![0, 7, 7],
            counts: vec![2, 2, 1],
            hoisted: Vec::new(),
            price: None,
        };
        let (mesh, options, progress) = (mesh(), BuildOptions::default(), Progress::new());
        let job = Job::new(&mesh, &options, &progress);
        let work = Work::new(plan, &Aabb { min: [0.0; 3], max: [1.0; 3] }, &job).unwrap();
        let pick = |occupancy, frequency| {
            let hoisting = Hoisting::new(occupancy, frequency);
            Picker::new(&hoisting, 8).unwrap().pick(&work, 0, &job).unwrap()
        };
        assert_eq!(pick(0.999, 0.999), Some(7));
        assert_eq!(pick(1.0, 0.0), None, "thresholds are strict");
    }
}
