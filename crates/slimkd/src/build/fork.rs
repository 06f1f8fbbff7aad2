//! The top of the tree: nodes too large for one thread, in pieces.
//!
//! A node is a rope of pieces that are counted, searched and split by all threads; both children are built at the same
//! time. Everything follows from the set of a node's fragments, so neither pieces nor threads leave a trace in the tree.

use super::BuildError;
use super::fragment::Fragment;
use super::partition::Partition;
use super::plan::{Plan, PlanNode};
use super::recursion::{Builder, SORT_SHARE};
use super::search::Scratch;
use crate::geometry::Aabb;
use rayon::prelude::*;

/// Below this many triangles a node is built by one thread: splitting finer costs more than it gains.
const SEQUENTIAL_BELOW: usize = 8192;
/// Fork and join at most this deep, so that a scene that cuts off triangles one by one cannot use up the stack.
const PARALLEL_DEPTH: u32 = 24;
/// Fragments in a piece: 1 MB, which fits a core's cache.
const PIECE: usize = 32_768;

/// A node still to be built.
struct Task {
    pieces: Vec<Vec<Fragment>>,
    voxel: Aabb,
    /// Share of the whole build, for progress.
    weight: f64,
}

impl Task {
    fn count(&self) -> usize {
        self.pieces.iter().map(Vec::len).sum()
    }

    fn into_one(self) -> Vec<Fragment> {
        let count = self.count();
        let mut pieces = self.pieces.into_iter();
        let mut all = pieces.next().unwrap_or_default();
        all.reserve_exact(count - all.len());
        pieces.for_each(|piece| all.extend_from_slice(&piece));
        all
    }
}

/// A plan in pieces, so that joining subtrees copies nothing until the end.
enum Piece {
    Plan(Plan),
    Inner { axis: u8, split: f32, count: u32, left: Box<Piece>, right: Box<Piece> },
}

/// One plan of all pieces; each piece is freed as soon as it is copied.
fn flattened(piece: Piece) -> Plan {
    fn sizes(piece: &Piece) -> [usize; 3] {
        match piece {
            Piece::Plan(plan) => [plan.nodes.len(), plan.references.len(), plan.counts.len()],
            Piece::Inner { left, right, .. } => {
                let (left, right) = (sizes(left), sizes(right));
                std::array::from_fn(|i| left[i] + right[i] + usize::from(i != 1))
            }
        }
    }
    fn append(piece: Piece, plan: &mut Plan) {
        match piece {
            Piece::Plan(subtree) => plan.append(&subtree),
            Piece::Inner { axis, split, count, left, right } => {
                let at = plan.nodes.len();
                plan.nodes.push(PlanNode::Inner { axis, split, right: 0 });
                plan.counts.push(count);
                append(*left, plan);
                plan.nodes[at] = PlanNode::Inner { axis, split, right: plan.nodes.len() as u32 };
                append(*right, plan);
            }
        }
    }
    if let Piece::Plan(plan) = piece {
        return plan;
    }
    let [nodes, references, counts] = sizes(&piece);
    let mut plan = Plan {
        nodes: Vec::with_capacity(nodes),
        references: Vec::with_capacity(references),
        counts: Vec::with_capacity(counts),
        hoisted: Vec::new(),
    };
    append(piece, &mut plan);
    plan
}

impl Builder<'_> {
    /// The standard tree over `triangles`, whose bounds are `voxel`; moves the progress by `weight`.
    pub(crate) fn build(&self, triangles: &[u32], voxel: Aabb, weight: f64) -> Result<Plan, BuildError> {
        let pieces = triangles
            .par_chunks(PIECE)
            .map(|ids| {
                self.check()?;
                Ok(ids.iter().map(|&id| Fragment::whole(self.mesh, id)).collect())
            })
            .collect::<Result<_, BuildError>>()?;
        self.progress.advance(SORT_SHARE * weight);
        let piece = self.fork(Task { pieces, voxel, weight: (1.0 - SORT_SHARE) * weight }, 0)?;
        self.drop_scratch();
        Ok(flattened(piece))
    }

    fn fork(&self, task: Task, depth: u32) -> Result<Piece, BuildError> {
        let count = task.count();
        if count < SEQUENTIAL_BELOW || depth >= PARALLEL_DEPTH {
            let (voxel, weight) = (task.voxel, task.weight);
            return self.sequential(task.into_one(), voxel, weight).map(Piece::Plan);
        }
        self.check()?;
        let mut scratch = self.take_scratch();
        let split = scratch.best_split_parallel(&task.pieces, count, &task.voxel, self.options);
        self.give_scratch(scratch);
        let Some(split) = split else {
            let (voxel, weight) = (task.voxel, task.weight);
            return self.sequential(task.into_one(), voxel, weight).map(Piece::Plan);
        };
        let Task { pieces, voxel, weight } = task;
        let exact = self.options.clipping.is_exact_for(count as u32);
        let (left, right) = self.split_pieces(pieces, &Partition { split, voxel, mesh: self.mesh, exact })?;
        let (left_voxel, right_voxel) = voxel.split(split.axis, split.position);
        let mut left = Task { pieces: left, voxel: left_voxel, weight: 0.0 };
        let mut right = Task { pieces: right, voxel: right_voxel, weight: 0.0 };
        let (lefts, rights) = (left.count() as f64, right.count() as f64);
        left.weight = weight * lefts / (lefts + rights).max(1.0);
        right.weight = weight - left.weight;
        let (left, right) = rayon::join(|| self.fork(left, depth + 1), || self.fork(right, depth + 1));
        Ok(Piece::Inner {
            axis: split.axis as u8,
            split: split.position,
            count: count as u32,
            left: Box::new(left?),
            right: Box::new(right?),
        })
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
                if left.len() < piece.len() {
                    left.resize(piece.len(), Fragment::default());
                }
                let (lefts, rights) = partition.run(&mut piece, left, straddlers);
                let left = left[..lefts].to_vec();
                self.give_scratch(scratch);
                piece.truncate(rights);
                piece.shrink_to_fit();
                Ok((left, piece))
            })
            .collect::<Result<Vec<_>, BuildError>>()?;
        let (left, right): (Vec<_>, Vec<_>) = halves.into_iter().unzip();
        Ok((joined(left), joined(right)))
    }
}

/// The same rope with neighbours joined while they fit one piece.
fn joined(pieces: Vec<Vec<Fragment>>) -> Vec<Vec<Fragment>> {
    let mut out: Vec<Vec<Fragment>> = Vec::with_capacity(pieces.len());
    for piece in pieces {
        match out.last_mut() {
            Some(last) if last.len() + piece.len() <= PIECE => {
                last.reserve_exact(piece.len());
                last.extend_from_slice(&piece);
            }
            _ => out.push(piece),
        }
    }
    out
}
