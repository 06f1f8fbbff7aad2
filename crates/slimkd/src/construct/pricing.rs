//! Estimates what a byte costs: the price λ = ℓ · (SAH cost / bytes), both of the whole tree before it is collapsed. That tree is never
//! built as a whole; a sample of its subtrees is, and both sums are estimated from it. Where the tree has a budget, the same
//! sample tells at which ℓ the tree keeps to it.
//!
//! Source: Horvitz & Thompson 1952, who estimate a sum from a sample whose members had unequal chances of being chosen.
//! `docs/construction.md` says how far the estimates are off.

use super::Builder;
use super::grow::{Task, Top};
use super::subtrees::Shares;
use crate::geometry::Aabb;
use crate::layout;
use crate::options::BuildError;
use crate::plan::{Plan, Price, Totals, UnitBytes, search_weight};
use crate::threads;

/// About how many subtrees are built in full to estimate λ; all of them where there are fewer than twice as many.
const SAMPLE: usize = 64;
/// The estimated bytes that the search aims at, as a multiple of the budget. It is above 1 because the finished tree is pruned where it
/// is too large, while a tree that is too small is not built again.
const AIM: f64 = 1.02;

/// A subtree that was built before λ was known.
pub(super) struct Built {
    pub(super) number: usize,
    pub(super) plan: Plan,
    totals: Totals,
}

/// What is known of a subtree before it is built.
pub(super) struct Size {
    pub(super) voxel: Aabb,
    /// The number of triangles. The subtree's bytes grow in proportion to it.
    count: f64,
    /// The expected cost: proportional to the subtree's SAH cost, weighted by its area relative to the root's. The SAH cost is taken to
    /// grow as the square root of the number of triangles.
    cost: f64,
    /// The chance of being chosen is in proportion to this: the part of all triangles plus the part of all expected cost; all subtrees
    /// together have 2. Were it only one of the two parts, single subtrees would decide the estimate of the other sum.
    chance: f64,
}

impl Size {
    pub(super) fn count(&self) -> usize {
        self.count as usize
    }

    /// The sizes of all tasks; `root_area` is the surface area of the root's voxel.
    pub(super) fn of(tasks: &[Option<Task>], root_area: f64) -> Vec<Self> {
        let size = |task: &Task| {
            let count = task.count() as f64;
            let area = if root_area > 0.0 { task.voxel.surface_area() / root_area } else { 0.0 };
            Self { voxel: task.voxel, count, cost: area * count.sqrt(), chance: 0.0 }
        };
        let mut sizes: Vec<Self> = tasks.iter().flatten().map(size).collect();
        let all = |of: fn(&Self) -> f64| sizes.iter().map(of).sum::<f64>().max(f64::MIN_POSITIVE);
        let (count, cost) = (all(|size| size.count), all(|size| size.cost));
        sizes.iter_mut().for_each(|size| size.chance = size.count / count + size.cost / cost);
        sizes
    }
}

/// The subtrees that were built first, and what they stand for.
pub(super) struct Sample<'a> {
    pub(super) built: Vec<Built>,
    pub(super) sizes: &'a [Size],
    pub(super) top: &'a Top,
}

