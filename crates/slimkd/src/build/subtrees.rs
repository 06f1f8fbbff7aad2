//! What hangs below the top of the tree: many subtrees, each built, and where asked for collapsed, by one thread.
//!
//! Collapsing by bytes needs λ = ℓ · SAH cost / bytes of the whole tree before the tree is there. Both are estimated from a
//! sample of the subtrees, built in full. `docs/construction.md` says what that costs and gains.
//!
//! Deviation from a collapse of the whole tree: no node of the top collapses. It holds thousands of triangles, and its best
//! split already was cheaper than a leaf.

use super::BuildError;
use super::fork::{Task, Top};
use super::plan::{Collapsed, Plan};
use super::recursion::{Builder, PriceOfBytes};
use crate::geometry::Aabb;
use crate::reduce::{Bytes, Totals, collapse_subtree};
use rayon::prelude::*;

/// Subtrees that are built in full to estimate λ, at most; all when there are fewer than twice as many.
const SAMPLE: usize = 64;

/// A subtree that was built before λ was known.
struct Full {
    number: usize,
    plan: Plan,
    totals: Totals,
}

impl Builder<'_> {
    /// All subtrees, in the order of `tasks`, and by which prices they were collapsed.
    pub(super) fn subtrees(
        &self,
        tasks: Vec<Task>,
        top: &Top,
        root_area: f64,
    ) -> Result<(Vec<Plan>, Option<Collapsed>), BuildError> {
        let mut tasks: Vec<Option<Task>> = tasks.into_iter().map(Some).collect();
        let mut plans: Vec<Plan> = vec![Plan::default(); tasks.len()];
        let (mut bytes, mut prices) = (None, None);
        if self.options.collapses_while_building() {
            let sizes: Vec<Size> = tasks.iter().flatten().map(|task| Size::of(task, root_area)).collect();
            let full = if self.options.byte_weight > 0.0 {
                self.sample(&mut tasks, &sizes, root_area)?
            } else {
                Vec::new()
            };
            let byte_weight = self.options.byte_weight;
            let cost_of_a_byte = self.ratio(&full, &sizes, top, root_area);
            let price = PriceOfBytes { lambda: f64::from(byte_weight) * cost_of_a_byte, root_area };
            bytes = Some(price);
            // At weight 0 nothing was estimated.
            prices = (byte_weight > 0.0).then_some(Collapsed { byte_weight, cost_of_a_byte });
            let collapsed = full
                .into_par_iter()
                .with_max_len(1)
                .map(|Full { number, plan, .. }| {
                    self.check()?;
                    let voxel = &sizes[number].voxel;
                    Ok((number, self.collapsed(plan, voxel, price)))
                })
                .collect::<Result<Vec<_>, BuildError>>()?;
            collapsed.into_iter().for_each(|(number, plan)| plans[number] = plan);
        }
        tasks.into_par_iter().zip(&mut plans).with_max_len(1).try_for_each(|(task, plan)| {
            let Some(task) = task else { return Ok(()) };
            let voxel = task.voxel;
            *plan = self.subtree(task, bytes)?;
            if let Some(price) = bytes {
                *plan = self.collapsed(std::mem::take(plan), &voxel, price);
            }
            Ok(())
        })?;
        Ok((plans, prices))
    }

    fn collapsed(&self, plan: Plan, voxel: &Aabb, price: PriceOfBytes) -> Plan {
        let PriceOfBytes { lambda, root_area } = price;
        collapse_subtree(plan, voxel, root_area, &self.options.sah, self.options.layout, lambda)
    }

    fn subtree(&self, task: Task, bytes: Option<PriceOfBytes>) -> Result<Plan, BuildError> {
        let (voxel, weight) = (task.voxel, task.weight);
        self.sequential(task.into_one(), voxel, weight, bytes)
    }

    /// Builds a sample of the subtrees in full, larger ones more often.
    fn sample(
        &self,
        tasks: &mut [Option<Task>],
        sizes: &[Size],
        root_area: f64,
    ) -> Result<Vec<Full>, BuildError> {
        let chosen = chosen(sizes);
        let taken: Vec<_> =
            chosen.iter().filter_map(|&number| Some((number, tasks[number].take()?))).collect();
        taken
            .into_par_iter()
            .with_max_len(1)
            .map(|(number, task)| {
                let voxel = task.voxel;
                let plan = self.subtree(task, None)?;
                let (totals, plan) =
                    Totals::of_subtree(plan, &voxel, root_area, &self.options.sah, self.options.layout);
                Ok(Full { number, plan, totals })
            })
            .collect()
    }

    /// SAH cost of the whole tree over its bytes, by what is known of the sample: every subtree counts for as many as it had
    /// a chance of one in.
    fn ratio(&self, full: &[Full], sizes: &[Size], top: &Top, root_area: f64) -> f64 {
        let step = step(sizes);
        let (mut cost, mut bytes, mut expected, mut count) = (0.0, 0.0, 0.0, 0.0);
        for Full { number, totals, .. } in full {
            let size = &sizes[*number];
            let weight = if size.expected < step { step / size.expected } else { 1.0 };
            cost += weight * totals.cost;
            expected += weight * size.expected;
            bytes += weight * totals.bytes;
            count += weight * size.count;
        }
        let all = |of: fn(&Size) -> f64| sizes.iter().map(of).sum::<f64>();
        let scaled = |known: f64, part: f64, whole: f64| if part > 0.0 { known * whole / part } else { 0.0 };
        let (nodes, area) = top.sums();
        let top_area = if root_area > 0.0 { area / root_area } else { 0.0 };
        let cost = f64::from(self.options.sah.traversal) * top_area
            + scaled(cost, expected, all(|size| size.expected));
        let bytes =
            Bytes::of(self.options.layout).node * nodes as f64 + scaled(bytes, count, all(|size| size.count));
        if bytes > 0.0 { cost / bytes } else { 0.0 }
    }
}

/// What is known of a subtree before it is built.
struct Size {
    voxel: Aabb,
    count: f64,
    /// Grows as its SAH cost times its area relative to the root's: the cost itself as the square root of the triangles.
    expected: f64,
}

impl Size {
    fn of(task: &Task, root_area: f64) -> Self {
        let count = task.count() as f64;
        let area = if root_area > 0.0 { task.voxel.surface_area() / root_area } else { 0.0 };
        Self { voxel: task.voxel, count, expected: area * count.sqrt() }
    }
}

/// One subtree is chosen in each such step of expected cost; 0 where all are.
fn step(sizes: &[Size]) -> f64 {
    if sizes.len() < 2 * SAMPLE {
        return 0.0;
    }
    sizes.iter().map(|size| size.expected).sum::<f64>() / SAMPLE as f64
}

/// Numbers of the subtrees in the sample, ascending: systematic, with chances in proportion to what is expected.
fn chosen(sizes: &[Size]) -> Vec<usize> {
    let step = step(sizes);
    if step == 0.0 {
        return (0..sizes.len()).collect();
    }
    let (mut before, mut next) = (0.0, 0.5 * step);
    let mut out = Vec::with_capacity(SAMPLE);
    for (number, size) in sizes.iter().enumerate() {
        before += size.expected;
        if before > next {
            out.push(number);
            next += step * ((before - next) / step).ceil();
        }
    }
    out
}
