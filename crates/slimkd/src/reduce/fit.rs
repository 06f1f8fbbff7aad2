//! The fastest tree that fits a number of bytes, from one build.
//!
//! The weight ℓ of bytes orders all prunings of one plan from the fastest to the smallest, and sizes fall as it grows
//! (Breiman et al. 1984, *Classification and Regression Trees*, §3.3: prunings of one tree by cost + λ · size are
//! nested). So a search over ℓ finds the one that fits; each step prunes and encodes, which takes a tenth of a build.

use super::prune;
use crate::build::{BuildError, BuildOptions, Builder, Plan};
use crate::geometry::Aabb;

/// A tree this full is full enough, share of the budget.
const FULL: f64 = 0.96;
/// Where the search aims, share of the budget: the middle of what is full enough.
const AIM: f64 = 0.98;
/// Steps between two weights whose trees lie on both sides of the budget; then the best so far is taken.
const STEPS: u32 = 8;
/// First weight that is tried where the options have a smaller one, and the first factor to the next.
const FIRST: f32 = 0.03;
const FACTOR: f32 = 3.0;
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
    let (tree, mut low_bytes) = at(low)?;
    if low_bytes <= budget {
        return Ok((tree, low));
    }
    drop(tree);
    let mut high = FIRST.max(FACTOR * low);
    let mut factor = FACTOR;
    let (mut tree, mut high_bytes) = loop {
        let (tree, bytes) = at(high)?;
        if bytes <= budget {
            break (tree, bytes);
        }
        if high >= LAST {
            return Err(BuildError::TreeTooLarge { needed: bytes, limit: budget });
        }
        (low, low_bytes) = (high, bytes);
        high *= factor;
        factor *= FACTOR;
    };
    for _ in 0..STEPS {
        if high_bytes as f64 >= FULL * budget as f64 {
            break;
        }
        let Some(middle) = between((low, low_bytes), (high, high_bytes), AIM * budget as f64) else { break };
        let (other, bytes) = at(middle)?;
        if bytes <= budget {
            (high, high_bytes, tree) = (middle, bytes, other);
        } else {
            (low, low_bytes) = (middle, bytes);
        }
    }
    Ok((tree, high))
}

/// A weight between two at which the tree should have `aim` bytes: sizes are nearly a power of the weight.
fn between(low: (f32, u64), high: (f32, u64), aim: f64) -> Option<f32> {
    let (from, to) = (f64::from(low.0.max(0.1 * FIRST)).ln(), f64::from(high.0).ln());
    let (most, least) = ((low.1 as f64).ln(), (high.1.max(1) as f64).ln());
    // Never nearer than a tenth to either end, so that a bend in the curve does not stop the search.
    let part = ((most - aim.ln()) / (most - least)).clamp(0.1, 0.9);
    let middle = (from + (to - from) * part).exp() as f32;
    (low.0 < middle && middle < high.0).then_some(middle)
}
