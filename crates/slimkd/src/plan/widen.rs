//! Which subtrees of a binary tree of boxes become children of wide nodes, and which become leaves: the cheapest choice.
//!
//! Source: Ylitie, Karras & Laine 2017, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs*, §3.2.
//!
//! Deviations
//! 1. A cost counts rays and bytes: `J = SAH cost + λ · bytes`, as everywhere in this crate (`plan/collapse.rs`).
//! 2. Leaves hold up to [`MOST`] triangles and are tested four at a time, so their cost counts quads.
//!
//! `C(n, i)` is the least cost of the subtree `n` as at most `i` children of one wide node:
//!
//! ```text
//! D(n, i) = min over k of C(left, k) + C(right, i − k)                         i ≥ 2
//! C(n, 1) = min(leaf(n), area(n) · NODE + λ · bytes of a node + D(n, WIDTH))
//! C(n, i) = min(C(n, 1), D(n, i))
//! ```

use super::BoxPlan;
use crate::job::Job;
use crate::job::memory::{filled, push};
use crate::options::BuildError;

/// Children of a wide node.
pub(crate) const WIDTH: usize = 16;
/// The most triangles of a leaf.
pub(crate) const MOST: usize = 32;

/// Costs for rays, in units of a node's.
const NODE: f32 = 1.0;
const LEAF: f32 = 0.3;
const QUAD: f32 = 0.7;

/// What becomes of a subtree.
#[derive(Clone, Copy, Debug, Default)]
struct Choice {
    /// Whether it is a leaf where it is one child.
    leaf: bool,
    /// Of at most `i + 1` children, how many its left half becomes; 0 where it is one child. The first is of [`WIDTH`] children that must
    /// be two at least: the ones of its own wide node.
    left: [u8; WIDTH],
}

/// A binary tree, and what becomes of each of its nodes.
pub(crate) struct Widened<'a> {
    plan: &'a BoxPlan,
    choices: Vec<Choice>,
    /// J of the whole tree.
    cost: f64,
}

/// A child of a wide node: where it stands in the binary tree, and whether it is a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Child {
    pub(crate) at: usize,
    pub(crate) is_leaf: bool,
}

/// Chooses; `lambda` is the price of a byte in units of the root's area, `node_bytes` what a wide node takes, and `leaf_bytes` what a leaf of ids
/// takes, which are ascending.
pub(crate) fn widen<'a>(
    plan: &'a BoxPlan,
    lambda: f64,
    node_bytes: usize,
    leaf_bytes: impl Fn(&[u32]) -> u64,
    job: &Job<'_>,
) -> Result<Widened<'a>, BuildError> {
    job.memory.take(plan.nodes.len() * size_of::<Choice>())?;
    let mut choices = filled(Choice::default(), plan.nodes.len())?;
    job.memory.give(plan.nodes.len() * size_of::<Choice>());
    let lambda = lambda as f32;
    // Areas are counted in the root's, so that no sum of them overflows.
    let root_area = plan.nodes.first().map_or(0.0, |root| root.bounds.surface_area());
    let per_area = if root_area > 0.0 { 1.0 / root_area } else { 0.0 };
    // Of each subtree that is not part of a larger one yet: its costs, how many references it has, and where its references begin.
    let mut costs: Vec<([f32; WIDTH], u32, u32)> = Vec::new();
    let mut ids = [0; MOST];
    for (at, node) in plan.nodes.iter().enumerate().rev() {
        job.check_at(at)?;
        let area = (node.bounds.surface_area() * per_area) as f32;
        let choice = &mut choices[at];
        let (mut cost, count, first) = match node.right() {
            None => {
                let range = node.references();
                ([f32::INFINITY; WIDTH], range.len() as u32, range.start as u32)
            }
            Some(_) => {
                let (left, right) = (costs.pop(), costs.pop());
                let (left, right) = left.zip(right).expect("a plan is a binary tree");
                (divided(&left.0, &right.0, choice), left.1 + right.1, left.2)
            }
        };
        let as_node = area * NODE + lambda * node_bytes as f32 + cost[WIDTH - 1];
        let as_leaf = if count as usize <= MOST {
            let ids = &mut ids[..count as usize];
            ids.copy_from_slice(&plan.references[first as usize..(first + count) as usize]);
            let distinct = sort_distinct(ids);
            let quads = distinct.div_ceil(4) as f32;
            area * (LEAF + QUAD * quads) + lambda * leaf_bytes(&ids[..distinct]) as f32
        } else {
            f32::INFINITY
        };
        choice.leaf = count as usize <= MOST && as_leaf <= as_node;
        let one = if choice.leaf { as_leaf } else { as_node };
        cost[0] = one;
        for i in 1..WIDTH {
            if one <= cost[i] {
                cost[i] = one;
                if i < WIDTH - 1 {
                    choice.left[i] = 0;
                } else {
                    // The division of its own node stays known.
                    (choice.left[0], choice.left[i]) = (choice.left[i], 0);
                }
            } else if i == WIDTH - 1 {
                choice.left[0] = choice.left[i];
            }
        }
        push(&mut costs, (cost, count, first))?;
    }
    let cost = costs.last().map_or(0.0, |(cost, ..)| cost[0].into());
    Ok(Widened { plan, choices, cost })
}

