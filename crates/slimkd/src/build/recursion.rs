//! From a node's fragments to a finished plan, by one thread with an explicit stack.
//!
//! Source: Wald & Havran 2006, algorithm 1 with automatic termination (equation 6).
//!
//! Deviations
//! 1. A leaf also where at most [`BuildOptions::leaf_at_most`] triangles remain: calibrated on the slides' Kitchen row.
//! 2. No recursion on the machine's stack below the parallel top, since depth is bounded only by the scene.
//! 3. Where bytes have a price (`reduce/collapse.rs`), a split must also pay for the two nodes that it adds: what would be
//!    collapsed afterwards is mostly not built at all.
//! 4. Every decision depends on the node's contents alone, so thread count and scheduling leave no trace in the tree.

use super::fragment::{Fragment, TRIANGLE_LIMIT};
use super::memory::{Memory, push, room, stretch};
use super::partition::Partition;
use super::plan::{Plan, PlanNode};
use super::predict::Predictor;
use super::price::Bound;
use super::search::Scratch;
use super::{BuildError, BuildOptions, Layout, Progress};
use crate::geometry::{Aabb, TriangleMesh};
use crate::reduce::{Bytes, HoistAlgorithm};
use std::ops::Range;
use std::sync::Mutex;

/// Nodes between two looks at whether the build was cancelled: a millisecond or less.
const STRIDE: usize = 256;

/// Builds standard trees over parts of one mesh; what all workers of a build share.
pub(crate) struct Builder<'a> {
    pub(super) mesh: &'a TriangleMesh,
    pub(super) options: &'a BuildOptions,
    pub(super) progress: &'a Progress,
    /// What the finished tree must keep to, if anything.
    pub(super) bound: Option<Bound<'a>>,
    pub(crate) memory: Memory,
    scratch: Mutex<Vec<Box<Scratch>>>,
}

/// What bytes cost beside rays, for a subtree that will be collapsed by both.
#[derive(Clone, Copy, Debug)]
pub(super) struct PriceOfBytes {
    /// λ: SAH cost of the root's voxel that a byte must save.
    pub(super) lambda: f64,
    /// Surface area of the root's voxel.
    pub(super) root_area: f64,
}

impl PriceOfBytes {
    /// How much cheaper than a leaf a split must be so that the two nodes that it adds pay.
    fn margin(&self, voxel: &Aabb, layout: Layout) -> f64 {
        let added = 2.0 * Bytes::of(layout).node * self.lambda;
        if added > 0.0 { added * self.root_area / voxel.surface_area() } else { 0.0 }
    }
}

/// A node on the stack of one thread.
struct Pending {
    /// Its fragments.
    range: Range<usize>,
    voxel: Aabb,
    weight: f64,
    /// The parent, when this is its right child.
    parent: Option<usize>,
}

impl<'a> Builder<'a> {
    pub(crate) fn new(
        mesh: &'a TriangleMesh,
        options: &'a BuildOptions,
        progress: &'a Progress,
    ) -> Result<Self, BuildError> {
        let (needed, limit) = (mesh.len() as u64, TRIANGLE_LIMIT);
        if needed > limit {
            return Err(BuildError::TooLarge { what: "triangles", needed, limit });
        }
        Ok(Self {
            mesh,
            options,
            progress,
            bound: None,
            memory: Memory::new(options.max_build_bytes),
            scratch: Mutex::new(Vec::new()),
        })
    }

    /// For a tree that keeps to a bound.
    pub(crate) fn within(self, bound: Option<Bound<'a>>) -> Self {
        Self { bound, ..self }
    }

