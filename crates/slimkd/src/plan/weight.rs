//! The least weight of bytes at which a tree keeps to a budget.
//!
//! The weight ℓ orders all prunings of one plan from the fastest to the smallest, and sizes fall as it grows
//! (Breiman et al. 1984, *Classification and Regression Trees*, §3.3: prunings of one tree by cost + λ · size are nested). So a
//! search over ℓ finds the one that fits.

use crate::options::BuildError;

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

/// The least weight, from `low` on, at which `bytes_at` says that the tree takes at most `budget` bytes. `near` is the factor to the
/// second weight that is tried, for a first one that should nearly do.
pub(crate) fn search_weight(
    mut low: f32,
    near: Option<f32>,
    budget: u64,
    mut bytes_at: impl FnMut(f32) -> Result<u64, BuildError>,
) -> Result<f32, BuildError> {
    let mut low_bytes = bytes_at(low)?;
    if low_bytes <= budget {
        return Ok(low);
    }
    let mut factor = near.unwrap_or(FACTOR);
    let mut high = if near.is_some() { factor * low } else { FIRST.max(factor * low) };
    let mut high_bytes = loop {
        let bytes = bytes_at(high)?;
        if bytes <= budget {
            break bytes;
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
        let bytes = bytes_at(middle)?;
        if bytes <= budget {
            (high, high_bytes) = (middle, bytes);
        } else {
            (low, low_bytes) = (middle, bytes);
        }
    }
    Ok(high)
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
