//! From the standard plan to a smaller one: T-references, collapse.
//!
//! ```text
//! Plan ─▶ hoist (strip or rebuild) ─▶ collapse ─▶ Plan
//! ```

mod collapse;
mod measures;
mod options;
mod rebuild;
mod strip;
mod work;

use crate::build::{BuildError, BuildOptions, Builder, Plan};
use crate::geometry::Aabb;
pub use options::{CountedLeaves, HoistAlgorithm, Hoisting, OccupancyBase, WhenLeafRemains};

/// Applies what the options ask for.
pub(crate) fn reduce(
    mut plan: Plan,
    voxel: Aabb,
    builder: &Builder<'_>,
    options: &BuildOptions,
) -> Result<Plan, BuildError> {
    if let Some(hoisting) = &options.hoisting {
        plan = match hoisting.algorithm {
            HoistAlgorithm::Strip => strip::hoist(plan, voxel, hoisting, options)?,
            HoistAlgorithm::Predict => plan, // done while building
            HoistAlgorithm::Rebuild => rebuild::hoist(plan, voxel, hoisting, builder)?,
        };
    }
    plan.counts = Vec::new(); // only stripping needs them
    if options.collapse {
        plan = collapse::collapse(plan, voxel, &options.sah, options.byte_weight, options.layout);
    }
    Ok(plan)
}
