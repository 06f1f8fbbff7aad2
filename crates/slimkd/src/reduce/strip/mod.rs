//! T-references without rebuilding: one top-down pass over the finished tree.
//!
//! Source: Choi, Chang & Ihm 2013 build every subtree anew after a pick and name avoiding that as future work.
//!
//! Deviations
//! 1. The picked triangle is taken out of the leaves below, and the builder's leaf rule is applied again to
//!    the counts that remain. Splits stay where they are. `docs/paper-tree.md` holds the comparison.
//! 2. What is picked in a node depends on its subtree and on what was picked above. So the top is visited first, and then
//!    the subtrees below it, each by one thread: the result is that of one pass.

mod pass;

use super::measures::Picker;
use crate::geometry::Aabb;
use crate::job::Job;
use crate::job::memory::filled;
use crate::options::BuildError;
use crate::options::Hoisting;
use crate::plan::{Part, Work};
use crate::plan::{Plan, PlanNode};
use crate::threads;
use pass::Pass;
use std::sync::Mutex;

/// Subtrees of at most so many nodes are visited by one thread each: a thousand triangles or so.
const PART: usize = 4096;

/// Hoists at most one triangle a node, top-down.
pub(crate) fn hoist(
    mut plan: Plan,
    voxel: Aabb,
    hoisting: &Hoisting,
    job: &Job<'_>,
    share: f64,
) -> Result<Plan, BuildError> {
    let triangles = job.mesh.len();
    let each = share / plan.nodes.len().max(1) as f64;
    let counts = std::mem::take(&mut plan.counts);
    let most = most_leaves_of_one(&plan, triangles, job)?;
    let mut top = Pass::new(Work::new(plan, &voxel, job)?, counts, most, job)?;
    let mut picker = Picker::new(hoisting, triangles)?;
    // One thread has nothing to gain from parts, which cost it 1 to 4 % of a build.
    if top.work.plan.nodes.len() <= PART || threads::count() == 1 {
        top.run(hoisting, &mut picker, job, 0, each)?;
        return top.work.into_plan(job);
    }
    let roots = top.run(hoisting, &mut picker, job, PART, each)?;
    let mut nodes = std::mem::take(&mut top.work.plan.nodes);
    let pickers = Mutex::new(vec![picker]);
    let visit = |(root, nodes): (usize, &mut [PlanNode])| {
        let mut pass = top.part(root, nodes)?;
        let free = pickers.lock().expect("no worker panics").pop();
        let mut picker = match free {
            Some(picker) => picker,
            None => {
                job.memory.take(size_of::<u32>() * triangles)?;
                Picker::new(hoisting, triangles)?
            }
        };
        pass.run(hoisting, &mut picker, job, 0, each)?;
        pickers.lock().expect("no worker panics").push(picker);
        let mut plan = pass.work.into_plan(job)?;
        // In place: cutting leaves fewer nodes.
        nodes[..plan.nodes.len()].copy_from_slice(&plan.nodes);
        let count = plan.nodes.len();
        plan.nodes = Vec::new();
        job.memory.take(plan.bytes())?;
        Ok(Part { root, count, plan })
    };
    let parts = threads::map(disjoint(&mut nodes, &roots, &top.work.ends), visit)?;
    let beside: usize = parts.iter().map(|part| part.plan.bytes()).sum();
    let more = pickers.into_inner().expect("no worker panics").len() - 1;
    top.work.plan.nodes = nodes;
    let plan = top.work.joined(parts, job)?;
    job.memory.give(beside + more * size_of::<u32>() * triangles);
    Ok(plan)
}

/// The nodes of the subtrees at `roots`, ascending.
fn disjoint<'a>(
    mut nodes: &'a mut [PlanNode],
    roots: &[usize],
    ends: &[u32],
) -> Vec<(usize, &'a mut [PlanNode])> {
    let mut passed = 0;
    let mut slices = Vec::with_capacity(roots.len());
    for &root in roots {
        let end = ends[root] as usize;
        let (_, from_root) = nodes.split_at_mut(root - passed);
        let (own, behind) = from_root.split_at_mut(end - root);
        slices.push((root, own));
        (nodes, passed) = (behind, end);
    }
    slices
}

/// Per node, the most leaves of the whole tree that hold one and the same triangle of this subtree: an upper bound
/// that rules most large subtrees out.
fn most_leaves_of_one(plan: &Plan, triangles: usize, job: &Job<'_>) -> Result<Vec<u32>, BuildError> {
    let mut per_triangle = filled(0u32, triangles)?;
    for (at, &id) in plan.references.iter().enumerate() {
        job.check_at(at)?;
        per_triangle[id as usize] += 1;
    }
    let mut most = filled(0, plan.nodes.len())?;
    for at in (0..plan.nodes.len()).rev() {
        job.check_at(at)?;
        most[at] = match plan.nodes[at] {
            PlanNode::Inner { right, .. } => most[at + 1].max(most[right as usize]),
            PlanNode::Leaf { first, count } => {
                let ids = &plan.references[first as usize..(first + count) as usize];
                ids.iter().map(|&id| per_triangle[id as usize]).max().unwrap_or(0)
            }
        };
    }
    Ok(most)
}
