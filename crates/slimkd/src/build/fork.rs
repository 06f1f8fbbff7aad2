//! The top of the tree: nodes too large for one thread, in pieces.
//!
//! A node is a rope of pieces that are counted, searched and split by all threads; both children are built at the same
//! time. Everything follows from the set of a node's fragments, so neither pieces nor threads leave a trace in the tree.

use super::fragment::Fragment;
use super::memory::{copied, stretch, with_room};
use super::pace::Pace;
use super::partition::Partition;
use super::plan::{Plan, PlanNode};
use super::recursion::Builder;
use super::search::Scratch;
use super::{BuildError, BuildOptions};
use crate::geometry::Aabb;
use rayon::prelude::*;

/// Below this many triangles a node is built by one thread: splitting finer costs more than it gains, on large scenes.
const SEQUENTIAL_BELOW: usize = 4096;
/// Where a sample of the subtrees is built first, smaller scenes are cut into about so many, so that it is a small part of them.
const SUBTREES: usize = 512;
/// But scenes below so many triangles are not: all their subtrees are built first.
const LEAST_SAMPLED: usize = 1 << 15;
/// And no subtree is cut below so many triangles.
const LEAST_SUBTREE: usize = 256;
/// Fork and join at most this deep, so that a scene that cuts off triangles one by one cannot use up the stack.
const PARALLEL_DEPTH: u32 = 24;
/// Fragments in a piece: 1 MB, which fits a core's cache.
const PIECE: usize = 32_768;

/// A node still to be built.
pub(super) struct Task {
    pieces: Vec<Vec<Fragment>>,
    pub(super) voxel: Aabb,
}

impl Task {
    pub(super) fn count(&self) -> usize {
        self.pieces.iter().map(Vec::len).sum()
    }

    /// Bytes that it holds.
    pub(super) fn bytes(&self) -> usize {
        self.pieces.iter().map(Vec::capacity).sum::<usize>() * size_of::<Fragment>()
    }

    pub(super) fn into_one(self) -> Result<Vec<Fragment>, BuildError> {
        let count = self.count();
        let mut pieces = self.pieces.into_iter();
        let mut all = pieces.next().unwrap_or_default();
        all.try_reserve_exact(count - all.len())
            .map_err(|_| BuildError::OutOfMemory { bytes: (count * size_of::<Fragment>()) as u64 })?;
        pieces.for_each(|piece| all.extend_from_slice(&piece));
        Ok(all)
    }
}

/// Subtrees of fewer triangles are built by one thread, in a scene of so many.
pub(super) fn sequential_below(options: &BuildOptions, triangles: usize) -> usize {
    if options.collapses_while_building() && triangles >= LEAST_SAMPLED {
        (triangles / SUBTREES).clamp(LEAST_SUBTREE, SEQUENTIAL_BELOW)
    } else {
        SEQUENTIAL_BELOW
    }
}

/// Where the top of the tree ends, and how it is paced.
struct Limits {
    sequential_below: usize,
    /// Share of the whole build that a triangle takes at one level.
    share: f64,
}

/// The top of the tree; what hangs below is built once the top stands.
pub(super) enum Top {
    /// Subtree number.
    Subtree(usize),
    Inner(Box<TopNode>),
}

pub(super) struct TopNode {
    axis: u8,
    split: f32,
    count: u32,
    /// Surface area of its voxel.
    area: f64,
    left: Top,
    right: Top,
}

/// What [`Builder::fork`] returns: the top with its tasks in place.
enum Forked {
    Task(Task),
    Inner { node: Box<TopNode>, left: Box<Forked>, right: Box<Forked> },
}

impl Forked {
    /// Numbers the tasks from left to right.
    fn numbered(self, tasks: &mut Vec<Task>) -> Top {
        match self {
            Self::Task(task) => {
                tasks.push(task);
                Top::Subtree(tasks.len() - 1)
            }
            Self::Inner { mut node, left, right } => {
                node.left = left.numbered(tasks);
                node.right = right.numbered(tasks);
                Top::Inner(node)
            }
        }
    }
}

