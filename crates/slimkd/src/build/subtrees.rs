//! What hangs below the top of the tree: many subtrees, each built, and where asked for collapsed, by one thread.
//!
//! Deviation from a collapse of the whole tree: no node of the top collapses. It holds hundreds or thousands of triangles, and
//! its best split already was cheaper than a leaf.

use super::BuildError;
use super::fork::{Task, Top};
use super::memory::filled;
use super::plan::{Collapsed, Plan};
use super::price::{Full, Sample, Size, is_sampled};
use super::recursion::{Builder, PriceOfBytes};
use crate::geometry::Aabb;
use crate::reduce::collapse_subtree;
use rayon::prelude::*;

impl Builder<'_> {
    /// All subtrees, in the order of `tasks`, and by which prices they were collapsed.
    pub(super) fn subtrees(
        &self,
        tasks: Vec<Task>,
        top: &Top,
        root_area: f64,
    ) -> Result<(Vec<Plan>, Option<Collapsed>), BuildError> {
        let mut tasks: Vec<Option<Task>> = tasks.into_iter().map(Some).collect();
        let mut plans: Vec<Plan> = filled(Plan::default(), tasks.len())?;
        let (mut price, mut prices) = (None, None);
        if self.options.collapses_while_building() {
            let sizes = Size::of(&tasks, root_area);
            // Where all is built in full, a bound is kept by pruning the whole.
            let bound = self.bound.as_ref().filter(|_| is_sampled(&sizes));
            // At weight 0 and without a bound there is nothing to estimate.
            if self.options.byte_weight > 0.0 || bound.is_some() {
                let full = self.sample(&mut tasks, &sizes, root_area)?;
                let sample = Sample { full, sizes: &sizes, top, root_area };
                let cost_of_a_byte = self.cost_of_a_byte(&sample);
                let byte_weight = match bound {
                    Some(bound) => self.weight_within(&sample, cost_of_a_byte, bound)?,
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
            *plan = self.subtree(task, price)?;
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

    pub(super) fn subtree(&self, task: Task, bytes: Option<PriceOfBytes>) -> Result<Plan, BuildError> {
        let (voxel, weight, held) = (task.voxel, task.weight, task.bytes());
        let plan = self.sequential(task.into_one()?, voxel, weight, bytes)?;
        self.memory.give(held);
        self.memory.take(plan.bytes())?;
        Ok(plan)
    }
}
