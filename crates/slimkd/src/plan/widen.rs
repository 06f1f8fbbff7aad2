//! Which subtrees of a binary tree of boxes become children of wide nodes, and which become leaves: the cheapest choice.
//!
//! Source: Ylitie, Karras & Laine 2017, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs*, §3.2.
//!
//! Deviations
//! 1. A cost counts rays and bytes: `J = SAH cost + λ · bytes`, as everywhere in this crate (`plan/collapse.rs`).
//! 2. Leaves hold up to [`MOST`] triangles and are tested four at a time, so their cost counts quads.
//! 3. Parts of the tree are gone through by all threads, and its top by one behind them: the choices of a node follow from what is below it.
//!
//! `C(n, i)` is the least cost of the subtree `n` as at most `i` children of one wide node:
//!
//! ```text
//! D(n, i) = min over k of C(left, k) + C(right, i − k)                         i ≥ 2
//! C(n, 1) = min(leaf(n), area(n) · NODE + λ · bytes of a node + D(n, WIDTH))
//! C(n, i) = min(C(n, 1), D(n, i))
//! ```

#[cfg(test)]
mod tests;

use super::{BoxForest, BoxNode, BoxPlan};
use crate::job::Job;
use crate::job::memory::{filled, push, with_room};
use crate::options::BuildError;
use crate::threads;

/// Children of a wide node.
pub(crate) const WIDTH: usize = 16;
/// The most triangles of a leaf.
pub(crate) const MOST: usize = 32;

/// Costs for rays, in units of a node's.
const NODE: f32 = 1.0;
const LEAF: f32 = 0.3;
const QUAD: f32 = 0.7;

/// What becomes of a subtree: numbers of 4 bits. That at `i` says, of at most `i + 1` children, how many its left half becomes; 0 where it
/// is one child. The first is of [`WIDTH`] children that must be two at least, the ones of its own wide node; 0 where it is a leaf.
#[derive(Clone, Copy, Debug, Default)]
struct Choice(u64);

const _: () = assert!(WIDTH == 16, "numbers of children below 16, and 16 of them, fill 64 bits");

impl Choice {
    fn new(left: &[u32; WIDTH]) -> Self {
        Self((0..WIDTH).fold(0, |bits, i| bits | u64::from(left[i]) << (4 * i)))
    }

    /// Of at most `most` children, 2 or more, how many the left half becomes.
    fn left(self, most: usize) -> usize {
        (self.0 >> (4 * (most - 1)) & 15) as usize
    }

    /// How many of the children of its own wide node are its left half's.
    fn own(self) -> usize {
        (self.0 & 15) as usize
    }
}

/// A binary tree, and what becomes of each of its nodes.
pub(crate) struct Widened<'a> {
    forest: &'a BoxForest,
    top: Vec<Choice>,
    parts: Vec<Vec<Choice>>,
    /// J of the whole tree.
    cost: f64,
    job: &'a Job<'a>,
}

/// The choices leave the account of memory.
impl Drop for Widened<'_> {
    fn drop(&mut self) {
        self.job.memory.give(choice_bytes(self.forest));
    }
}

fn choice_bytes(forest: &BoxForest) -> usize {
    (forest.top.len() + forest.nodes()) * size_of::<Choice>()
}

/// A child of a wide node: where it stands in the binary tree, and whether it is a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Child {
    place: Place,
    pub(crate) is_leaf: bool,
}

impl Child {
    /// Whether all below it was built as one part.
    pub(crate) fn is_in_part(&self) -> bool {
        self.place.part != TOP
    }
}

/// Where a node stands: in a part, or in the top.
#[derive(Clone, Copy, Debug)]
struct Place {
    part: u32,
    at: u32,
}

const TOP: u32 = u32::MAX;

