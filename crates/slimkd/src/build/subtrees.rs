//! What hangs below the top of the tree: many subtrees, each built, and where asked for collapsed, by one thread.
//!
//! Deviation from a collapse of the whole tree: no node of the top collapses. It holds hundreds or thousands of triangles, and
//! its best split already was cheaper than a leaf.

use super::BuildError;
use super::fork::{Task, Top};
use super::memory::filled;
use super::plan::{Collapsed, Plan};
use super::price::{Full, Sample, Size, chosen, is_sampled};
use super::recursion::{Builder, PriceOfBytes};
use crate::geometry::Aabb;
use crate::reduce::collapse_subtree;
use rayon::prelude::*;

/// Building a subtree of the sample in full, in units of building one that is priced.
const FULL: f64 = 1.6;
/// Pruning and encoding it once, in the same units, and how often that is done for a bound, about.
const PRUNED: f64 = 0.35;
const TIMES: f64 = 3.0;

/// Steps that a subtree of so many triangles takes, about.
fn steps(triangles: usize) -> f64 {
    let n = triangles as f64;
    n * (n + 2.0).log2()
}

/// How far the progress moves for what.
pub(super) struct WorkLeft {
    share: f64,
    /// Steps of all subtrees.
    all: f64,
}

impl WorkLeft {
    /// The share of building a subtree.
    pub(super) fn of(&self, triangles: usize) -> f64 {
        self.share * steps(triangles) / self.all.max(1.0)
    }

    /// The share of building it in full.
    pub(super) fn of_full(&self, triangles: usize) -> f64 {
        FULL * self.of(triangles)
    }

    /// The share of pruning it once.
    pub(super) fn of_pruning(&self, triangles: usize) -> f64 {
        PRUNED * self.of(triangles)
    }
}

impl Builder<'_> {
    /// All subtrees, in the order of `tasks`, and by which prices they were collapsed. Moves the progress by `share`.
    pub(super) fn subtrees(
        &self,
        tasks: Vec<Task>,
        top: &Top,
        root_area: f64,
        share: f64,
    ) -> Result<(Vec<Plan>, Option<Collapsed>), BuildError> {
        let mut work = WorkLeft { share, all: tasks.iter().map(|task| steps(task.count())).sum() };
        let mut tasks: Vec<Option<Task>> = tasks.into_iter().map(Some).collect();
        let mut plans: Vec<Plan> = filled(Plan::default(), tasks.len())?;
        let (mut price, mut prices) = (None, None);
        if self.options.collapses_while_building() {
            let sizes = Size::of(&tasks, root_area);
            // Where all is built in full, a bound is kept by pruning the whole.
            let bound = self.bound.as_ref().filter(|_| is_sampled(&sizes));
            // At weight 0 and without a bound there is nothing to estimate.
            if self.options.byte_weight > 0.0 || bound.is_some() {
                let chosen = chosen(&sizes);
                let sampled: f64 = chosen.iter().map(|&number| steps(sizes[number].count())).sum();
                let pruned = if bound.is_some() { 1.0 + TIMES } else { 1.0 };
                work.all += (FULL + PRUNED * pruned - 1.0) * sampled;
                let full = self.sample(&mut tasks, &chosen, &sizes, root_area, &work)?;
                let sample = Sample { full, sizes: &sizes, top, root_area };
                let cost_of_a_byte = self.cost_of_a_byte(&sample);
                let byte_weight = match bound {
                    Some(bound) => self.weight_within(&sample, cost_of_a_byte, bound, &work)?,
                    None => self.options.byte_weight,
                };
                let lambda = f64::from(byte_weight) * cost_of_a_byte;
                let chosen = PriceOfBytes { lambda, root_area };
                let collapsed = sample
                    .full
                    .into_par_iter()
                    .with_max_len(1)
                    .map(|Full { number, plan, .. }| {
                        self.check()?;
                        self.progress.advance(work.of_pruning(sizes[number].count()));
                        Ok((number, self.collapsed(plan, &sizes[number].voxel, chosen)?))
                    })
                    .collect::<Result<Vec<_>, BuildError>>()?;
                collapsed.into_iter().for_each(|(number, plan)| plans[number] = plan);
                (price, prices) = (Some(chosen), Some(Collapsed { byte_weight, cost_of_a_byte }));
            } else {
                price = Some(PriceOfBytes { lambda: 0.0, root_area });
            }
        }
        tasks.into_par_iter().zip(&mut plans).with_max_len(1).try_for_each(|(task, plan)| {
            let Some(task) = task else { return Ok(()) };
            let voxel = task.voxel;
            let weight = work.of(task.count());
            *plan = self.subtree(task, price, weight)?;
            if let Some(price) = price {
                *plan = self.collapsed(std::mem::take(plan), &voxel, price)?;
            }
            Ok(())
        })?;
        Ok((plans, prices))
    }

    /// Keeps the account.
    pub(super) fn collapsed(
        &self,
        plan: Plan,
        voxel: &Aabb,
        price: PriceOfBytes,
    ) -> Result<Plan, BuildError> {
        let PriceOfBytes { lambda, root_area } = price;
        let held = plan.bytes();
        let Self { options, .. } = self;
        let plan = collapse_subtree(plan, voxel, root_area, &options.sah, options.layout, lambda, self)?;
        self.memory.give(held);
        self.memory.take(plan.bytes())?;
        Ok(plan)
    }

    /// Moves the progress by `weight`.
    pub(super) fn subtree(
        &self,
        task: Task,
        bytes: Option<PriceOfBytes>,
        weight: f64,
    ) -> Result<Plan, BuildError> {
        let (voxel, held) = (task.voxel, task.bytes());
        let plan = self.sequential(task.into_one()?, voxel, weight, bytes)?;
        self.memory.give(held);
        self.memory.take(plan.bytes())?;
        Ok(plan)
    }
}
