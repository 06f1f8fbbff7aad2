//! How the time of a build is shared out among its phases, so that the fraction that users see follows the clock.
//!
//! Costs are ns a triangle on one thread, medians over real scenes and all presets as measured by `examples/watch.rs` of
//! slimkd-scene; only their ratios matter. What one thread does alone counts in full, what all do is divided by their number.

use super::grow::sequential_below;
use crate::options::{BuildOptions, Clipping, HoistAlgorithm};

/// Sorting out what cannot be hit, and the first boxes. By all threads.
const SCAN: f64 = 100.0;
/// One level of the top of the tree. By all threads.
const LEVEL: f64 = 16.0;
/// Everything below the top, at each level. By all threads.
const BELOW: f64 = 110.0;
/// The same where triangles are clipped exactly in small nodes too.
const BELOW_CLIPPED: f64 = 145.0;
/// Joining subtrees to one plan.
const JOIN: f64 = 40.0;
/// Stripping a finished tree of its T-references; building subtrees anew.
const STRIP: f64 = 480.0;
const REBUILD: f64 = 3000.0;
/// Collapsing a whole tree, or pruning it to a number of bytes.
const PRUNE: f64 = 150.0;
/// Writing the tree; and measuring its depth.
const ENCODE: f64 = 50.0;
const DEPTH: f64 = 25.0;
/// All of the last three are so much cheaper where subtrees were collapsed while they were built.
const COLLAPSED: f64 = 0.1;

/// Shares of the phases, 1 together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    pub(crate) scan: f64,
    pub(super) top: f64,
    /// Levels that the top should have.
    pub(super) levels: f64,
    pub(super) below: f64,
    pub(super) join: f64,
    pub(crate) hoist: f64,
    pub(crate) prune: f64,
    pub(crate) encode: f64,
}

impl Pace {
    /// Of a build of so many triangles by so many threads.
    pub(crate) fn of(options: &BuildOptions, triangles: usize, threads: usize) -> Self {
        let below = sequential_below(options, triangles);
        let (n, threads) = (triangles.max(2) as f64, threads.max(1) as f64);
        let levels = (n / below.max(1) as f64).log2().max(0.0);
        let deep = n.min(below as f64).max(2.0).log2();
        let each = if options.clipping == Clipping::Exact { BELOW_CLIPPED } else { BELOW };
        let kept = if options.collapses_while_building() { COLLAPSED } else { 1.0 };
        let hoist = match &options.hoisting {
            Some(hoisting) if hoisting.algorithm == HoistAlgorithm::Strip => STRIP,
            Some(hoisting) if hoisting.algorithm == HoistAlgorithm::Rebuild => REBUILD,
            _ => 0.0,
        };
        let prunes = options.max_tree.is_some() || options.collapse && options.hoisting.is_some();
        let costs = [
            SCAN / threads,
            LEVEL * levels / threads,
            each * deep / threads,
            JOIN * kept,
            hoist,
            if prunes { PRUNE * kept } else { 0.0 },
            (if options.max_tree.is_some() { DEPTH } else { ENCODE + DEPTH }) * kept,
        ];
        let all: f64 = costs.iter().sum();
        let [scan, top, below, join, hoist, prune, encode] = costs.map(|cost| cost / all);
        Self { scan, top, levels, below, join, hoist, prune, encode }
    }
}
