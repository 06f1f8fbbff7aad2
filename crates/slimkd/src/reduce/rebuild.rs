//! The paper's construction: after each pick the subtree is built anew without the picked triangle.
//!
//! Source: Choi, Chang & Ihm 2013, "The New Kd-tree Construction Algorithm", read as: build the standard subtree; pick; if
//! none, keep the split and recurse into the existing children; if one, store it, build the subtree of the others, and
//! recurse into the new children. One pick a node.

use super::measures::Picker;
use crate::construct::Builder;
use crate::geometry::Aabb;
use crate::options::BuildError;
use crate::options::Hoisting;
use crate::plan::Work;
use crate::plan::{Plan, PlanNode};
use std::rc::Rc;

/// A subtree that is still to be searched.
struct Pending {
    work: Rc<Work>,
    at: usize,
    voxel: Aabb,
    /// The parent in the result, when this is its right child.
    parent: Option<usize>,
}

/// Hoists at most one triangle a node, top-down.
pub(crate) fn hoist(
    plan: Plan,
    voxel: Aabb,
    hoisting: &Hoisting,
    builder: &Builder<'_>,
    share: f64,
) -> Result<Plan, BuildError> {
    let job = builder.job;
    // The new tree has about as many nodes as the old one.
    let each = share / plan.nodes.len().max(1) as f64;
    let mut picker = Picker::new(hoisting, job.mesh.len())?;
    let mut out = Plan::default();
    let mut pending =
        vec![Pending { work: Rc::new(Work::new(plan, &voxel, job)?), at: 0, voxel, parent: None }];
    while let Some(Pending { mut work, mut at, voxel, parent }) = pending.pop() {
        job.check()?;
        job.progress.advance(each);
        let here = out.nodes.len();
        if let Some(PlanNode::Inner { right, .. }) = parent.map(|parent| &mut out.nodes[parent]) {
            *right = here as u32;
        }
        let is_inner = matches!(work.plan.nodes[at], PlanNode::Inner { .. });
        if let Some(picked) = is_inner.then(|| picker.pick(&work, at, job)).transpose()?.flatten() {
            let all = work.distinct(at);
            let rest: Vec<u32> = all.iter().copied().filter(|&id| id != picked).collect();
            let rebuilt = builder.rebuild(&rest, voxel)?;
            if let PlanNode::Leaf { .. } = rebuilt.nodes[0] {
                // Where only a leaf would remain, the node becomes a leaf of all its triangles, the picked one included.
                push_leaf(&mut out, &all);
                continue;
            }
            out.hoisted.push((here as u32, picked));
            (work, at) = (Rc::new(Work::new(rebuilt, &voxel, job)?), 0);
        }
        match work.plan.nodes[at] {
            PlanNode::Leaf { first, count } => push_leaf(&mut out, work.ids(first, count)),
            PlanNode::Inner { axis, split, right } => {
                out.nodes.push(PlanNode::Inner { axis, split, right: 0 });
                let (left_voxel, right_voxel) = voxel.split(axis.into(), split);
                let right = Pending {
                    work: Rc::clone(&work),
                    at: right as usize,
                    voxel: right_voxel,
                    parent: Some(here),
                };
                pending.push(right);
                pending.push(Pending { work, at: at + 1, voxel: left_voxel, parent: None });
            }
        }
    }
    Ok(out)
}

fn push_leaf(out: &mut Plan, ids: &[u32]) {
    let first = out.references.len() as u32;
    out.references.extend_from_slice(ids);
    out.nodes.push(PlanNode::Leaf { first, count: ids.len() as u32 });
}
