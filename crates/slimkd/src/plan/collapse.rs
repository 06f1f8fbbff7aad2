//! Collapsing: a subtree becomes a leaf where the leaf costs no more.
//!
//! Sources: Wald & Havran 2006 §3.2 describe the weakness of greedy termination; Mitsuba's "retraction" (`gkdtree.h`) undoes
//! splits whose subtree turned out no cheaper than a leaf.
//!
//! Deviations
//! 1. This is decided from the leaves up, over a finished tree or subtree: a subtree becomes one leaf of its distinct triangles,
//!    T-references included, when that costs no more.
//! 2. The cost of a subtree counts rays and bytes: `J = SAH cost + λ · bytes`, λ = [`BuildOptions::byte_weight`] · (SAH cost of the
//!    whole tree / its bytes). At weight 0 only rays count. At weight ℓ, a tree of half the bytes may cost ℓ/2 more.
//!
//! [`BuildOptions::byte_weight`]: crate::BuildOptions::byte_weight

use super::work::Work;
use super::{Plan, PlanNode, Price};
use crate::geometry::Aabb;
use crate::job::Job;
use crate::job::memory::{copied, filled, with_room};
use crate::options::{BuildError, Layout, SahConstants};

/// Bytes that a layout spends on a node and on a reference in a leaf.
#[derive(Clone, Copy)]
pub(crate) struct UnitBytes {
    pub(crate) node: f64,
    reference: f64,
}

impl UnitBytes {
    pub(crate) fn of(layout: Layout) -> Self {
        match layout {
            Layout::FourByte => Self { node: 8.0, reference: 4.0 },
            // Nearly all leaves of the scenes that fit use the 2-byte mode.
            Layout::TwoByte => Self { node: 8.0, reference: 2.0 },
            // An inner node takes 4 bytes and a leaf's head about 3; references took 0.5 to 1.5 bytes each on ten scenes.
            Layout::Dense | Layout::Wide => Self { node: 3.5, reference: 1.0 },
        }
    }
}

/// What a node costs. Its cost for rays is in proportion to its voxel's area relative to the root's (`area` below); its cost for
/// bytes is the same wherever it is.
#[derive(Clone, Copy)]
struct Prices {
    traversal: f64,
    intersection: f64,
    node: f64,
    reference: f64,
}

impl Prices {
    fn new(sah: &SahConstants, bytes: UnitBytes, lambda: f64) -> Self {
        Self {
            traversal: sah.traversal.into(),
            intersection: sah.intersection.into(),
            node: lambda * bytes.node,
            reference: lambda * bytes.reference,
        }
    }

    /// An inner node by itself, with its T-references. Each of these takes as many bytes as two references in leaves.
    fn inner(&self, area: f64, t_references: usize) -> f64 {
        let t_reference = self.intersection * area + 2.0 * self.reference;
        self.traversal * area + self.node + t_reference * t_references as f64
    }

    fn per_triangle(&self, area: f64) -> f64 {
        self.intersection * area + self.reference
    }

    fn leaf(&self, area: f64, count: usize) -> f64 {
        self.node + self.per_triangle(area) * count as f64
    }
}

/// What a node above must know of a subtree.
struct Summary {
    cost: f64,
    /// Its distinct triangles, ascending; `None` where they are too many for any node above to collapse.
    ids: Option<Vec<u32>>,
}

/// Collapses a whole tree wherever that costs no more; `byte_weight` is ℓ.
pub(crate) fn collapse(plan: Plan, voxel: Aabb, byte_weight: f32, job: &Job<'_>) -> Result<Plan, BuildError> {
    let work = Work::new(plan, &voxel, job)?;
    let cost_of_a_byte = match work.plan.price {
        None => {
            let whole = Totals::of(&work, job)?;
            whole.cost / whole.bytes
        }
        Some(price) => price.cost_of_a_byte,
    };
    collapse_work(work, f64::from(byte_weight) * cost_of_a_byte, job)
}

/// Collapses a subtree in `voxel`.
pub(crate) fn collapse_subtree(
    plan: Plan,
    voxel: &Aabb,
    price: Price,
    job: &Job<'_>,
) -> Result<Plan, BuildError> {
    collapse_work(Work::within(plan, voxel, price.root_area, job)?, price.lambda(), job)
}

/// The cost and the bytes of a tree or subtree.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Totals {
    /// SAH cost times the voxel's area relative to the root's.
    pub(crate) cost: f64,
    /// Bytes of nodes and references, estimated by [`UnitBytes`].
    pub(crate) bytes: f64,
}

impl Totals {
    fn of(work: &Work, job: &Job<'_>) -> Result<Self, BuildError> {
        let (plan, unit) = (&work.plan, UnitBytes::of(job.options.layout));
        let bytes = unit.node * (plan.nodes.len() + plan.hoisted.len()) as f64
            + unit.reference * plan.references.len() as f64;
        let rays_alone = Prices::new(&job.options.sah, unit, 0.0);
        Ok(Self { cost: subtree_costs(work, &rays_alone, job)?[0], bytes })
    }

    /// The totals of a subtree in `voxel`, of a tree whose root's voxel has the surface area `root_area`. Returns the plan as well.
    pub(crate) fn of_subtree(
        plan: Plan,
        voxel: &Aabb,
        root_area: f64,
        job: &Job<'_>,
    ) -> Result<(Self, Plan), BuildError> {
        let work = Work::within(plan, voxel, root_area, job)?;
        Ok((Self::of(&work, job)?, work.plan))
    }
}

