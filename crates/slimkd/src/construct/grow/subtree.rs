//! From a node's fragments to a finished plan, by one thread with an explicit stack.
//!
//! Source: Wald & Havran 2006, algorithm 1 with automatic termination (equation 6).
//!
//! Deviations
//! 1. A node of at most [`BuildOptions::leaf_at_most`] triangles is a leaf too: calibrated on the slides' Kitchen row.
//! 2. No recursion on the machine's stack below the parallel top, since depth is bounded only by the scene.
//! 3. Where bytes have a price (`plan/price.rs`), a split must also pay for the two nodes that it adds, so that most of what would be
//!    collapsed afterwards is not built at all.
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
const NODES_A_LOOK: usize = 256;

/// A node on the stack of one thread.
struct Pending {
    /// Where its fragments lie in the stack of fragments.
    range: Range<usize>,
    voxel: Aabb,
    /// How far the progress moves when everything below this node is built.
    share: f64,
    /// The parent's position in the plan, when this is its right child: the parent must be told where that begins.
    parent: Option<usize>,
}

impl Builder<'_> {
    /// The plan of the subtree over `fragments`, built by this thread alone; moves the progress by `share`. Where bytes have a price,
    /// splits that do not pay for their bytes are not made (deviation 3).
    pub(in crate::construct) fn subtree(
        &self,
        fragments: Vec<Fragment>,
        voxel: Aabb,
        share: f64,
        price: Option<Price>,
    ) -> Result<Plan, BuildError> {
        let mut scratch = self.take_scratch();
        let result = self.grow(fragments, voxel, share, price, &mut scratch);
        self.give_scratch(scratch);
        result
    }

    /// Builds depth first, left before right. The fragments of all pending nodes lie in one stack, those of the next node on top. The
    /// fragments of a right child are written where its parent's were, those of a left child behind them. This leaves gaps in
    /// the stack, but no fragment is copied twice.
    fn grow(
        &self,
        mut fragments: Vec<Fragment>,
        voxel: Aabb,
        share: f64,
        price: Option<Price>,
        scratch: &mut Scratch,
    ) -> Result<Plan, BuildError> {
        let needs_counts = self.job.options.needs_counts();
        let mut plan = Plan::default();
        // Progress that was made but not reported yet.
        let mut done = 0.0;
        let mut pending = vec![Pending { range: 0..fragments.len(), voxel, share, parent: None }];
        while let Some(Pending { range, voxel, share, parent }) = pending.pop() {
            // 1. The node gets the next place in the plan; its parent is told if this is the right child.
            let at = plan.nodes.len();
            if at.is_multiple_of(NODES_A_LOOK) {
                self.job.progress.check()?;
            }
            if needs_counts {
                push(&mut plan.counts, range.len() as u32)?;
            }
            if let Some(PlanNode::Inner { right, .. }) = parent.map(|parent| &mut plan.nodes[parent]) {
                *right = at as u32;
            }
            // 2. Find the best split; without one that pays, the node is a leaf.
            let margin = price.map_or(0.0, |price| price.of_a_split(&voxel, self.job.options.layout));
            let node = &fragments[range.clone()];
            let Some(split) = scratch.best_split(node, &voxel, self.job.options, margin)? else {
                emit_leaf(&mut plan, &fragments[range])?;
                done += share;
                if done > 1e-3 {
                    self.job.progress.advance(done);
                    done = 0.0;
                }
                continue;
            };
            // 3. Partition the fragments: the right child's in place of this node's, the left child's behind them.
            let exact = self.job.options.clipping.is_exact_for(range.len() as u32);
            let (start, end) = (range.start, range.end);
            stretch(&mut fragments, end + range.len())?;
            let (here, behind) = fragments.split_at_mut(end);
            let (lefts, rights) = Partition { split, voxel, mesh: self.job.mesh, exact }.run(
                &mut here[start..],
                behind,
                &mut scratch.straddlers,
            )?;
            // 4. Write the node, and push its children, the left one last so that it is next.
            room(&mut plan.nodes, 1)?;
            plan.nodes.push(PlanNode::Inner { axis: split.axis as u8, split: split.position, right: 0 });
            let (left_voxel, right_voxel) = voxel.split(split.axis, split.position);
            let left_share = share * lefts as f64 / ((lefts + rights).max(1)) as f64;
            pending.push(Pending {
                range: start..start + rights,
                voxel: right_voxel,
                share: share - left_share,
                parent: Some(at),
            });
            pending.push(Pending {
                range: end..end + lefts,
                voxel: left_voxel,
                share: left_share,
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

/// Appends a leaf of a node's triangles, ascending by id.
fn emit_leaf(plan: &mut Plan, fragments: &[Fragment]) -> Result<(), BuildError> {
    let first = plan.references.len();
    room(&mut plan.references, fragments.len())?;
    plan.references.extend(fragments.iter().map(Fragment::triangle));
    plan.references[first..].sort_unstable();
    let leaf = PlanNode::Leaf { first: first as u32, count: (plan.references.len() - first) as u32 };
    push(&mut plan.nodes, leaf)
}
