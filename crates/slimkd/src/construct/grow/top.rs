//! The top of the tree: nodes too large for one thread, in pieces.
//!
//! A node is a rope of pieces that are counted, searched and split by all threads; both children are built at the same
//! time. Everything follows from the set of a node's fragments, so neither pieces nor threads leave a trace in the tree.

use super::fragment::Fragment;
use super::partition::Partition;
use crate::construct::Builder;
use crate::construct::builder::CHUNK;
use crate::construct::split::Scratch;
use crate::geometry::Aabb;
use crate::job::memory::{copied, stretch};
use crate::options::{BuildError, BuildOptions};
use crate::threads;

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

/// A node still to be built.
pub(in crate::construct) struct Task {
    pub(in crate::construct) pieces: Vec<Vec<Fragment>>,
    pub(in crate::construct) voxel: Aabb,
}

impl Task {
    pub(in crate::construct) fn count(&self) -> usize {
        self.pieces.iter().map(Vec::len).sum()
    }

    /// Bytes that it holds.
    pub(in crate::construct) fn bytes(&self) -> usize {
        self.pieces.iter().map(Vec::capacity).sum::<usize>() * size_of::<Fragment>()
    }

    pub(in crate::construct) fn into_one(self) -> Result<Vec<Fragment>, BuildError> {
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
pub(in crate::construct) fn sequential_below(options: &BuildOptions, triangles: usize) -> usize {
    if options.collapses_while_building() && triangles >= LEAST_SAMPLED {
        (triangles / SUBTREES).clamp(LEAST_SUBTREE, SEQUENTIAL_BELOW)
    } else {
        SEQUENTIAL_BELOW
    }
}

/// Where the top of the tree ends, and how it is paced.
pub(in crate::construct) struct Limits {
    pub(in crate::construct) sequential_below: usize,
    /// Share of the whole build that a triangle takes at one level.
    pub(in crate::construct) share: f64,
}

/// The top of the tree; what hangs below is built once the top stands.
pub(in crate::construct) enum Top {
    /// Subtree number.
    Subtree(usize),
    Inner(Box<TopNode>),
}

pub(in crate::construct) struct TopNode {
    pub(in crate::construct) axis: u8,
    pub(in crate::construct) split: f32,
    pub(in crate::construct) count: u32,
    /// Surface area of its voxel.
    area: f64,
    pub(in crate::construct) left: Top,
    pub(in crate::construct) right: Top,
}

/// What [`Builder::fork`] returns: the top with its tasks in place.
pub(in crate::construct) enum Forked {
    Task(Task),
    Inner { node: Box<TopNode>, left: Box<Forked>, right: Box<Forked> },
}

impl Forked {
    /// Numbers the tasks from left to right.
    pub(in crate::construct) fn numbered(self, tasks: &mut Vec<Task>) -> Top {
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
    pub(in crate::construct) fn sums(&self) -> (usize, f64) {
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
    /// Splits a node and what is below it until the parts are small enough for one thread.
    pub(in crate::construct) fn fork(
        &self,
        task: Task,
        depth: u32,
        limits: &Limits,
    ) -> Result<Forked, BuildError> {
        let count = task.count();
        let is_leaf = count <= self.job.options.leaf_at_most as usize;
        if count < limits.sequential_below || depth >= PARALLEL_DEPTH || is_leaf {
            return Ok(Forked::Task(task));
        }
        self.job.check()?;
        let mut scratch = self.take_scratch();
        let split = match &task.pieces[..] {
            [piece] => scratch.best_split(piece, &task.voxel, self.job.options, 0.0)?,
            pieces => scratch.best_split_parallel(
                pieces,
                count,
                &task.voxel,
                self.job.options,
                self.job.progress,
            )?,
        };
        self.give_scratch(scratch);
        let Some(split) = split else { return Ok(Forked::Task(task)) };
        let Task { pieces, voxel } = task;
        let exact = self.job.options.clipping.is_exact_for(count as u32);
        let (left, right) =
            self.split_pieces(pieces, &Partition { split, voxel, mesh: self.job.mesh, exact })?;
        let (left_voxel, right_voxel) = voxel.split(split.axis, split.position);
        let left = Task { pieces: left, voxel: left_voxel };
        let right = Task { pieces: right, voxel: right_voxel };
        self.job.progress.advance(limits.share * count as f64);
        let (left, right) =
            threads::join(|| self.fork(left, depth + 1, limits), || self.fork(right, depth + 1, limits));
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
        let halves = threads::map(pieces, |mut piece| {
            self.job.check()?;
            let mut scratch = self.take_scratch();
            let Scratch { left, straddlers, .. } = &mut *scratch;
            stretch(left, piece.len())?;
            let (lefts, rights) = partition.run(&mut piece, left, straddlers)?;
            self.job.memory.take(lefts * size_of::<Fragment>())?;
            let left = copied(&left[..lefts])?;
            self.give_scratch(scratch);
            self.job.memory.give((piece.capacity() - rights) * size_of::<Fragment>());
            piece.truncate(rights);
            piece.shrink_to_fit();
            Ok((left, piece))
        })?;
        let (left, right): (Vec<_>, Vec<_>) = halves.into_iter().unzip();
        Ok((joined(left)?, joined(right)?))
    }
}

/// The same rope with neighbours joined while they fit one piece.
fn joined(pieces: Vec<Vec<Fragment>>) -> Result<Vec<Vec<Fragment>>, BuildError> {
    let mut out: Vec<Vec<Fragment>> = Vec::with_capacity(pieces.len());
    for piece in pieces {
        match out.last_mut() {
            Some(last) if last.len() + piece.len() <= CHUNK => {
                let bytes = ((last.len() + piece.len()) * size_of::<Fragment>()) as u64;
                last.try_reserve_exact(piece.len()).map_err(|_| BuildError::OutOfMemory { bytes })?;
                last.extend_from_slice(&piece);
            }
            _ => out.push(piece),
        }
    }
    Ok(out)
}
