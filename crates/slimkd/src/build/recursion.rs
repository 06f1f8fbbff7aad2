//! From sorted events to a finished plan: an explicit stack below, fork and join above.
//!
//! Source: Wald & Havran 2006, algorithm 1 with automatic termination (equation 6).
//!
//! Deviations
//! 1. A leaf also where at most [`BuildOptions::leaf_at_most`] triangles remain: calibrated on the slides' Kitchen row.
//! 2. No recursion on the machine's stack below the parallel top, since depth is bounded only by the scene.
//! 3. Every decision depends on the node's contents alone, so thread count and scheduling leave no trace in the tree.

use super::event::{Event, TRIANGLE_LIMIT, push_events};
use super::partition::{Scratch, bounds_in, classify, split_list, triangle_bounds};
use super::plan::{Plan, PlanNode};
use super::predict::Predictor;
use super::sah::VoxelSah;
use super::sweep::{Split, best_on_axis, cheapest};
use super::{BuildError, BuildOptions, Progress};
use crate::geometry::{Aabb, TriangleMesh};
use crate::reduce::HoistAlgorithm;
use rayon::prelude::*;
use std::sync::Mutex;

/// Below this many triangles a node is built by one thread: splitting finer costs more than it gains.
const SEQUENTIAL_BELOW: u32 = 8192;
/// Fork and join at most this deep, so that a scene that cuts off triangles one by one cannot use up the stack.
const PARALLEL_DEPTH: u32 = 24;
/// Share of the progress bar for making and sorting events: an estimate, it only paces the bar.
const SORT_SHARE: f64 = 0.1;

/// Builds standard trees over parts of one mesh; what all workers of a build share.
pub(crate) struct Builder<'a> {
    mesh: &'a TriangleMesh,
    options: &'a BuildOptions,
    progress: &'a Progress,
    scratch: Mutex<Vec<Scratch>>,
}

