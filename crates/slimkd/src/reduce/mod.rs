//! From the standard plan to a smaller one: T-references, then collapse.
//!
//! ```text
//! Plan ─▶ hoist (strip or rebuild) ─▶ prune (collapse), or fit where the bytes have a budget ─▶ Plan
//! ```

mod fit;
mod measures;
mod rebuild;
mod strip;

use crate::construct::Builder;
use crate::geometry::Aabb;
use crate::job::Job;
use crate::options::{BuildError, HoistAlgorithm};
use crate::plan::{Plan, collapse};
pub(crate) use fit::fit;

/// Hoists where the options ask for it; moves the progress by `share`.
pub(crate) fn hoist(
    mut plan: Plan,
    voxel: Aabb,
    builder: &Builder<'_>,
    share: f64,
) -> Result<Plan, BuildError> {
    let job = builder.job;
    if let Some(hoisting) = &job.options.hoisting {
        let beside = 24 * plan.nodes.len() + 8 * job.mesh.len(); // what stripping keeps beside the plan
        job.memory.take(beside)?;
        plan = match hoisting.algorithm {
            HoistAlgorithm::Strip => strip::hoist(plan, voxel, hoisting, job, share)?,
            HoistAlgorithm::Rebuild => rebuild::hoist(plan, voxel, hoisting, builder, share)?,
        };
        job.memory.give(beside);
    }
    plan.counts = Vec::new(); // only stripping needs them
    Ok(plan)
}

/// Collapses at a weight of bytes. What the builder collapsed at this weight stays as it is.
pub(crate) fn prune(plan: Plan, voxel: Aabb, byte_weight: f32, job: &Job<'_>) -> Result<Plan, BuildError> {
    if plan.price.is_some_and(|price| price.byte_weight == byte_weight) {
        return Ok(plan);
    }
    let beside = plan.bytes();
    job.memory.take(beside)?;
    let pruned = collapse(plan, voxel, byte_weight, job)?;
    job.memory.give(beside);
    Ok(pruned)
}