impl Builder<'_> {
    /// Builds the chosen subtrees in full, and takes them out of `tasks`.
    pub(super) fn sample(
        &self,
        tasks: &mut [Option<Task>],
        chosen: &[usize],
        sizes: &[Size],
        shares: &Shares,
    ) -> Result<Vec<Built>, BuildError> {
        let root_area = self.bounds.surface_area();
        let taken: Vec<_> =
            chosen.iter().filter_map(|&number| Some((number, tasks[number].take()?))).collect();
        threads::map(taken, |(number, task)| {
            let voxel = task.voxel;
            let plan = self.built(task, None, shares.of_full(sizes[number].count()))?;
            let (totals, plan) = Totals::of_subtree(plan, &voxel, root_area, self.job)?;
            Ok(Built { number, plan, totals })
        })
    }

    /// SAH cost of the whole tree over its bytes.
    pub(super) fn cost_of_a_byte(&self, sample: &Sample<'_>) -> f64 {
        let Sample { built, sizes, top } = sample;
        let (mut cost, mut bytes) = (Ratio::default(), Ratio::default());
        // 1. Below the top: estimated sums over all subtrees.
        let step = step(sizes);
        for Built { number, totals, .. } in built {
            let size = &sizes[*number];
            cost.add(size.stands_for(step), totals.cost, size.cost);
            bytes.add(size.stands_for(step), totals.bytes, size.count);
        }
        // 2. The top itself is known: a traversal step at each of its nodes, and the bytes of these nodes.
        let (options, root_area) = (self.job.options, self.bounds.surface_area());
        let (nodes, area) = top.sums();
        let top_area = if root_area > 0.0 { area / root_area } else { 0.0 };
        let cost =
            f64::from(options.sah.traversal) * top_area + cost.total(sizes.iter().map(|size| size.cost));
        let bytes = UnitBytes::of(options.layout).node * nodes as f64
            + bytes.total(sizes.iter().map(|size| size.count));
        if bytes > 0.0 { cost / bytes } else { 0.0 }
    }

    /// The byte weight ℓ at which the tree should take about `budget` bytes. It is the options' own weight where the tree fits at that
    /// one, and where it fits at none: then the pruning of the finished tree reports the error.
    pub(super) fn weight_within(
        &self,
        sample: &Sample<'_>,
        cost_of_a_byte: f64,
        budget: u64,
        shares: &Shares,
    ) -> Result<f32, BuildError> {
        let Sample { built, sizes, top } = sample;
        let (job, root_area) = (self.job, self.bounds.surface_area());
        let step = step(sizes);
        let top = UnitBytes::of(job.options.layout).node * top.sums().0 as f64;
        // The tree's bytes at a weight: the sample is pruned at it, and its encoded sizes are extended to all subtrees.
        let bytes_at = |byte_weight: f32| {
            let price = Price { byte_weight, cost_of_a_byte, root_area };
            let sizes_of = threads::map(built, |Built { number, plan, .. }| {
                job.check()?;
                job.progress.advance(shares.of_pruning(sizes[*number].count()));
                let copy = plan.copied()?;
                job.memory.take(copy.bytes())?;
                let pruned = self.collapsed(copy, &sizes[*number].voxel, price)?;
                let bytes = layout::size(&pruned, &self.bounds, job)?;
                job.memory.give(pruned.bytes());
                Ok(bytes)
            })?;
            let mut bytes = Ratio::default();
            for (Built { number, .. }, size_of) in built.iter().zip(sizes_of) {
                let size = &sizes[*number];
                bytes.add(size.stands_for(step), size_of as f64, size.count);
            }
            Ok((top + bytes.total(sizes.iter().map(|size| size.count))) as u64)
        };
        let own = job.options.byte_weight;
        match search_weight(own, None, (AIM * budget as f64) as u64, bytes_at) {
            Err(BuildError::TreeTooLarge { .. }) => Ok(own),
            found => found,
        }
    }
}

/// Estimates a sum over all subtrees from those in the sample, by its ratio to the sum of a quantity that is known of all.
#[derive(Default)]
struct Ratio {
    /// The estimated sum of what is sought.
    sought: f64,
    /// The estimated sum of the quantity that is known.
    known: f64,
}

impl Ratio {
    fn add(&mut self, stands_for: f64, sought: f64, known: f64) {
        self.sought += stands_for * sought;
        self.known += stands_for * known;
    }

    /// The sum of what is sought over all subtrees, whose known quantities are given.
    fn total(&self, known: impl Iterator<Item = f64>) -> f64 {
        if self.known > 0.0 { self.sought * known.sum::<f64>() / self.known } else { 0.0 }
    }
}

impl Size {
    /// How many subtrees this one stands for in the sums when it is chosen: the reciprocal of its probability of being chosen.
    fn stands_for(&self, step: f64) -> f64 {
        if self.chance < step { step / self.chance } else { 1.0 }
    }
}

/// Whether only a part of the subtrees is built first.
pub(super) fn is_sampled(sizes: &[Size]) -> bool {
    sizes.len() >= 2 * SAMPLE
}

/// The chances of all subtrees, laid end to end, are cut into steps of this length, and one subtree is chosen in each; 0 where all are
/// chosen.
fn step(sizes: &[Size]) -> f64 {
    if !is_sampled(sizes) {
        return 0.0;
    }
    sizes.iter().map(|size| size.chance).sum::<f64>() / SAMPLE as f64
}

/// The numbers of the subtrees in the sample, ascending: a systematic sample. With the chances laid end to end, the subtree that lies in
/// the middle of each step is chosen; one that is longer than a step is always chosen, and only once.
pub(super) fn chosen(sizes: &[Size]) -> Vec<usize> {
    let step = step(sizes);
    if step == 0.0 {
        return (0..sizes.len()).collect();
    }
    let (mut before, mut next) = (0.0, 0.5 * step);
    let mut out = Vec::with_capacity(SAMPLE);
    for (number, size) in sizes.iter().enumerate() {
        before += size.chance;
        if before > next {
            out.push(number);
            next += step * ((before - next) / step).ceil();
        }
    }
    out
}