/// A node still to be built: its event lists, one an axis, and its triangle count.
struct Task {
    lists: [Vec<Event>; 3],
    voxel: Aabb,
    count: u32,
    /// Share of the whole build, for progress.
    weight: f64,
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
        Ok(Self { mesh, options, progress, scratch: Mutex::new(Vec::new()) })
    }

    /// An error once the build was cancelled.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        self.progress.check()
    }

    /// The standard tree over `triangles`, whose bounds are `voxel`; moves the progress by `weight`.
    pub(crate) fn build(&self, triangles: &[u32], voxel: Aabb, weight: f64) -> Result<Plan, BuildError> {
        let list = |axis: usize| {
            let mut list = Vec::with_capacity(2 * triangles.len());
            for &id in triangles {
                push_events(&mut list, &triangle_bounds(self.mesh, id), axis, id);
            }
            list.par_sort_unstable();
            list
        };
        let (x, (y, z)) = rayon::join(|| list(0), || rayon::join(|| list(1), || list(2)));
        self.progress.advance(SORT_SHARE * weight);
        let weight = (1.0 - SORT_SHARE) * weight;
        let piece = self.fork(Task { lists: [x, y, z], voxel, count: triangles.len() as u32, weight }, 0)?;
        self.scratch.lock().expect("no worker panics").clear();
        Ok(flattened(piece))
    }

    /// The standard tree over what `voxel` holds of `triangles`, on this thread alone.
    pub(crate) fn rebuild(&self, triangles: &[u32], voxel: Aabb) -> Result<Plan, BuildError> {
        let exact = self.options.clipping.is_exact_for(triangles.len() as u32);
        let mut lists: [Vec<Event>; 3] = Default::default();
        for &id in triangles {
            let bounds = bounds_in(self.mesh, id, &voxel, exact);
            for (axis, list) in lists.iter_mut().enumerate() {
                push_events(list, &bounds, axis, id);
            }
        }
        lists.iter_mut().for_each(|list| list.sort_unstable());
        self.sequential(Task { lists, voxel, count: triangles.len() as u32, weight: 0.0 })
    }

    fn fork(&self, mut task: Task, depth: u32) -> Result<Piece, BuildError> {
        if task.count < SEQUENTIAL_BELOW || depth >= PARALLEL_DEPTH {
            return self.sequential(task).map(Piece::Plan);
        }
        self.progress.check()?;
        let Some(split) =
            self.best_split(&task.lists.each_ref().map(|list| &list[..]), &task.voxel, task.count, true)
        else {
            return self.sequential(task).map(Piece::Plan);
        };
        let mut scratch = self.take_scratch();
        let counts = classify(
            &task.lists[split.axis],
            &split,
            &task.voxel,
            self.mesh,
            self.options.clipping,
            &mut scratch,
        );
        let mut left_lists: [Vec<Event>; 3] = Default::default();
        for axis in 0..3 {
            let list = &mut task.lists[axis];
            let right_end = split_list(list, 0, axis, &mut scratch);
            left_lists[axis] = list[right_end..].to_vec();
            list.truncate(right_end);
            list.shrink_to_fit();
        }
        self.scratch.lock().expect("no worker panics").push(scratch);
        let (left_voxel, right_voxel) = task.voxel.split(split.axis, split.position);
        let left_weight =
            task.weight * f64::from(counts.left) / f64::from((counts.left + counts.right).max(1));
        let left = Task { lists: left_lists, voxel: left_voxel, count: counts.left, weight: left_weight };
        let right = Task {
            lists: task.lists,
            voxel: right_voxel,
            count: counts.right,
            weight: task.weight - left_weight,
        };
        let (left, right) = rayon::join(|| self.fork(left, depth + 1), || self.fork(right, depth + 1));
        Ok(Piece::Inner {
            axis: split.axis as u8,
            split: split.position,
            count: task.count,
            left: Box::new(left?),
            right: Box::new(right?),
        })
    }

    fn take_scratch(&self) -> Scratch {
        let mut scratch = self.scratch.lock().expect("no worker panics").pop().unwrap_or_default();
        scratch.sides.resize(self.mesh.len(), 0);
        scratch
    }

    /// The split to make, or `None` for a leaf.
    fn best_split(&self, lists: &[&[Event]; 3], voxel: &Aabb, count: u32, parallel: bool) -> Option<Split> {
        if count <= self.options.leaf_at_most {
            return None;
        }
        let sah = VoxelSah::new(&self.options.sah, voxel);
        let on = |axis: usize| best_on_axis(lists[axis], axis, voxel, &sah, count);
        let candidates = if parallel {
            let (x, (y, z)) = rayon::join(|| on(0), || rayon::join(|| on(1), || on(2)));
            [x, y, z]
        } else {
            [on(0), on(1), on(2)]
        };
        cheapest(candidates).filter(|split| split.cost < sah.leaf(count as usize))
    }

    fn sequential(&self, task: Task) -> Result<Plan, BuildError> {
        let mut scratch = self.take_scratch();
        let result = self.build_stack(task, &mut scratch);
        self.scratch.lock().expect("no worker panics").push(scratch);
        result
    }

    /// Depth first, left before right. The lists of all pending nodes lie in one stack of events an axis; the node at
    /// hand is always the top one.
    fn build_stack(&self, task: Task, scratch: &mut Scratch) -> Result<Plan, BuildError> {
        struct Pending {
            start: [usize; 3],
            voxel: Aabb,
            count: u32,
            weight: f64,
            /// The parent, when this is its right child.
            parent: Option<usize>,
        }
        let Task { mut lists, voxel, count, weight } = task;
        let predicting = self.options.hoisting.as_ref().filter(|h| h.algorithm == HoistAlgorithm::Predict);
        let mut predictor = predicting.map(Predictor::new);
        let mut plan = Plan::default();
        let mut done = 0.0;
        let mut pending = vec![Pending { start: [0; 3], voxel, count, weight, parent: None }];
        while let Some(mut node) = pending.pop() {
            let at = plan.nodes.len();
            plan.counts.push(node.count);
            if let Some(PlanNode::Inner { right, .. }) = node.parent.map(|parent| &mut plan.nodes[parent]) {
                *right = at as u32;
            }
            let mut hoisted = None;
            if let Some(predictor) = &mut predictor
                && node.count > self.options.leaf_at_most
            {
                hoisted = predictor.pick(&lists_from(&lists, &node.start), node.count);
                for (list, &start) in lists.iter_mut().zip(&node.start).filter(|_| hoisted.is_some()) {
                    remove(list, start, hoisted);
                }
                node.count -= u32::from(hoisted.is_some());
            }
            let views = lists_from(&lists, &node.start);
            let Some(split) = self.best_split(&views, &node.voxel, node.count, false) else {
                emit_leaf(&mut plan, views[0], hoisted);
                for axis in 0..3 {
                    lists[axis].truncate(node.start[axis]);
                }
                done += node.weight;
                if done > 1e-3 {
                    self.progress.advance(done);
                    self.progress.check()?;
                    done = 0.0;
                }
                continue;
            };
            let counts =
                classify(views[split.axis], &split, &node.voxel, self.mesh, self.options.clipping, scratch);
            let mut left_start = node.start;
            for axis in 0..3 {
                left_start[axis] += split_list(&mut lists[axis], node.start[axis], axis, scratch);
            }
            plan.hoisted.extend(hoisted.map(|triangle| (at as u32, triangle)));
            plan.nodes.push(PlanNode::Inner { axis: split.axis as u8, split: split.position, right: 0 });
            let (left_voxel, right_voxel) = node.voxel.split(split.axis, split.position);
            let left_weight =
                node.weight * f64::from(counts.left) / f64::from((counts.left + counts.right).max(1));
            let right_weight = node.weight - left_weight;
            pending.push(Pending {
                start: node.start,
                voxel: right_voxel,
                count: counts.right,
                weight: right_weight,
                parent: Some(at),
            });
            pending.push(Pending {
                start: left_start,
                voxel: left_voxel,
                count: counts.left,
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

/// The tops of the event stacks.
fn lists_from<'a>(lists: &'a [Vec<Event>; 3], start: &[usize; 3]) -> [&'a [Event]; 3] {
    std::array::from_fn(|axis| &lists[axis][start[axis]..])
}

/// Takes one triangle's events out of `list[start..]`.
fn remove(list: &mut Vec<Event>, start: usize, triangle: Option<u32>) {
    let mut kept = start;
    for at in start..list.len() {
        list[kept] = list[at];
        kept += usize::from(Some(list[at].triangle()) != triangle);
    }
    list.truncate(kept);
}

/// Appends a leaf of the triangles in a node's list of any one axis, and of the one that was to be hoisted: where
/// nothing is left to split, it comes back.
fn emit_leaf(plan: &mut Plan, events: &[Event], hoisted: Option<u32>) {
    let first = plan.references.len();
    plan.references.extend(events.iter().filter(|event| event.opens()).map(|event| event.triangle()));
    plan.references.extend(hoisted);
    plan.references[first..].sort_unstable();
    plan.nodes.push(PlanNode::Leaf { first: first as u32, count: (plan.references.len() - first) as u32 });
}