/// `D`, and where its least is.
fn divided(left: &[f32; WIDTH], right: &[f32; WIDTH], choice: &mut Choice) -> [f32; WIDTH] {
    let mut least = [f32::INFINITY; WIDTH];
    let mut from = [1u32; WIDTH];
    // `least[i]` is of `i + 1` children, and `left[k]` of `k + 1`.
    for k in 0..WIDTH - 1 {
        let one = left[k];
        for i in k + 1..WIDTH {
            let cost = one + right[i - k - 1];
            let better = cost < least[i];
            least[i] = if better { cost } else { least[i] };
            from[i] = if better { k as u32 + 1 } else { from[i] };
        }
    }
    choice.left = from.map(|k| k as u8);
    least
}

/// Sorts ids and drops what is there twice; returns how many are left in front.
pub(crate) fn sort_distinct(ids: &mut [u32]) -> usize {
    ids.sort_unstable();
    let mut kept = 0;
    for at in 0..ids.len() {
        if kept == 0 || ids[at] != ids[kept - 1] {
            ids[kept] = ids[at];
            kept += 1;
        }
    }
    kept
}

impl Widened<'_> {
    pub(crate) fn plan(&self) -> &BoxPlan {
        self.plan
    }

    /// J of the whole tree.
    pub(crate) fn cost(&self) -> f64 {
        self.cost
    }

    /// The root as a child.
    pub(crate) fn root(&self) -> Option<Child> {
        (!self.plan.nodes.is_empty()).then(|| self.child(0))
    }

    fn child(&self, at: usize) -> Child {
        Child { at, is_leaf: self.choices[at].leaf }
    }

    /// The children of a wide node, from left to right.
    pub(crate) fn children(&self, node: Child, out: &mut Vec<Child>) {
        out.clear();
        let left = self.choices[node.at].left[0];
        self.gather(node.at + 1, left, out);
        self.gather(self.right(node.at), WIDTH as u8 - left, out);
    }

    /// As at most `most` children. Its depth is below [`WIDTH`].
    fn gather(&self, at: usize, most: u8, out: &mut Vec<Child>) {
        let left = self.choices[at].left[usize::from(most) - 1];
        if most == 1 || left == 0 {
            return out.push(self.child(at));
        }
        self.gather(at + 1, left, out);
        self.gather(self.right(at), most - left, out);
    }

    fn right(&self, at: usize) -> usize {
        self.plan.nodes[at].right().expect("an inner node")
    }

    /// The distinct ids of a leaf, ascending.
    pub(crate) fn ids<'b>(&self, leaf: Child, ids: &'b mut [u32; MOST]) -> &'b [u32] {
        // The leaf's first and last reference are those of its first and last leaves.
        let (mut first, mut last) = (leaf.at, leaf.at);
        while self.plan.nodes[first].right().is_some() {
            first += 1;
        }
        while let Some(right) = self.plan.nodes[last].right() {
            last = right;
        }
        let range = self.plan.nodes[first].references().start..self.plan.nodes[last].references().end;
        let count = range.len();
        ids[..count].copy_from_slice(&self.plan.references[range]);
        let distinct = sort_distinct(&mut ids[..count]);
        &ids[..distinct]
    }
}