/// What costs how much.
struct Prices<'a, L> {
    /// Areas are counted in the root's, so that no sum of them overflows.
    per_area: f64,
    lambda: f32,
    /// λ times what a wide node takes.
    node: f32,
    /// Bytes of a leaf of ascending ids.
    leaf_bytes: &'a L,
}

/// Chooses; `lambda` is the price of a byte in units of the root's area, `node_bytes` what a wide node takes, and `leaf_bytes` what a leaf of ids
/// takes, which are ascending.
pub(crate) fn widen<'a, L: Fn(&[u32]) -> u64 + Sync>(
    forest: &'a BoxForest,
    lambda: f64,
    node_bytes: usize,
    leaf_bytes: &L,
    job: &'a Job<'a>,
) -> Result<Widened<'a>, BuildError> {
    job.memory.take(choice_bytes(forest))?;
    // From here on, whatever ends this gives the memory back.
    let mut widened = Widened { forest, top: Vec::new(), parts: Vec::new(), cost: 0.0, job };
    let root_area = forest.bounds().surface_area();
    let prices = Prices {
        per_area: if root_area > 0.0 { 1.0 / root_area } else { 0.0 },
        lambda: lambda as f32,
        node: lambda as f32 * node_bytes as f32,
        leaf_bytes,
    };
    let parts = threads::map(&forest.parts, |part| prices.part(part, job))?;
    let mut costs = with_room(parts.len())?;
    widened.parts.reserve_exact(parts.len());
    for (choices, subtree) in parts {
        widened.parts.push(choices);
        costs.push(subtree);
    }
    widened.top = filled(Choice::default(), forest.top.len())?;
    let mut waiting: Vec<Subtree> = Vec::new();
    for (at, node) in forest.top.iter().enumerate().rev() {
        let subtree = match node.right() {
            None => costs.pop().expect("a leaf of the top is a part"),
            Some(_) => {
                let (left, right) = (waiting.pop(), waiting.pop());
                let (left, right) = left.zip(right).expect("a top is a binary tree");
                let (divided, from) = Subtree::divided(&left, &right);
                let one = prices.node_of(node, &divided);
                divided.closed(one, false, from, &mut widened.top[at])
            }
        };
        waiting.push(subtree);
    }
    widened.cost = waiting.pop().map_or(0.0, |root| root.costs[0].into());
    Ok(widened)
}

/// What a node above must know of a subtree.
struct Subtree {
    /// `C` of 1 to [`WIDTH`] children.
    costs: [f32; WIDTH],
    /// Its leaves in the binary tree; [`WIDTH`] for more. More children than that it cannot become.
    leaves: usize,
    references: usize,
    /// Its distinct ids, where it refers to [`MOST`] triangles at most; else 0.
    distinct: usize,
}

impl Subtree {
    /// `D` as the costs, and where each is least.
    fn divided(left: &Self, right: &Self) -> (Self, [u32; WIDTH]) {
        let mut least = [f32::INFINITY; WIDTH];
        let mut from = [1u32; WIDTH];
        // Nothing is no child, so it costs infinitely much. `padded[k + i]` is of `i − k` children of the right half, counted from 1.
        let mut padded = [f32::INFINITY; 2 * WIDTH];
        padded[WIDTH..].copy_from_slice(&right.costs);
        // `least[i]` is of `i + 1` children, and `left.costs[k]` of `k + 1`. A half of few leaves gains nothing from further children.
        for k in 0..left.leaves.min(WIDTH - 1) {
            let one = left.costs[k];
            let others: &[f32; WIDTH] = padded[WIDTH - 1 - k..][..WIDTH].try_into().expect("that many");
            for i in 0..WIDTH {
                let cost = one + others[i];
                let better = cost < least[i];
                least[i] = if better { cost } else { least[i] };
                from[i] = if better { k as u32 + 1 } else { from[i] };
            }
        }
        let leaves = (left.leaves + right.leaves).min(WIDTH);
        let divided =
            Self { costs: least, leaves, references: left.references + right.references, distinct: 0 };
        (divided, from)
    }

