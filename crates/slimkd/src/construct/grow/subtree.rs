//! From a node's fragments to a finished plan, by one thread with an explicit stack.
//!
//! Source: Wald & Havran 2006, algorithm 1 with automatic termination (equation 6).
//!
//! Deviations
//! 1. A leaf also where at most [`BuildOptions::leaf_at_most`] triangles remain: calibrated on the slides' Kitchen row.
//! 2. No recursion on the machine's stack below the parallel top, since depth is bounded only by the scene.
//! 3. Where bytes have a price (`plan/collapse.rs`), a split must also pay for the two nodes that it adds: what would be
//!    collapsed afterwards is mostly not built at all.
//! 4. Every decision depends on the node's contents alone, so thread count and scheduling leave no trace in the tree.

use super::fragment::Fragment;
use super::partition::Partition;
use crate::construct::Builder;
use crate::construct::split::Scratch;
use crate::geometry::Aabb;
use crate::job::memory::{push, room, stretch};
use crate::options::BuildError;
use crate::plan::{Plan, PlanNode, Price};
use std::ops::Range;

/// Nodes between two looks at whether the build was cancelled: a millisecond or less.
const STRIDE: usize = 256;

/// A node on the stack of one thread.
struct Pending {
    /// Its fragments.
    range: Range<usize>,
    voxel: Aabb,
    weight: f64,
    /// The parent, when this is its right child.
    parent: Option<usize>,
}

impl Builder<'_> {
    /// The tree over `fragments`, by this thread alone; moves the progress by `weight`. Where bytes have a price, what would
    /// surely be collapsed is not built.
    pub(in crate::construct) fn subtree(
        &self,
        fragments: Vec<Fragment>,
        voxel: Aabb,
        weight: f64,
        price: Option<Price>,
    ) -> Result<Plan, BuildError> {
        let mut scratch = self.take_scratch();
        let result = self.grow(fragments, voxel, weight, price, &mut scratch);
        self.give_scratch(scratch);
        result
    }

    /// Depth first, left before right. The fragments of all pending nodes lie in one stack, the next node's on top. A right
    /// child takes its parent's place, a left one begins behind its parent: gaps stay, but nothing is copied twice.
    fn grow(
        &self,
        mut fragments: Vec<Fragment>,
        voxel: Aabb,
        weight: f64,
        price: Option<Price>,
        scratch: &mut Scratch,
    ) -> Result<Plan, BuildError> {
        let needs_counts = self.job.options.needs_counts();
        let mut plan = Plan::default();
        let mut done = 0.0;
        let mut pending = vec![Pending { range: 0..fragments.len(), voxel, weight, parent: None }];
        while let Some(Pending { range, voxel, weight, parent }) = pending.pop() {
            let at = plan.nodes.len();
            if at.is_multiple_of(STRIDE) {
                self.job.progress.check()?;
            }
            if needs_counts {
                push(&mut plan.counts, range.len() as u32)?;
            }
            if let Some(PlanNode::Inner { right, .. }) = parent.map(|parent| &mut plan.nodes[parent]) {
                *right = at as u32;
            }
            let margin = price.map_or(0.0, |price| price.of_a_split(&voxel, self.job.options.layout));
            let node = &fragments[range.clone()];
            let Some(split) = scratch.best_split(node, &voxel, self.job.options, margin)? else {
                emit_leaf(&mut plan, &fragments[range])?;
                done += weight;
                if done > 1e-3 {
                    self.job.progress.advance(done);
                    done = 0.0;
                }
                continue;
            };
            let exact = self.job.options.clipping.is_exact_for(range.len() as u32);
            let (start, end) = (range.start, range.end);
            stretch(&mut fragments, end + range.len())?;
            let (here, behind) = fragments.split_at_mut(end);
            let (lefts, rights) = Partition { split, voxel, mesh: self.job.mesh, exact }.run(
                &mut here[start..],
                behind,
                &mut scratch.straddlers,
            )?;
            room(&mut plan.nodes, 1)?;
            plan.nodes.push(PlanNode::Inner { axis: split.axis as u8, split: split.position, right: 0 });
            let (left_voxel, right_voxel) = voxel.split(split.axis, split.position);
            let left_weight = weight * lefts as f64 / ((lefts + rights).max(1)) as f64;
            pending.push(Pending {
                range: start..start + rights,
                voxel: right_voxel,
                weight: weight - left_weight,
                parent: Some(at),
            });
            pending.push(Pending {
                range: end..end + lefts,
                voxel: left_voxel,
                weight: left_weight,
                parent: None,
            });
        }
        self.job.progress.advance(done);
        plan.nodes.shrink_to_fit();
        plan.references.shrink_to_fit();
        plan.counts.shrink_to_fit();
        Ok(plan)
    }
}

/// Appends a leaf of a node's triangles.
fn emit_leaf(plan: &mut Plan, fragments: &[Fragment]) -> Result<(), BuildError> {
    let first = plan.references.len();
    room(&mut plan.references, fragments.len())?;
    plan.references.extend(fragments.iter().map(Fragment::triangle));
    plan.references[first..].sort_unstable();
    let leaf = PlanNode::Leaf { first: first as u32, count: (plan.references.len() - first) as u32 };
    push(&mut plan.nodes, leaf)
}
