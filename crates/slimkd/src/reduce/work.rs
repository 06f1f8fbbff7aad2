//! A plan that can be cut: nodes in preorder with the end of each subtree, so that a subtree is a range.

use crate::build::{Plan, PlanNode};
use crate::geometry::Aabb;

/// A plan under reduction. Nodes and references that were cut off stay in the arrays until [`Work::into_plan`].
pub(crate) struct Work {
    pub(crate) plan: Plan,
    /// Index behind each node's subtree.
    pub(crate) ends: Vec<u32>,
    /// Surface area of each node's voxel relative to the root's.
    pub(crate) areas: Vec<f32>,
}

impl Work {
    pub(crate) fn new(plan: Plan, root: &Aabb) -> Self {
        let nodes = &plan.nodes;
        let mut ends = vec![0u32; nodes.len()];
        for at in (0..nodes.len()).rev() {
            ends[at] = match nodes[at] {
                PlanNode::Inner { right, .. } => ends[right as usize],
                PlanNode::Leaf { .. } => at as u32 + 1,
            };
        }
        let area = root.surface_area();
        let scale = if area > 0.0 { 1.0 / area } else { 0.0 };
        let mut areas = vec![0.0; nodes.len()];
        let mut voxels = vec![*root];
        for (node, out) in nodes.iter().zip(&mut areas) {
            let voxel = voxels.pop().expect("a plan is a binary tree");
            *out = (voxel.surface_area() * scale) as f32;
            if let PlanNode::Inner { axis, split, .. } = *node {
                let (left, right) = voxel.split(axis.into(), split);
                voxels.extend([right, left]);
            }
        }
        Self { plan, ends, areas }
    }

    /// The ids of a leaf.
    pub(crate) fn ids(&self, first: u32, count: u32) -> &[u32] {
        &self.plan.references[first as usize..(first + count) as usize]
    }

    /// Leaves under `at` as (node, first, count), in order; what was cut off is passed over.
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

    /// Distinct triangles in the leaves under `at`, ascending.
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
    pub(crate) fn make_leaf(&mut self, at: usize, ids: &[u32]) {
        let first = self.plan.references.len() as u32;
        self.plan.references.extend_from_slice(ids);
        self.plan.nodes[at] = PlanNode::Leaf { first, count: ids.len() as u32 };
    }

    /// Drops what was cut off. T-references of nodes that are leaves now must not exist.
    pub(crate) fn into_plan(self) -> Plan {
        let Self { plan, ends, .. } = self;
        let mut out = Plan::default();
        let mut hoisted = plan.hoisted.iter().peekable();
        // Parents whose right child is still to come, innermost last.
        let mut open: Vec<(usize, u32)> = Vec::new();
        let mut at = 0;
        while at < plan.nodes.len() {
            let here = out.nodes.len() as u32;
            while let Some(&(parent, right)) = open.last() {
                if right as usize != at {
                    break;
                }
                if let PlanNode::Inner { right, .. } = &mut out.nodes[parent] {
                    *right = here;
                }
                open.pop();
            }
            while hoisted.next_if(|&&(node, _)| (node as usize) < at).is_some() {}
            while let Some(&(_, triangle)) = hoisted.next_if(|&&(node, _)| node as usize == at) {
                out.hoisted.push((here, triangle));
            }
            match plan.nodes[at] {
                PlanNode::Inner { axis, split, right } => {
                    open.push((here as usize, right));
                    out.nodes.push(PlanNode::Inner { axis, split, right });
                    at += 1;
                }
                PlanNode::Leaf { first, count } => {
                    let moved = out.references.len() as u32;
                    let ids = &plan.references[first as usize..(first + count) as usize];
                    out.references.extend_from_slice(ids);
                    out.nodes.push(PlanNode::Leaf { first: moved, count });
                    at = ends[at] as usize;
                }
            }
        }
        out
    }
}