    /// An error once the build was cancelled.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        self.progress.check()
    }

    /// The same now and then: for loops over a whole tree, which call it with their index.
    #[inline]
    pub(crate) fn check_at(&self, index: usize) -> Result<(), BuildError> {
        self.progress.check_at(index)
    }

    pub(crate) fn progress(&self) -> &Progress {
        self.progress
    }

    pub(crate) fn mesh(&self) -> &TriangleMesh {
        self.mesh
    }

    pub(crate) fn options(&self) -> &BuildOptions {
        self.options
    }

    pub(super) fn take_scratch(&self) -> Box<Scratch> {
        self.scratch.lock().expect("no worker panics").pop().unwrap_or_default()
    }

    pub(super) fn give_scratch(&self, scratch: Box<Scratch>) {
        self.scratch.lock().expect("no worker panics").push(scratch);
    }

    pub(super) fn drop_scratch(&self) {
        self.scratch.lock().expect("no worker panics").clear();
    }

    /// The standard tree over what `voxel` holds of `triangles`, on this thread alone.
    pub(crate) fn rebuild(&self, triangles: &[u32], voxel: Aabb) -> Result<Plan, BuildError> {
        let exact = self.options.clipping.is_exact_for(triangles.len() as u32);
        let fragments =
            triangles.iter().map(|&id| Fragment::in_voxel(self.mesh, id, &voxel, exact)).collect();
        self.sequential(fragments, voxel, 0.0, None)
    }

    /// The tree over `fragments`, on this thread alone; moves the progress by `weight`.
    pub(super) fn sequential(
        &self,
        fragments: Vec<Fragment>,
        voxel: Aabb,
        weight: f64,
        bytes: Option<PriceOfBytes>,
    ) -> Result<Plan, BuildError> {
        let mut scratch = self.take_scratch();
        let result = self.build_stack(fragments, voxel, weight, bytes, &mut scratch);
        self.give_scratch(scratch);
        result
    }

    /// Depth first, left before right. The fragments of all pending nodes lie in one stack, the next node's on top. A right
    /// child takes its parent's place, a left one begins behind its parent: gaps stay, but nothing is copied twice.
    fn build_stack(
        &self,
        mut fragments: Vec<Fragment>,
        voxel: Aabb,
        weight: f64,
        bytes: Option<PriceOfBytes>,
        scratch: &mut Scratch,
    ) -> Result<Plan, BuildError> {
        let predicting = self.options.hoisting.as_ref().filter(|h| h.algorithm == HoistAlgorithm::Predict);
        let mut predictor = predicting.map(Predictor::new);
        let needs_counts = self.options.needs_counts();
        let mut plan = Plan::default();
        let mut done = 0.0;
        let mut pending = vec![Pending { range: 0..fragments.len(), voxel, weight, parent: None }];
        while let Some(Pending { mut range, voxel, weight, parent }) = pending.pop() {
            let at = plan.nodes.len();
            if at.is_multiple_of(STRIDE) {
                self.progress.check()?;
            }
            if needs_counts {
                push(&mut plan.counts, range.len() as u32)?;
            }
            if let Some(PlanNode::Inner { right, .. }) = parent.map(|parent| &mut plan.nodes[parent]) {
                *right = at as u32;
            }
            let mut hoisted = None;
            if let Some(predictor) = &mut predictor
                && range.len() > self.options.leaf_at_most as usize
            {
                hoisted = predictor.pick(&mut fragments[range.clone()]);
                range.end -= usize::from(hoisted.is_some());
            }
            let margin = bytes.map_or(0.0, |bytes| bytes.margin(&voxel, self.options.layout));
            let node = &fragments[range.clone()];
            let Some(split) = scratch.best_split(node, &voxel, self.options, margin)? else {
                emit_leaf(&mut plan, &fragments[range], hoisted)?;
                done += weight;
                if done > 1e-3 {
                    self.progress.advance(done);
                    done = 0.0;
                }
                continue;
            };
            let exact = self.options.clipping.is_exact_for(range.len() as u32);
            let (start, end) = (range.start, range.end);
            stretch(&mut fragments, end + range.len())?;
            let (here, behind) = fragments.split_at_mut(end);
            let (lefts, rights) = Partition { split, voxel, mesh: self.mesh, exact }.run(
                &mut here[start..],
                behind,
                &mut scratch.straddlers,
            )?;
            if let Some(triangle) = hoisted {
                push(&mut plan.hoisted, (at as u32, triangle))?;
            }
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
        self.progress.advance(done);
        plan.nodes.shrink_to_fit();
        plan.references.shrink_to_fit();
        plan.counts.shrink_to_fit();
        Ok(plan)
    }
}

/// Appends a leaf of a node's triangles, and of the one that was to be hoisted: where nothing is left to split, it comes
/// back.
fn emit_leaf(plan: &mut Plan, fragments: &[Fragment], hoisted: Option<u32>) -> Result<(), BuildError> {
    let first = plan.references.len();
    room(&mut plan.references, fragments.len() + 1)?;
    plan.references.extend(fragments.iter().map(Fragment::triangle));
    plan.references.extend(hoisted);
    plan.references[first..].sort_unstable();
    let leaf = PlanNode::Leaf { first: first as u32, count: (plan.references.len() - first) as u32 };
    push(&mut plan.nodes, leaf)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_subtree_of_any_size_is_cancelled() {
        let mesh =
            TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
        let (ids, bounds) = mesh.valid_triangles();
        let (options, progress) = (BuildOptions::default(), Progress::new());
        let builder = Builder::new(&mesh, &options, &progress).unwrap();
        assert!(builder.rebuild(&ids, bounds).is_ok());
        progress.cancel();
        assert!(matches!(builder.rebuild(&ids, bounds), Err(BuildError::Cancelled)));
    }
}
