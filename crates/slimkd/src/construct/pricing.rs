//! What a byte costs, λ = ℓ · SAH cost / bytes of the tree before it is collapsed, estimated before that tree is there: from a
//! sample of its subtrees, built in full. Where the bytes have a budget, the same sample tells the ℓ that keeps to it.
//!
//! Source: Horvitz & Thompson 1952 for sums over what was sampled with unequal chances. `docs/construction.md` says how far the
//! estimates are off.

use super::Builder;
use super::grow::{Task, Top};
use super::subtrees::Shares;
use crate::geometry::Aabb;
use crate::layout;
use crate::options::BuildError;
use crate::plan::{Plan, Price, Totals, UnitBytes, search_weight};
use crate::threads;

/// Subtrees that are built in full to estimate λ, at most; all when there are fewer than twice as many.
const SAMPLE: usize = 64;
/// The most that the estimate may be, in budgets: a tree too large is pruned once it stands, one too small is not built again.
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
    /// Triangles; its bytes grow with them.
    count: f64,
    /// Grows as its SAH cost times its area relative to the root's: the cost itself as the square root of the triangles.
    cost: f64,
    /// Its share of all triangles and its share of all expected cost, added: 2 over all subtrees. A chance in proportion to
    /// one of them alone would let single subtrees decide the sum of the other.
    share: f64,
}

impl Size {
    pub(super) fn count(&self) -> usize {
        self.count as usize
    }

    /// Of all tasks.
    pub(super) fn of(tasks: &[Option<Task>], root_area: f64) -> Vec<Self> {
        let size = |task: &Task| {
            let count = task.count() as f64;
            let area = if root_area > 0.0 { task.voxel.surface_area() / root_area } else { 0.0 };
            Self { voxel: task.voxel, count, cost: area * count.sqrt(), share: 0.0 }
        };
        let mut sizes: Vec<Self> = tasks.iter().flatten().map(size).collect();
        let all = |of: fn(&Self) -> f64| sizes.iter().map(of).sum::<f64>().max(f64::MIN_POSITIVE);
        let (count, cost) = (all(|size| size.count), all(|size| size.cost));
        sizes.iter_mut().for_each(|size| size.share = size.count / count + size.cost / cost);
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
    /// Builds the chosen subtrees in full.
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
        let step = step(sizes);
        for Built { number, totals, .. } in built {
            let size = &sizes[*number];
            cost.add(size.stands_for(step), totals.cost, size.cost);
            bytes.add(size.stands_for(step), totals.bytes, size.count);
        }
        let (options, root_area) = (self.job.options, self.bounds.surface_area());
        let (nodes, area) = top.sums();
        let top_area = if root_area > 0.0 { area / root_area } else { 0.0 };
        let cost =
            f64::from(options.sah.traversal) * top_area + cost.total(sizes.iter().map(|size| size.cost));
        let bytes = UnitBytes::of(options.layout).node * nodes as f64
            + bytes.total(sizes.iter().map(|size| size.count));
        if bytes > 0.0 { cost / bytes } else { 0.0 }
    }

    /// The ℓ at which the tree should take about `budget` bytes; the options' own where that one is enough, or where no ℓ is.
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

/// A sum over a sample, and one of something that is known of the whole and grows with it.
#[derive(Default)]
struct Ratio {
    sought: f64,
    known: f64,
}

impl Ratio {
    fn add(&mut self, stands_for: f64, sought: f64, known: f64) {
        self.sought += stands_for * sought;
        self.known += stands_for * known;
    }

    /// The sought sum over the whole.
    fn total(&self, known: impl Iterator<Item = f64>) -> f64 {
        if self.known > 0.0 { self.sought * known.sum::<f64>() / self.known } else { 0.0 }
    }
}

impl Size {
    /// How many subtrees this one stands for, if it is chosen: it had a chance of one in so many.
    fn stands_for(&self, step: f64) -> f64 {
        if self.share < step { step / self.share } else { 1.0 }
    }
}

/// Whether not all subtrees are built first.
pub(super) fn is_sampled(sizes: &[Size]) -> bool {
    sizes.len() >= 2 * SAMPLE
}

/// One subtree is chosen in each such step of shares; 0 where all are.
fn step(sizes: &[Size]) -> f64 {
    if !is_sampled(sizes) {
        return 0.0;
    }
    sizes.iter().map(|size| size.share).sum::<f64>() / SAMPLE as f64
}

/// Numbers of the subtrees in the sample, ascending: systematic, with chances in proportion to their shares.
pub(super) fn chosen(sizes: &[Size]) -> Vec<usize> {
    let step = step(sizes);
    if step == 0.0 {
        return (0..sizes.len()).collect();
    }
    let (mut before, mut next) = (0.0, 0.5 * step);
    let mut out = Vec::with_capacity(SAMPLE);
    for (number, size) in sizes.iter().enumerate() {
        before += size.share;
        if before > next {
            out.push(number);
            next += step * ((before - next) / step).ceil();
        }
    }
    out
}
