//! The subtrees below the top of the tree. Each is built by one thread and, where the options ask for it, collapsed as soon as it is
//! built.
//!
//! Deviation from a collapse of the whole tree: no node of the top collapses. Such a node holds hundreds or thousands of triangles,
//! and its best split was already cheaper than a leaf.

use super::Builder;
use super::grow::{Task, Top};
use super::pricing::{Sample, Size, chosen, is_sampled};
use crate::geometry::Aabb;
use crate::job::memory::filled;
use crate::options::BuildError;
use crate::plan::{Plan, Price, collapse_subtree};
use crate::threads;

/// Time to build a subtree in full, in units of the time to build the same subtree while bytes have a price.
const FULL: f64 = 1.6;
/// Time to prune a subtree that was built in full, once, in the same units.
const PRUNED: f64 = 0.35;
/// About how often each subtree of the sample is pruned to find the weight that keeps to a budget.
const TIMES: f64 = 3.0;

/// About how many steps it takes to build a subtree of so many triangles; only ratios matter.
fn steps(triangles: usize) -> f64 {
    let n = triangles as f64;
    n * (n + 2.0).log2()
}

/// How the share of this phase in the build's time is divided among the subtrees.
pub(super) struct Shares {
    /// The share of the whole phase.
    phase: f64,
    /// The steps of all work of the phase together.
    steps: f64,
}

impl Shares {
    /// The share of building a subtree.
    fn of(&self, triangles: usize) -> f64 {
        self.phase * steps(triangles) / self.steps.max(1.0)
    }

    /// The share of building a subtree of the sample.
    pub(super) fn of_full(&self, triangles: usize) -> f64 {
        FULL * self.of(triangles)
    }

    /// The share of pruning a subtree of the sample once.
    pub(super) fn of_pruning(&self, triangles: usize) -> f64 {
        PRUNED * self.of(triangles)
    }
}

impl Builder<'_> {
    /// All subtrees, in the order of `tasks`, and the price at which they were collapsed. Moves the progress by `share`.
    pub(super) fn subtrees(
        &self,
        tasks: Vec<Task>,
        top: &Top,
        share: f64,
    ) -> Result<(Vec<Plan>, Option<Price>), BuildError> {
        // 1. Without collapsing, every subtree is built in full and kept.
        let mut shares = Shares { phase: share, steps: tasks.iter().map(|task| steps(task.count())).sum() };
        let mut tasks: Vec<Option<Task>> = tasks.into_iter().map(Some).collect();
        let mut plans: Vec<Plan> = filled(Plan::default(), tasks.len())?;
        let options = self.job.options;
        if !options.collapses_while_building() {
            self.build_rest(tasks, &mut plans, None, &shares)?;
            return Ok((plans, None));
        }
        // 2. Where only rays count, subtrees are collapsed at the price 0. Where all subtrees are in the sample, there is no budget here:
        //    the finished tree is pruned to it instead.
        let root_area = self.bounds.surface_area();
        let sizes = Size::of(&tasks, root_area);
        let budget = self.budget.filter(|_| is_sampled(&sizes));
        if options.byte_weight == 0.0 && budget.is_none() {
            let free = Price { byte_weight: 0.0, cost_of_a_byte: 0.0, root_area };
            self.build_rest(tasks, &mut plans, Some(free), &shares)?;
            return Ok((plans, None));
        }
        // 3. Choose the sample. Its subtrees take longer than the others, which changes all shares.
        let chosen = chosen(&sizes);
        let sampled: f64 = chosen.iter().map(|&number| steps(sizes[number].count())).sum();
        let prunings = if budget.is_some() { 1.0 + TIMES } else { 1.0 };
        shares.steps += (FULL + PRUNED * prunings - 1.0) * sampled;

        // 4. Build the sample in full. What a byte costs follows from it, and with a budget the byte weight too.
        let sample = Sample { built: self.sample(&mut tasks, &chosen, &sizes, &shares)?, sizes: &sizes, top };
        let cost_of_a_byte = self.cost_of_a_byte(&sample);
        let byte_weight = match budget {
            Some(budget) => self.weight_within(&sample, cost_of_a_byte, budget, &shares)?,
            None => options.byte_weight,
        };
        // 5. Collapse the sample at that price, and build the other subtrees at it.
        let price = Price { byte_weight, cost_of_a_byte, root_area };
        let collapsed = threads::map(sample.built, |built| {
            self.job.check()?;
            let size = &sizes[built.number];
            self.job.progress.advance(shares.of_pruning(size.count()));
            Ok((built.number, self.collapsed(built.plan, &size.voxel, price)?))
        })?;
        collapsed.into_iter().for_each(|(number, plan)| plans[number] = plan);
        self.build_rest(tasks, &mut plans, Some(price), &shares)?;
        Ok((plans, Some(price)))
    }

    /// Builds the tasks that are still there, each into its place in `plans`, and collapses them where there is a price.
    fn build_rest(
        &self,
        tasks: Vec<Option<Task>>,
        plans: &mut [Plan],
        price: Option<Price>,
        shares: &Shares,
    ) -> Result<(), BuildError> {
        let work = tasks.into_iter().zip(plans).filter_map(|(task, plan)| Some((task?, plan)));
        threads::map(work.collect::<Vec<_>>(), |(task, plan)| {
            let (voxel, share) = (task.voxel, shares.of(task.count()));
            *plan = self.built(task, price, share)?;
            if let Some(price) = price {
                *plan = self.collapsed(std::mem::take(plan), &voxel, price)?;
            }
            Ok(())
        })?;
        Ok(())
    }

    /// Collapses a subtree, and counts its new size in the account of memory in place of the old one.
    pub(super) fn collapsed(&self, plan: Plan, voxel: &Aabb, price: Price) -> Result<Plan, BuildError> {
        let held = plan.bytes();
        let plan = collapse_subtree(plan, voxel, price, self.job)?;
        self.job.memory.give(held);
        self.job.memory.take(plan.bytes())?;
        Ok(plan)
    }

    /// Builds a subtree, moves the progress by `share` and gives back the memory of its fragments.
    pub(super) fn built(&self, task: Task, price: Option<Price>, share: f64) -> Result<Plan, BuildError> {
        let (voxel, held) = (task.voxel, task.bytes());
        let plan = self.subtree(task.into_one()?, voxel, share, price)?;
        self.job.memory.give(held);
        self.job.memory.take(plan.bytes())?;
        Ok(plan)
    }
}