    /// `C` and the choice, where one child costs `one`, as a leaf or as a wide node.
    fn closed(mut self, one: f32, is_leaf: bool, mut from: [u32; WIDTH], choice: &mut Choice) -> Self {
        let own = if is_leaf { 0 } else { from[WIDTH - 1] };
        for i in 0..WIDTH {
            let better = one <= self.costs[i];
            self.costs[i] = if better { one } else { self.costs[i] };
            from[i] = if better { 0 } else { from[i] };
        }
        self.costs[0] = one;
        from[0] = own;
        *choice = Choice::new(&from);
        self
    }
}

impl<L: Fn(&[u32]) -> u64> Prices<'_, L> {
    fn area(&self, node: &BoxNode) -> f32 {
        (node.bounds.surface_area() * self.per_area) as f32
    }

    /// A wide node of its own.
    fn node_of(&self, node: &BoxNode, divided: &Subtree) -> f32 {
        self.area(node) * NODE + self.node + divided.costs[WIDTH - 1]
    }

    /// The choices of a part.
    fn part(&self, plan: &BoxPlan, job: &Job<'_>) -> Result<(Vec<Choice>, Subtree), BuildError> {
        let mut choices = filled(Choice::default(), plan.nodes.len())?;
        // Of each subtree that is not part of a larger one yet: what is known of it, and its distinct ids, ascending. The left half of the
        // next node is the last one.
        let mut waiting: Vec<Subtree> = Vec::new();
        let mut ids: Vec<u32> = Vec::new();
        let mut own = [0; MOST];
        for (at, node) in plan.nodes.iter().enumerate().rev() {
            job.check_at(at)?;
            let (divided, from) = match node.right() {
                None => {
                    let own = &plan.references[node.references()];
                    let whole = Subtree {
                        costs: [f32::INFINITY; WIDTH],
                        leaves: 1,
                        references: own.len(),
                        distinct: if own.len() <= MOST { own.len() } else { 0 },
                    };
                    if whole.distinct > 0 {
                        ids.extend_from_slice(own);
                        let first = ids.len() - own.len();
                        let distinct = sort_distinct(&mut ids[first..]);
                        ids.truncate(first + distinct);
                        (Subtree { distinct, ..whole }, [0; WIDTH])
                    } else {
                        (whole, [0; WIDTH])
                    }
                }
                Some(_) => {
                    let (left, right) = (waiting.pop(), waiting.pop());
                    let (left, right) = left.zip(right).expect("a plan is a binary tree");
                    let (mut divided, from) = Subtree::divided(&left, &right);
                    let middle = ids.len() - left.distinct;
                    let first = middle - right.distinct;
                    if divided.references <= MOST {
                        divided.distinct = merge(&ids[middle..], &ids[first..middle], &mut own);
                    }
                    ids.truncate(first);
                    ids.extend_from_slice(&own[..divided.distinct]);
                    (divided, from)
                }
            };
            let as_node = self.node_of(node, &divided);
            let mut as_leaf = f32::INFINITY;
            if divided.distinct > 0 {
                as_leaf = self.area(node) * (LEAF + QUAD * divided.distinct.div_ceil(4) as f32);
                // The ids are looked at only where the rays alone do not decide.
                if as_leaf <= as_node && self.lambda > 0.0 {
                    let bytes = (self.leaf_bytes)(&ids[ids.len() - divided.distinct..]);
                    as_leaf += self.lambda * bytes as f32;
                }
            }
            let is_leaf = as_leaf <= as_node;
            let one = if is_leaf { as_leaf } else { as_node };
            push(&mut waiting, divided.closed(one, is_leaf, from, &mut choices[at]))?;
        }
        let whole = waiting.pop().expect("a part is not empty");
        Ok((choices, whole))
    }
}

