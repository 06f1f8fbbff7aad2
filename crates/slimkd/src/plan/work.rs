//! A plan whose subtrees can be replaced by leaves. Nodes lie in preorder, and the end of each subtree is known, so a subtree is a range.

use super::{Plan, PlanNode};
use crate::geometry::Aabb;
use crate::job::Job;
use crate::job::memory::{filled, room, with_room};
use crate::options::BuildError;

/// A plan under reduction. Nodes and references that were cut off stay in the arrays until [`Work::into_plan`].
pub(crate) struct Work {
    pub(crate) plan: Plan,
    /// For each node, the position behind the last node of its subtree.
    pub(crate) ends: Vec<u32>,
    /// Surface area of each node's voxel relative to the root's.
    pub(crate) areas: Vec<f32>,
}

impl Work {
    pub(crate) fn new(plan: Plan, root: &Aabb, job: &Job<'_>) -> Result<Self, BuildError> {
        Self::within(plan, root, root.surface_area(), job)
    }

    /// For the plan of a subtree: `root` is its voxel, and `area` the surface area of the whole tree's voxel.
    pub(crate) fn within(plan: Plan, root: &Aabb, area: f64, job: &Job<'_>) -> Result<Self, BuildError> {
        // 1. Ends, from the back: an inner node ends where its right child ends.
        let nodes = &plan.nodes;
        let mut ends = filled(0u32, nodes.len())?;
        for at in (0..nodes.len()).rev() {
            job.check_at(at)?;
            ends[at] = match nodes[at] {
                PlanNode::Inner { right, .. } => ends[right as usize],
                PlanNode::Leaf { .. } => at as u32 + 1,
            };
        }
        // 2. Areas, from the front: the voxels of nodes still to come wait on a stack, the next node's on top.
        let scale = if area > 0.0 { 1.0 / area } else { 0.0 };
        let mut areas = filled(0.0, nodes.len())?;
        let mut voxels = vec![*root];
        for (at, (node, out)) in nodes.iter().zip(&mut areas).enumerate() {
            job.check_at(at)?;
            let voxel = voxels.pop().expect("a plan is a binary tree");
            *out = (voxel.surface_area() * scale) as f32;
            if let PlanNode::Inner { axis, split, .. } = *node {
                let (left, right) = voxel.split(axis.into(), split);
                voxels.extend([right, left]);
            }
        }
        Ok(Self { plan, ends, areas })
    }

    /// The ids of a leaf.
    pub(crate) fn ids(&self, first: u32, count: u32) -> &[u32] {
        &self.plan.references[first as usize..(first + count) as usize]
    }

