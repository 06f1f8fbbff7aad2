//! The choices against all others, on random trees.

use super::*;
use crate::geometry::{Aabb, TriangleMesh};
use crate::job::Progress;
use crate::options::{BuildOptions, Preset};

/// A random tree over random boxes; half of its splits are in the top.
struct Growing {
    state: u64,
    next_id: u32,
}

impl Growing {
    fn below(&mut self, n: u64) -> u64 {
        self.state = self.state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.state >> 33) % n
    }

    fn part(&mut self, leaves: usize, plan: &mut BoxPlan) -> Aabb {
        let at = plan.nodes.len();
        if leaves == 1 {
            let corner: [f32; 3] = std::array::from_fn(|_| self.below(1000) as f32);
            let size: [f32; 3] = std::array::from_fn(|_| self.below(60) as f32);
            let bounds = Aabb { min: corner, max: std::array::from_fn(|k| corner[k] + size[k]) };
            let count = 1 + self.below(2) as u32;
            plan.nodes.push(BoxNode::leaf(bounds, plan.references.len() as u32, count));
            for _ in 0..count {
                // Now and then a triangle that was there before.
                let again = self.next_id > 0 && self.below(4) == 0;
                let id = if again { self.below(self.next_id.into()) as u32 } else { self.next_id };
                self.next_id += u32::from(!again);
                plan.references.push(id);
            }
            return bounds;
        }
        plan.nodes.push(BoxNode::inner(Aabb::EMPTY));
        let on_left = 1 + self.below(leaves as u64 - 1) as usize;
        let left = self.part(on_left, plan);
        let right_at = plan.nodes.len();
        let right = self.part(leaves - on_left, plan);
        plan.nodes[at].bounds = left.union(&right);
        plan.nodes[at].set_right(right_at);
        plan.nodes[at].bounds
    }

    fn forest(&mut self, leaves: usize, forest: &mut BoxForest, is_top: bool) -> Aabb {
        let at = forest.top.len();
        if !is_top || leaves == 1 {
            let mut part = BoxPlan::default();
            let bounds = self.part(leaves, &mut part);
            forest.top.push(BoxNode::leaf(bounds, forest.parts.len() as u32, 1));
            forest.parts.push(part);
            return bounds;
        }
        forest.top.push(BoxNode::inner(Aabb::EMPTY));
        let on_left = 1 + self.below(leaves as u64 - 1) as usize;
        // What is in the top holds more than a leaf may.
        let left = self.forest(on_left, forest, on_left > 40);
        let right_at = forest.top.len();
        let right = self.forest(leaves - on_left, forest, leaves - on_left > 40);
        forest.top[at].bounds = left.union(&right);
        forest.top[at].set_right(right_at);
        forest.top[at].bounds
    }
}

fn leaf_bytes(ids: &[u32]) -> u64 {
    3 + ids.windows(2).map(|pair| if pair[1] == pair[0] + 1 { 1 } else { 2 }).sum::<u64>()
}

/// J of a choice, added up from its wide nodes and leaves; and the ids that it holds.
fn cost(tree: &Widened<'_>, child: Child, lambda: f64, ids: &mut Vec<u32>) -> f64 {
    let area = tree.bounds(child).surface_area() / tree.forest.bounds().surface_area();
    if child.is_leaf {
        let mut buffer = [0; MOST];
        let own = tree.ids(child, &mut buffer);
        assert!(own.windows(2).all(|pair| pair[0] < pair[1]));
        ids.extend_from_slice(own);
        let quads = own.len().div_ceil(4) as f64;
        return area * (f64::from(LEAF) + f64::from(QUAD) * quads) + lambda * leaf_bytes(own) as f64;
    }
    let mut children = Vec::new();
    tree.children(child, &mut children);
    assert!((2..=WIDTH).contains(&children.len()));
    let below: f64 = children.iter().map(|&child| cost(tree, child, lambda, ids)).sum();
    area * f64::from(NODE) + lambda * 256.0 + below
}

/// The least J of a part as at most so many children, by trying everything.
fn least(plan: &BoxPlan, at: usize, most: usize, root_area: f64, lambda: f64) -> f64 {
    let node = &plan.nodes[at];
    let divided = |most: usize| {
        node.right().map_or(f64::INFINITY, |right| {
            (1..most)
                .map(|k| {
                    least(plan, at + 1, k, root_area, lambda)
                        + least(plan, right, most - k, root_area, lambda)
                })
                .fold(f64::INFINITY, f64::min)
        })
    };
    let area = node.bounds.surface_area() / root_area;
    let (mut first, mut last) = (at, at);
    while plan.nodes[first].right().is_some() {
        first += 1;
    }
    while let Some(right) = plan.nodes[last].right() {
        last = right;
    }
    let range = plan.nodes[first].references().start..plan.nodes[last].references().end;
    let mut ids = plan.references[range].to_vec();
    let mut leaf = f64::INFINITY;
    if ids.len() <= MOST {
        ids.sort_unstable();
        ids.dedup();
        leaf = area * (f64::from(LEAF) + f64::from(QUAD) * ids.len().div_ceil(4) as f64)
            + lambda * leaf_bytes(&ids) as f64;
    }
    let one = leaf.min(area * f64::from(NODE) + lambda * 256.0 + divided(WIDTH));
    if most == 1 { one } else { one.min(divided(most)) }
}

#[test]
fn the_choice_is_the_cheapest() {
    let (mesh, options, progress) =
        (TriangleMesh::default(), BuildOptions::from(Preset::Slim), Progress::new());
    let job = Job::new(&mesh, &options, &progress);
    for seed in 0..60 {
        let mut growing = Growing { state: seed, next_id: 0 };
        // Small ones are tried in every way; larger ones have a top.
        let leaves = if seed < 40 { 1 + seed as usize % 5 } else { 50 + 40 * (seed as usize - 40) };
        let mut forest = BoxForest::default();
        growing.forest(leaves, &mut forest, leaves > 40);
        for lambda in [0.0, 1e-5, 1e-3, 1.0] {
            let tree = widen(&forest, lambda, 256, &leaf_bytes, &job).unwrap();
            let mut ids = Vec::new();
            let counted = cost(&tree, tree.root().unwrap(), lambda, &mut ids);
            assert!((tree.cost() - counted).abs() <= 1e-5 * counted, "{} {counted}", tree.cost());
            ids.sort_unstable();
            ids.dedup();
            assert!(ids.iter().copied().eq(0..growing.next_id), "each triangle is in a leaf");
            if let [only] = &forest.parts[..]
                && leaves <= 5
            {
                let least = least(only, 0, 1, forest.bounds().surface_area(), lambda);
                assert!((tree.cost() - least).abs() <= 1e-5 * least, "{} {least}", tree.cost());
            }
        }
    }
}
