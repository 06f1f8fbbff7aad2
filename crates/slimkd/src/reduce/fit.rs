//! The fastest tree that fits a number of bytes, from one build.

use super::prune;
use crate::geometry::Aabb;
use crate::job::Job;
use crate::layout;
use crate::options::BuildError;
use crate::plan::{Plan, search_weight};

/// The first factor to the next weight where the builder has aimed at the budget already.
const NEAR: f32 = 1.15;

/// The plan pruned at the least weight of bytes, from the options' own on, at which it takes at most `budget` bytes once it is
/// encoded; and that weight.
pub(crate) fn fit(plan: Plan, voxel: Aabb, budget: u64, job: &Job<'_>) -> Result<(Plan, f32), BuildError> {
    let bytes_at = |byte_weight: f32| {
        job.check()?;
        if plan.price.is_some_and(|price| price.byte_weight == byte_weight) {
            return layout::size(&plan, &voxel, job);
        }
        job.memory.take(plan.bytes())?;
        let pruned = prune(plan.copied()?, voxel, byte_weight, job)?;
        let bytes = layout::size(&pruned, &voxel, job);
        drop(pruned);
        job.memory.give(plan.bytes());
        bytes
    };
    let own = job.options.byte_weight;
    let aimed = plan.price.map(|price| price.byte_weight).filter(|&weight| weight > own);
    let weight = match aimed {
        Some(weight) => search_weight(weight, Some(NEAR), budget, bytes_at)?,
        None => search_weight(own, None, budget, bytes_at)?,
    };
    Ok((prune(plan, voxel, weight, job)?, weight))
}
