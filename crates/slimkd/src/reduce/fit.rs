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
/// The first factor where the builder has aimed at the budget already.
const NEAR: f32 = 1.15;
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
    let at = |weight: f32| {
        builder.check()?;
        if plan.collapsed.is_some_and(|collapsed| collapsed.byte_weight == weight) {
            return encode(plan);
        }
        let weighed = BuildOptions { collapse: true, byte_weight: weight, ..options.clone() };
        builder.memory.take(plan.bytes())?;
        let pruned = prune(plan.copied()?, voxel, &weighed, builder)?;
        let encoded = encode(&pruned);
        drop(pruned);
        builder.memory.give(plan.bytes());
        encoded
    };
    let built = plan.collapsed.map_or(0.0, |collapsed| collapsed.byte_weight);
    if built > options.byte_weight {
        return search_weight(built, Some(NEAR), budget, at);
    }
    search_weight(options.byte_weight, None, budget, at)
}

/// What `at` makes of the least weight, from `low` on, at which it says that the bytes are within `budget`; and that weight.
/// `near` is the factor to a second weight if the first should nearly do.
pub(crate) fn search_weight<T>(
    mut low: f32,
    near: Option<f32>,
    budget: u64,
    mut at: impl FnMut(f32) -> Result<(T, u64), BuildError>,
) -> Result<(T, f32), BuildError> {
    let (tree, mut low_bytes) = at(low)?;
    if low_bytes <= budget {
        return Ok((tree, low));
    }
    drop(tree);
    let mut factor = near.unwrap_or(FACTOR);
    let mut high = if near.is_some() { factor * low } else { FIRST.max(factor * low) };
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
        factor *= factor;
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