/// Union of two ascending lists of [`MOST`] ids at most in all; returns how many there are.
fn merge(a: &[u32], b: &[u32], out: &mut [u32; MOST]) -> usize {
    let (mut i, mut j, mut count) = (0, 0, 0);
    while i < a.len() && j < b.len() {
        let (x, y) = (a[i], b[j]);
        out[count] = x.min(y);
        (i, j, count) = (i + usize::from(x <= y), j + usize::from(y <= x), count + 1);
    }
    for &rest in a[i..].iter().chain(&b[j..]) {
        out[count] = rest;
        count += 1;
    }
    count
}

/// Sorts ids and drops what is there twice; returns how many are left in front.
fn sort_distinct(ids: &mut [u32]) -> usize {
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
    /// J of the whole tree.
    pub(crate) fn cost(&self) -> f64 {
        self.cost
    }

    /// The root as a child.
    pub(crate) fn root(&self) -> Option<Child> {
        (!self.forest.top.is_empty()).then(|| self.child(self.in_top(0)))
    }

    fn child(&self, place: Place) -> Child {
        Child { place, is_leaf: self.choice(place).own() == 0 }
    }

    /// A node of the top, or the root of the part that stands there.
    fn in_top(&self, at: usize) -> Place {
        let part = self.forest.top[at].references();
        if part.is_empty() {
            Place { part: TOP, at: at as u32 }
        } else {
            Place { part: part.start as u32, at: 0 }
        }
    }

    fn node(&self, Place { part, at }: Place) -> &BoxNode {
        let nodes = if part == TOP { &self.forest.top } else { &self.forest.parts[part as usize].nodes };
        &nodes[at as usize]
    }

    fn choice(&self, Place { part, at }: Place) -> Choice {
        let choices = if part == TOP { &self.top } else { &self.parts[part as usize] };
        choices[at as usize]
    }

    /// Both halves of an inner node.
    fn halves(&self, place: Place) -> [Place; 2] {
        let Place { part, at } = place;
        let right = self.node(place).right().expect("an inner node");
        if part == TOP {
            [self.in_top(at as usize + 1), self.in_top(right)]
        } else {
            [Place { part, at: at + 1 }, Place { part, at: right as u32 }]
        }
    }

    /// What a child refers to lies in this box.
    pub(crate) fn bounds(&self, child: Child) -> &crate::geometry::Aabb {
        &self.node(child.place).bounds
    }

    /// The children of a wide node, from left to right.
    pub(crate) fn children(&self, node: Child, out: &mut Vec<Child>) {
        out.clear();
        let left = self.choice(node.place).own();
        let [a, b] = self.halves(node.place);
        self.gather(a, left, out);
        self.gather(b, WIDTH - left, out);
    }

    /// As at most `most` children. Its depth is below [`WIDTH`].
    fn gather(&self, place: Place, most: usize, out: &mut Vec<Child>) {
        let left = if most == 1 { 0 } else { self.choice(place).left(most) };
        if left == 0 {
            return out.push(self.child(place));
        }
        let [a, b] = self.halves(place);
        self.gather(a, left, out);
        self.gather(b, most - left, out);
    }

    /// The distinct ids of a leaf, ascending.
    pub(crate) fn ids<'b>(&self, leaf: Child, ids: &'b mut [u32; MOST]) -> &'b [u32] {
        let BoxPlan { nodes, references } = &self.forest.parts[leaf.place.part as usize];
        // The leaf's first and last reference are those of its first and last leaves.
        let (mut first, mut last) = (leaf.place.at as usize, leaf.place.at as usize);
        while nodes[first].right().is_some() {
            first += 1;
        }
        while let Some(right) = nodes[last].right() {
            last = right;
        }
        let range = nodes[first].references().start..nodes[last].references().end;
        let count = range.len();
        ids[..count].copy_from_slice(&references[range]);
        let distinct = sort_distinct(&mut ids[..count]);
        &ids[..distinct]
    }
}
