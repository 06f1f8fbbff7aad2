//! Subtrees that do not pay for themselves become leaves.
//!
//! Source: Wald & Havran 2006 §3.2 name the greedy termination's weakness; Mitsuba's "retraction" (`gkdtree.h`) undoes splits
//! whose subtree turned out no cheaper than a leaf. Here it is decided bottom-up over the finished tree: a subtree
//! becomes one leaf of its distinct triangles, T-references included, when that is no dearer by SAH.

use super::work::Work;
use crate::build::{Plan, PlanNode, SahConstants};
use crate::geometry::Aabb;

/// Cost of a subtree relative to the root's area, and its distinct triangles unless they are too many to matter.
struct Summary {
    cost: f64,
    ids: Option<Vec<u32>>,
}

/// Collapses wherever that is no dearer.
pub(crate) fn collapse(plan: Plan, voxel: Aabb, sah: &SahConstants) -> Plan {
    let mut work = Work::new(plan, &voxel);
    let (traversal, intersection) = (f64::from(sah.traversal), f64::from(sah.intersection));
    let limits = distinct_limits(&work, traversal, intersection);
    // From the back: a node's right subtree lies on the stack below its left one.
    let mut summaries: Vec<Summary> = Vec::new();
    let mut hoisted = work.plan.hoisted.len();
    let mut kept = Vec::new();
    for at in (0..work.plan.nodes.len()).rev() {
        let area = f64::from(work.areas[at]);
        match work.plan.nodes[at] {
            PlanNode::Leaf { first, count } => {
                let cost = intersection * area * f64::from(count);
                let ids = (count <= limits[at]).then(|| work.ids(first, count).to_vec());
                summaries.push(Summary { cost, ids });
            }
            PlanNode::Inner { .. } => {
                let (left, right) = (summaries.pop(), summaries.pop());
                let (left, right) = left.zip(right).expect("a plan is a binary tree");
                let mut cost = traversal * area + left.cost + right.cost;
                let mut ids = left.ids.zip(right.ids).map(|(left, right)| merge(&left, &right));
                let above = hoisted;
                while hoisted > 0 && work.plan.hoisted[hoisted - 1].0 as usize == at {
                    hoisted -= 1;
                    cost += intersection * area;
                    ids = ids.map(|ids| merge(&ids, &[work.plan.hoisted[hoisted].1]));
                }
                ids = ids.filter(|ids| ids.len() <= limits[at] as usize);
                match &ids {
                    Some(distinct) if intersection * area * distinct.len() as f64 <= cost => {
                        cost = intersection * area * distinct.len() as f64;
                        // T-references below were the last to be kept: they are in the leaf now.
                        while kept.last().is_some_and(|&(node, _)| node < work.ends[at]) {
                            kept.pop();
                        }
                        work.make_leaf(at, distinct);
                    }
                    _ => kept.extend(work.plan.hoisted[hoisted..above].iter().rev().copied()),
                }
                summaries.push(Summary { cost, ids });
            }
        }
    }
    kept.reverse();
    work.plan.hoisted = kept;
    work.into_plan()
}

/// How many distinct triangles a subtree may hold so that it or any node above it may still collapse: a leaf in place
/// of node `a` costs `K_I · SA(a) · distinct`, and never more than `a` costs now.
fn distinct_limits(work: &Work, traversal: f64, intersection: f64) -> Vec<u32> {
    let nodes = &work.plan.nodes;
    let mut costs = vec![0.0f64; nodes.len()];
    let mut hoisted = work.plan.hoisted.len();
    for at in (0..nodes.len()).rev() {
        let area = f64::from(work.areas[at]);
        costs[at] = match nodes[at] {
            PlanNode::Leaf { count, .. } => intersection * area * f64::from(count),
            PlanNode::Inner { right, .. } => traversal * area + costs[at + 1] + costs[right as usize],
        };
        while hoisted > 0 && work.plan.hoisted[hoisted - 1].0 as usize == at {
            hoisted -= 1;
            costs[at] += intersection * area;
        }
    }
    let mut limits = vec![0u32; nodes.len()];
    for at in 0..nodes.len() {
        // Rounding of the areas to f32 must not rule out a collapse: one triangle of margin.
        let own = costs[at] / (intersection * f64::from(work.areas[at])) + 1.0;
        // A voxel without area limits nothing: NaN and infinity become "no limit".
        let own = if own < f64::from(u32::MAX) { own as u32 } else { u32::MAX };
        limits[at] = limits[at].max(own);
        if let PlanNode::Inner { right, .. } = nodes[at] {
            limits[at + 1] = limits[at];
            limits[right as usize] = limits[at];
        }
    }
    limits
}

/// Union of two ascending lists.
fn merge(a: &[u32], b: &[u32]) -> Vec<u32> {
    let mut out = Vec::with_capacity(a.len() + b.len());
    let (mut i, mut j) = (0, 0);
    while i < a.len() && j < b.len() {
        out.push(a[i].min(b[j]));
        let (x, y) = (a[i], b[j]);
        i += usize::from(x <= y);
        j += usize::from(y <= x);
    }
    out.extend_from_slice(&a[i..]);
    out.extend_from_slice(&b[j..]);
    out
}
