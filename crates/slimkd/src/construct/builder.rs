//! The steps from triangles to the plan of a whole tree, and what all threads of them share.

use super::Pace;
use super::grow::{Fragment, Limits, TRIANGLE_LIMIT, Task, Top, sequential_below};
use super::split::Scratch;
use crate::geometry::Aabb;
use crate::job::Job;
use crate::job::memory::with_room;
use crate::options::{BuildError, Countable};
use crate::plan::{Plan, PlanNode};
use crate::threads;
use std::sync::Mutex;

/// Fragments that one thread makes at a time: 1 MB, which fits a core's cache.
pub(super) const FRAGMENTS_A_PIECE: usize = 32_768;

/// Builds trees over parts of one mesh.
pub(crate) struct Builder<'a> {
    pub(crate) job: &'a Job<'a>,
    /// Bounds of all triangles that can be hit: the root's voxel.
    pub(super) bounds: Aabb,
    /// Bytes that the finished tree may take, if there is a limit.
    pub(super) budget: Option<u64>,
    scratch: Mutex<Vec<Box<Scratch>>>,
}

impl<'a> Builder<'a> {
    pub(crate) fn new(job: &'a Job<'a>, bounds: Aabb, budget: Option<u64>) -> Result<Self, BuildError> {
        let (needed, limit) = (job.mesh.len() as u64, TRIANGLE_LIMIT);
        if needed > limit {
            return Err(BuildError::TooLarge { what: Countable::Triangles, needed, limit });
        }
        Ok(Self { job, bounds, budget, scratch: Mutex::new(Vec::new()) })
    }

    /// The plan of the tree over `triangles`, which are the ids of all triangles that can be hit. Where
    /// `BuildOptions::collapses_while_building` holds, its subtrees are collapsed already.
    pub(crate) fn build(&self, triangles: &[u32], pace: &Pace) -> Result<Plan, BuildError> {
        // 1. Make one fragment a triangle. The ids stay with the caller until this returns, so they count as well.
        let Self { job, bounds, .. } = self;
        let ids = size_of_val(triangles);
        job.memory.take(ids + size_of::<Fragment>() * triangles.len())?;
        let pieces = self.fragments(triangles)?;

        // 2. Split large nodes on all threads. Nodes that one thread can take become numbered tasks.
        job.progress.begin(pace.top);
        let limits = Limits {
            sequential_below: sequential_below(job.options, triangles.len()),
            share: pace.top / (pace.levels * triangles.len() as f64).max(1.0),
        };
        let mut tasks = Vec::new();
        let top = self.fork(Task { pieces, voxel: *bounds }, 0, &limits)?.numbered(&mut tasks);

        // 3. Build the tasks, one thread each.
        job.progress.begin(pace.below);
        let (subtrees, price) = self.subtrees(tasks, &top, pace.below)?;

        // 4. Join the top and the subtrees to one plan.
        job.progress.begin(pace.join);
        self.scratch.lock().expect("no worker panics").clear();
        job.memory.give(ids);
        Ok(Plan { price, ..self.joined(&top, subtrees, pace.join)? })
    }

    /// The plan of the subtree over the parts of `triangles` that lie in `voxel`, built by this thread alone and not collapsed.
    pub(crate) fn rebuild(&self, triangles: &[u32], voxel: Aabb) -> Result<Plan, BuildError> {
        let exact = self.job.options.clipping.is_exact_for(triangles.len() as u32);
        let fragments =
            triangles.iter().map(|&id| Fragment::in_voxel(self.job.mesh, id, &voxel, exact)).collect();
        self.subtree(fragments, voxel, 0.0, None)
    }

    /// One fragment a triangle, in pieces.
    fn fragments(&self, triangles: &[u32]) -> Result<Vec<Vec<Fragment>>, BuildError> {
        threads::map(triangles.chunks(FRAGMENTS_A_PIECE), |ids| {
            self.job.check()?;
            let mut piece = with_room(ids.len())?;
            piece.extend(ids.iter().map(|&id| Fragment::whole(self.job.mesh, id)));
            Ok(piece)
        })
    }

    /// The top and all subtrees below it in one plan, in preorder; moves the progress by `share`.
    fn joined(&self, top: &Top, mut subtrees: Vec<Plan>, share: f64) -> Result<Plan, BuildError> {
        // The root was a task itself, so the one subtree is the whole tree.
        if let [only] = &mut subtrees[..] {
            return Ok(std::mem::take(only));
        }
        // Allocate the whole plan first; the account of memory holds it and the subtrees together until these are freed.
        let (inner, _) = top.sums();
        let total = |of: fn(&Plan) -> usize| subtrees.iter().map(of).sum::<usize>();
        let parts = total(Plan::bytes);
        self.job.memory.take(parts + inner * size_of::<PlanNode>())?;
        let mut plan = Plan {
            nodes: with_room(total(|plan| plan.nodes.len()) + inner)?,
            references: with_room(total(|plan| plan.references.len()))?,
            counts: with_room(total(|plan| plan.counts.len()) + inner)?,
            ..Plan::default()
        };
        let share = share / plan.nodes.capacity().max(1) as f64;
        self.append(top, &mut subtrees, &mut plan, share)?;
        self.job.memory.give(parts);
        Ok(plan)
    }

    /// Appends a part of the top, with the subtrees below it, to `plan`, which has room for them. A subtree is freed as soon as it is
    /// copied. Each node moves the progress by `share`. The recursion is as deep as the top, which has a bound (`grow/top.rs`).
    fn append(
        &self,
        top: &Top,
        subtrees: &mut [Plan],
        plan: &mut Plan,
        share: f64,
    ) -> Result<(), BuildError> {
        match top {
            Top::Subtree(number) => {
                self.job.check()?;
                let subtree = std::mem::take(&mut subtrees[*number]);
                plan.append(&subtree);
                self.job.progress.advance(share * subtree.nodes.len() as f64);
            }
            Top::Inner(node) => {
                // The place of the right child is known only once the left one is appended.
                let (at, axis, split) = (plan.nodes.len(), node.axis, node.split);
                plan.nodes.push(PlanNode::Inner { axis, split, right: 0 });
                plan.counts.extend(self.job.options.needs_counts().then_some(node.count));
                self.append(&node.left, subtrees, plan, share)?;
                plan.nodes[at] = PlanNode::Inner { axis, split, right: plan.nodes.len() as u32 };
                self.append(&node.right, subtrees, plan, share)?;
            }
        }
        Ok(())
    }

    /// Buffers for one thread, reused from earlier subtrees. The caller returns them by [`Builder::give_scratch`].
    pub(super) fn take_scratch(&self) -> Box<Scratch> {
        self.scratch.lock().expect("no worker panics").pop().unwrap_or_default()
    }

    pub(super) fn give_scratch(&self, scratch: Box<Scratch>) {
        self.scratch.lock().expect("no worker panics").push(scratch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::TriangleMesh;
    use crate::job::Progress;
    use crate::options::BuildOptions;

    #[test]
    fn a_subtree_of_any_size_is_cancelled() {
        let mesh =
            TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
        let (ids, bounds) = mesh.valid_triangles();
        let (options, progress) = (BuildOptions::default(), Progress::new());
        let job = Job::new(&mesh, &options, &progress);
        let builder = Builder::new(&job, bounds, None).unwrap();
        assert!(builder.rebuild(&ids, bounds).is_ok());
        progress.cancel();
        assert!(matches!(builder.rebuild(&ids, bounds), Err(BuildError::Cancelled)));
    }
}