    /// The leaves under `at` as (node, first, count), in order. Nodes that were cut off, behind a leaf that replaced them, are skipped.
    pub(crate) fn leaves(&self, at: usize) -> impl Iterator<Item = (usize, u32, u32)> + '_ {
        let end = self.ends[at] as usize;
        let mut next = at;
        std::iter::from_fn(move || {
            while next < end {
                let here = next;
                match self.plan.nodes[here] {
                    PlanNode::Inner { .. } => next += 1,
                    PlanNode::Leaf { first, count } => {
                        next = self.ends[here] as usize;
                        return Some((here, first, count));
                    }
                }
            }
            None
        })
    }

    /// The distinct triangles in the leaves under `at`, ascending. T-references are not among them.
    pub(crate) fn distinct(&self, at: usize) -> Vec<u32> {
        let mut ids = Vec::new();
        for (_, first, count) in self.leaves(at) {
            ids.extend_from_slice(self.ids(first, count));
        }
        ids.sort_unstable();
        ids.dedup();
        ids
    }

    /// Turns the subtree at `at` into a leaf of `ids`, ascending.
    pub(crate) fn make_leaf(&mut self, at: usize, ids: &[u32]) -> Result<(), BuildError> {
        let first = self.plan.references.len() as u32;
        room(&mut self.plan.references, ids.len())?;
        self.plan.references.extend_from_slice(ids);
        self.plan.nodes[at] = PlanNode::Leaf { first, count: ids.len() as u32 };
        Ok(())
    }

    /// Drops the nodes and references that were cut off. No T-reference may belong to a node that is a leaf now.
    pub(crate) fn into_plan(self, job: &Job<'_>) -> Result<Plan, BuildError> {
        self.joined(Vec::new(), job)
    }

    /// Does what [`Work::into_plan`] does, and puts `parts` in place of the subtrees that were reduced on their own. The parts must be
    /// ascending by their roots.
    pub(crate) fn joined(self, parts: Vec<Part>, job: &Job<'_>) -> Result<Plan, BuildError> {
        // 1. Allocate for the references that stay. Nodes are compacted in place, as they only move forward.
        let Self { plan, ends, areas } = self;
        drop(areas);
        let Plan { mut nodes, references: old, hoisted: old_hoisted, price, .. } = plan;
        let in_parts = |of: fn(&Plan) -> usize| parts.iter().map(|part| of(&part.plan)).sum::<usize>();
        let kept = kept_references(&nodes, &ends, &parts) + in_parts(|plan| plan.references.len());
        let mut references = with_room(kept)?;
        let mut hoisted = with_room(old_hoisted.len() + in_parts(|plan| plan.hoisted.len()))?;
        let (mut parts, mut old_hoisted) = (parts.into_iter().peekable(), old_hoisted.iter().peekable());
        // Inner nodes whose right child is still to come, innermost last: the new place of the node, and the old place of that child.
        let mut open: Vec<(usize, u32)> = Vec::new();
        // The old and the new place of the next node.
        let (mut at, mut here) = (0, 0);
        while at < nodes.len() {
            job.check_at(here)?;
            // 2. Tell the nodes whose right child this is where it is now.
            while let Some((parent, _)) = open.pop_if(|&mut (_, right)| right as usize == at) {
                if let PlanNode::Inner { right, .. } = &mut nodes[parent] {
                    *right = here as u32;
                }
            }
            // 3. Move the node's T-references; those of nodes that were cut off are dropped.
            while let Some(&(node, triangle)) = old_hoisted.next_if(|&&(node, _)| node as usize <= at) {
                if node as usize == at {
                    hoisted.push((here as u32, triangle));
                }
            }
            // 4. Copy a part as a whole, where one begins here.
            let moved = references.len() as u32;
            if let Some(Part { root, count, plan }) = parts.next_if(|part| part.root == at) {
                for i in 0..count {
                    nodes[here + i] = nodes[root + i].shifted(here as u32, moved);
                }
                references.extend_from_slice(&plan.references);
                hoisted.extend(plan.hoisted.iter().map(|&(node, triangle)| (node + here as u32, triangle)));
                (at, here) = (ends[at] as usize, here + count);
                continue;
            }
            // 5. Or move a single node; behind a leaf, what it replaced is skipped.
            let node = nodes[at];
            match node {
                PlanNode::Inner { right, .. } => {
                    open.push((here, right));
                    nodes[here] = node;
                    at += 1;
                }
                PlanNode::Leaf { first, count } => {
                    references.extend_from_slice(&old[first as usize..(first + count) as usize]);
                    nodes[here] = PlanNode::Leaf { first: moved, count };
                    at = ends[at] as usize;
                }
            }
            here += 1;
        }
        nodes.truncate(here);
        nodes.shrink_to_fit();
        Ok(Plan { nodes, references, counts: Vec::new(), hoisted, price })
    }
}

/// A subtree that was reduced on its own. Its `count` nodes already lie in the whole plan's array, from `root` on.
pub(crate) struct Part {
    pub(crate) root: usize,
    pub(crate) count: usize,
    /// The references and T-references that these nodes point to, counted from the part's own start. It holds no nodes.
    pub(crate) plan: Plan,
}

/// The number of references in leaves that were not cut off, without those of the parts.
fn kept_references(nodes: &[PlanNode], ends: &[u32], parts: &[Part]) -> usize {
    let (mut at, mut total) = (0, 0);
    let mut parts = parts.iter().peekable();
    while at < nodes.len() {
        let is_part = parts.next_if(|part| part.root == at).is_some();
        at = match nodes[at] {
            PlanNode::Inner { .. } if !is_part => at + 1,
            PlanNode::Leaf { count, .. } if !is_part => {
                total += count as usize;
                ends[at] as usize
            }
            _ => ends[at] as usize,
        };
    }
    total
}