impl Top {
    /// Number and summed surface area of the nodes above the subtrees.
    pub(super) fn sums(&self) -> (usize, f64) {
        match self {
            Self::Subtree(_) => (0, 0.0),
            Self::Inner(node) => {
                let (left, right) = (node.left.sums(), node.right.sums());
                (left.0 + right.0 + 1, left.1 + right.1 + node.area)
            }
        }
    }
}

impl Builder<'_> {
    /// The tree over `triangles`, whose bounds are `voxel`. Collapsed already if
    /// [`BuildOptions::collapses_while_building`].
    ///
    /// [`BuildOptions::collapses_while_building`]: super::BuildOptions::collapses_while_building
    pub(crate) fn build(&self, triangles: &[u32], voxel: Aabb, pace: &Pace) -> Result<Plan, BuildError> {
        let ids = size_of_val(triangles);
        self.memory.take(ids + triangles.len() * size_of::<Fragment>())?;
        let pieces = triangles
            .par_chunks(PIECE)
            .map(|ids| {
                self.check()?;
                let mut piece = with_room(ids.len())?;
                piece.extend(ids.iter().map(|&id| Fragment::whole(self.mesh, id)));
                Ok(piece)
            })
            .collect::<Result<_, BuildError>>()?;
        let mut tasks = Vec::new();
        self.progress.begin(pace.top);
        let limits = Limits {
            sequential_below: sequential_below(self.options, triangles.len()),
            share: pace.top / (pace.levels * triangles.len() as f64).max(1.0),
        };
        let top = self.fork(Task { pieces, voxel }, 0, &limits)?.numbered(&mut tasks);
        self.progress.begin(pace.below);
        let (mut subtrees, collapsed) = self.subtrees(tasks, &top, voxel.surface_area(), pace.below)?;
        self.progress.begin(pace.join);
        self.drop_scratch();
        self.memory.give(ids);
        if subtrees.len() == 1 {
            return Ok(Plan { collapsed, ..std::mem::take(&mut subtrees[0]) });
        }
        let (inner, _) = top.sums();
        let total = |of: fn(&Plan) -> usize| subtrees.iter().map(of).sum::<usize>();
        let parts = total(Plan::bytes);
        self.memory.take(parts + inner * size_of::<PlanNode>())?;
        let mut plan = Plan {
            nodes: with_room(total(|plan| plan.nodes.len()) + inner)?,
            references: with_room(total(|plan| plan.references.len()))?,
            counts: with_room(total(|plan| plan.counts.len()) + inner)?,
            hoisted: with_room(total(|plan| plan.hoisted.len()))?,
            collapsed,
        };
        let share = pace.join / plan.nodes.capacity().max(1) as f64;
        self.append(&top, &mut subtrees, &mut plan, share)?;
        self.memory.give(parts);
        Ok(plan)
    }

    /// Appends a tree to `plan`, which has room; subtrees are freed as soon as they are copied.
    /// `share` is what a node moves the progress by.
    fn append(
        &self,
        top: &Top,
        subtrees: &mut [Plan],
        plan: &mut Plan,
        share: f64,
    ) -> Result<(), BuildError> {
        match top {
            Top::Subtree(number) => {
                self.check()?;
                let subtree = std::mem::take(&mut subtrees[*number]);
                plan.append(&subtree);
                self.progress.advance(share * subtree.nodes.len() as f64);
            }
            Top::Inner(node) => {
                let at = plan.nodes.len();
                plan.nodes.push(PlanNode::Inner { axis: node.axis, split: node.split, right: 0 });
                plan.counts.extend(self.options.needs_counts().then_some(node.count));
                self.append(&node.left, subtrees, plan, share)?;
                plan.nodes[at] =
                    PlanNode::Inner { axis: node.axis, split: node.split, right: plan.nodes.len() as u32 };
                self.append(&node.right, subtrees, plan, share)?;
            }
        }
        Ok(())
    }

    fn fork(&self, task: Task, depth: u32, limits: &Limits) -> Result<Forked, BuildError> {
        let count = task.count();
        let is_leaf = count <= self.options.leaf_at_most as usize;
        if count < limits.sequential_below || depth >= PARALLEL_DEPTH || is_leaf {
            return Ok(Forked::Task(task));
        }
        self.check()?;
        let mut scratch = self.take_scratch();
        let split = match &task.pieces[..] {
            [piece] => scratch.best_split(piece, &task.voxel, self.options, 0.0)?,
            pieces => scratch.best_split_parallel(pieces, count, &task.voxel, self.options, self.progress)?,
        };
        self.give_scratch(scratch);
        let Some(split) = split else { return Ok(Forked::Task(task)) };
        let Task { pieces, voxel } = task;
        let exact = self.options.clipping.is_exact_for(count as u32);
        let (left, right) = self.split_pieces(pieces, &Partition { split, voxel, mesh: self.mesh, exact })?;
        let (left_voxel, right_voxel) = voxel.split(split.axis, split.position);
        let left = Task { pieces: left, voxel: left_voxel };
        let right = Task { pieces: right, voxel: right_voxel };
        self.progress.advance(limits.share * count as f64);
        let (left, right) =
            rayon::join(|| self.fork(left, depth + 1, limits), || self.fork(right, depth + 1, limits));
        let node = TopNode {
            axis: split.axis as u8,
            split: split.position,
            count: count as u32,
            area: voxel.surface_area(),
            left: Top::Subtree(0),
            right: Top::Subtree(0),
        };
        Ok(Forked::Inner { node: Box::new(node), left: Box::new(left?), right: Box::new(right?) })
    }

    /// The pieces of both children.
    #[expect(clippy::type_complexity, reason = "two ropes")]
    fn split_pieces(
        &self,
        pieces: Vec<Vec<Fragment>>,
        partition: &Partition<'_>,
    ) -> Result<(Vec<Vec<Fragment>>, Vec<Vec<Fragment>>), BuildError> {
        let halves = pieces
            .into_par_iter()
            .map(|mut piece| {
                self.check()?;
                let mut scratch = self.take_scratch();
                let Scratch { left, straddlers, .. } = &mut *scratch;
                stretch(left, piece.len())?;
                let (lefts, rights) = partition.run(&mut piece, left, straddlers)?;
                self.memory.take(lefts * size_of::<Fragment>())?;
                let left = copied(&left[..lefts])?;
                self.give_scratch(scratch);
                self.memory.give((piece.capacity() - rights) * size_of::<Fragment>());
                piece.truncate(rights);
                piece.shrink_to_fit();
                Ok((left, piece))
            })
            .collect::<Result<Vec<_>, BuildError>>()?;
        let (left, right): (Vec<_>, Vec<_>) = halves.into_iter().unzip();
        Ok((joined(left)?, joined(right)?))
    }
}

/// The same rope with neighbours joined while they fit one piece.
fn joined(pieces: Vec<Vec<Fragment>>) -> Result<Vec<Vec<Fragment>>, BuildError> {
    let mut out: Vec<Vec<Fragment>> = Vec::with_capacity(pieces.len());
    for piece in pieces {
        match out.last_mut() {
            Some(last) if last.len() + piece.len() <= PIECE => {
                let bytes = ((last.len() + piece.len()) * size_of::<Fragment>()) as u64;
                last.try_reserve_exact(piece.len()).map_err(|_| BuildError::OutOfMemory { bytes })?;
                last.extend_from_slice(&piece);
            }
            _ => out.push(piece),
        }
    }
    Ok(out)
}
