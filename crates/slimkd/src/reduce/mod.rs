//! From the standard plan to a smaller one: T-references, collapse.
//!
//! ```text
//! Plan ─▶ hoist (strip or rebuild) ─▶ prune (collapse; by `fit` where the bytes are given) ─▶ Plan
//! ```

mod collapse;
mod fit;
mod measures;
mod options;
mod rebuild;
mod strip;
mod work;

use crate::build::{BuildError, BuildOptions, Builder, Plan};
use crate::geometry::Aabb;
pub(crate) use collapse::{Bytes, Totals, collapse_subtree};
pub(crate) use fit::{fit, search_weight};
pub use options::{CountedLeaves, HoistAlgorithm, Hoisting, OccupancyBase, WhenLeafRemains};

/// Hoists where the options ask for it; moves the progress by `share`.
pub(crate) fn hoist(
    mut plan: Plan,
    voxel: Aabb,
    builder: &Builder<'_>,
    options: &BuildOptions,
    share: f64,
) -> Result<Plan, BuildError> {
    if let Some(hoisting) = &options.hoisting {
        let beside = 24 * plan.nodes.len() + 8 * builder.mesh().len(); // what stripping keeps beside the plan
        builder.memory.take(beside)?;
        plan = match hoisting.algorithm {
            HoistAlgorithm::Strip => strip::hoist(plan, voxel, hoisting, builder, share)?,
            HoistAlgorithm::Predict => plan, // done while building
            HoistAlgorithm::Rebuild => rebuild::hoist(plan, voxel, hoisting, builder, share)?,
        };
        builder.memory.give(beside);
    }
    plan.counts = Vec::new(); // only stripping needs them
    Ok(plan)
}

/// Collapses where the options ask for it. What the builder collapsed at this weight stays as it is.
pub(crate) fn prune(
    plan: Plan,
    voxel: Aabb,
    options: &BuildOptions,
    builder: &Builder<'_>,
) -> Result<Plan, BuildError> {
    let done = plan.collapsed.is_some_and(|collapsed| collapsed.byte_weight == options.byte_weight);
    if !options.collapse || done {
        return Ok(plan);
    }
    let beside = plan.bytes();
    builder.memory.take(beside)?;
    let pruned = collapse::collapse(plan, voxel, &options.sah, options.byte_weight, options.layout, builder)?;
    builder.memory.give(beside);
    Ok(pruned)
}