/// Collapses from the leaves up wherever that costs no more; `lambda` is λ.
fn collapse_work(mut work: Work, lambda: f64, job: &Job<'_>) -> Result<Plan, BuildError> {
    let prices = Prices::new(&job.options.sah, UnitBytes::of(job.options.layout), lambda);
    let limits = distinct_limits(&work, &prices, job)?;

    // Nodes are taken in reverse preorder, so both children come before their parent. The left child comes last: its summary is on top
    // of the stack, and the right child's is below it. T-references are sorted by node and are taken from the back too.
    let mut summaries: Vec<Summary> = Vec::new();
    let mut hoisted = work.plan.hoisted.len();
    // T-references of nodes that stay inner nodes, in reverse order.
    let mut kept = Vec::new();
    for at in (0..work.plan.nodes.len()).rev() {
        job.check_at(at)?;
        let area = f64::from(work.areas[at]);
        match work.plan.nodes[at] {
            PlanNode::Leaf { first, count } => {
                let ids = (count <= limits[at]).then(|| copied(work.ids(first, count))).transpose()?;
                summaries.push(Summary { cost: prices.leaf(area, count as usize), ids });
            }
            PlanNode::Inner { .. } => {
                let (left, right) = (summaries.pop(), summaries.pop());
                let (left, right) = left.zip(right).expect("a plan is a binary tree");
                // 1. The distinct triangles below: both children's, and this node's T-references.
                let both = left.ids.zip(right.ids);
                let mut ids = both.map(|(left, right)| merge(&left, &right)).transpose()?;
                let above = hoisted;
                while hoisted > 0 && work.plan.hoisted[hoisted - 1].0 as usize == at {
                    hoisted -= 1;
                    ids = ids.map(|ids| merge(&ids, &[work.plan.hoisted[hoisted].1])).transpose()?;
                }
                // 2. What the subtree costs as it is, against one leaf of these triangles.
                let mut cost = prices.inner(area, above - hoisted) + left.cost + right.cost;
                ids = ids.filter(|ids| ids.len() <= limits[at] as usize);
                match &ids {
                    Some(distinct) if prices.leaf(area, distinct.len()) <= cost => {
                        cost = prices.leaf(area, distinct.len());
                        // T-references below this node were the last ones kept; they are part of the leaf now.
                        while kept.last().is_some_and(|&(node, _)| node < work.ends[at]) {
                            kept.pop();
                        }
                        work.make_leaf(at, distinct)?;
                    }
                    _ => kept.extend(work.plan.hoisted[hoisted..above].iter().rev().copied()),
                }
                summaries.push(Summary { cost, ids });
            }
        }
    }
    kept.reverse();
    work.plan.hoisted = kept;
    work.into_plan(job)
}

/// The cost of every node's subtree as it is, before any collapse.
fn subtree_costs(work: &Work, prices: &Prices, job: &Job<'_>) -> Result<Vec<f64>, BuildError> {
    let nodes = &work.plan.nodes;
    let mut costs = filled(0.0f64, nodes.len())?;
    let mut hoisted = work.plan.hoisted.len();
    for at in (0..nodes.len()).rev() {
        job.check_at(at)?;
        let area = f64::from(work.areas[at]);
        let above = hoisted;
        while hoisted > 0 && work.plan.hoisted[hoisted - 1].0 as usize == at {
            hoisted -= 1;
        }
        costs[at] = match nodes[at] {
            PlanNode::Leaf { count, .. } => prices.leaf(area, count as usize),
            PlanNode::Inner { right, .. } => {
                prices.inner(area, above - hoisted) + costs[at + 1] + costs[right as usize]
            }
        };
    }
    Ok(costs)
}

/// The most distinct triangles that each subtree may hold so that it, or any node above it, can still collapse. A leaf in place of a
/// node costs at least `per_triangle · distinct`, and must not cost more than the node's subtree does now.
fn distinct_limits(work: &Work, prices: &Prices, job: &Job<'_>) -> Result<Vec<u32>, BuildError> {
    let costs = subtree_costs(work, prices, job)?;
    let mut limits = filled(0u32, costs.len())?;
    for at in 0..costs.len() {
        job.check_at(at)?;
        // One triangle is added, so that rounding cannot rule out a collapse. Where the voxel has no area, the quotient may be NaN or
        // infinite, and there is no limit.
        let own = costs[at] / prices.per_triangle(work.areas[at].into()) + 1.0;
        let own = if own < f64::from(u32::MAX) { own as u32 } else { u32::MAX };
        limits[at] = limits[at].max(own);
        if let PlanNode::Inner { right, .. } = work.plan.nodes[at] {
            limits[at + 1] = limits[at];
            limits[right as usize] = limits[at];
        }
    }
    Ok(limits)
}

/// Union of two ascending lists.
fn merge(a: &[u32], b: &[u32]) -> Result<Vec<u32>, BuildError> {
    let mut out = with_room(a.len() + b.len())?;
    let (mut i, mut j) = (0, 0);
    while i < a.len() && j < b.len() {
        let (x, y) = (a[i], b[j]);
        out.push(x.min(y));
        i += usize::from(x <= y);
        j += usize::from(y <= x);
    }
    out.extend_from_slice(&a[i..]);
    out.extend_from_slice(&b[j..]);
    Ok(out)
}
