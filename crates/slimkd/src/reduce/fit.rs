//! The fastest tree that fits a number of bytes, from one build.
//!
//! The weight ℓ of bytes orders all prunings of one plan from the fastest to the smallest, and sizes fall as it grows
//! (Breiman et al. 1984, *Classification and Regression Trees*, §3.3: prunings of one tree by cost + λ · size are
//! nested). So a search over ℓ finds the one that fits; each step prunes and encodes, which takes a tenth of a build.

use super::prune;
use crate::build::{BuildError, BuildOptions, Builder, Plan};
use crate::geometry::Aabb;

/// A tree this full is full enough, share of the budget.
const FULL: f64 = 0.97;
/// Steps of bisection, each halving the exponent's range; then the best so far is taken.
const STEPS: u32 = 12;
/// First weight above 0 that is tried, and the factor to the next while trees are still too large.
const FIRST: f32 = 0.02;
const FACTOR: f32 = 8.0;
/// At this weight a tree is one leaf, or nothing will make it so.
const LAST: f32 = 1e9;

/// What `encode` makes of the plan at the least weight that fits `budget`, and that weight. `encode` also says how many
/// bytes it took.
pub(crate) fn fit<T>(
    plan: &Plan,
    voxel: Aabb,
    builder: &Builder<'_>,
    options: &BuildOptions,
    budget: u64,
    mut encode: impl FnMut(&Plan) -> Result<(T, u64), BuildError>,
) -> Result<(T, f32), BuildError> {
    let mut at = |weight: f32| {
        builder.check()?;
        let weighed = BuildOptions { collapse: true, byte_weight: weight, ..options.clone() };
        encode(&prune(plan.clone(), voxel, &weighed))
    };
    let mut low = options.byte_weight;
    let (tree, bytes) = at(low)?;
    if bytes <= budget {
        return Ok((tree, low));
    }
    drop(tree);
    let mut high = FIRST.max(FACTOR * low);
    let mut found = loop {
        let (tree, bytes) = at(high)?;
        if bytes <= budget {
            break (tree, bytes);
        }
        if high >= LAST {
            return Err(BuildError::TreeTooLarge { needed: bytes, limit: budget });
        }
        (low, high) = (high, FACTOR * high);
    };
    for _ in 0..STEPS {
        if found.1 as f64 >= FULL * budget as f64 {
            break;
        }
        let middle = (low.max(0.1 * FIRST) * high).sqrt();
        if middle <= low || middle >= high {
            break;
        }
        let (tree, bytes) = at(middle)?;
        if bytes <= budget {
            (high, found) = (middle, (tree, bytes));
        } else {
            low = middle;
        }
    }
    Ok((found.0, high))
}
