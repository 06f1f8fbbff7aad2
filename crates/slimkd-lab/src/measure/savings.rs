//! What makes a tree smaller than the standard one: hoisting, collapse and the layout, apart.

use serde::Serialize;
use slimkd::{BuildOptions, Layout, TreeStatistics};

/// Bytes saved, step by step; a step that made the tree larger is below 0. Optional part of the JSON of `slimkd build`.
///
/// The steps are taken in this order, each on top of those before, so that their savings add up to the whole:
/// 1. The baseline: the same constants, no hoisting, no collapse, 4-byte references alone.
/// 2. Hoisting, with all that it changes in the tree below.
/// 3. Collapse. A step that the options leave out saves nothing and costs no build.
/// 4. The layout: the same nodes and references with 8 and 4 bytes each are counted, not built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Savings {
    /// Bytes of the standard tree.
    pub baseline: u64,
    /// Saved by hoisting.
    pub hoisting: i64,
    /// Saved by collapse.
    pub collapse: i64,
    /// Saved by the layout.
    pub layout: i64,
}

impl Savings {
    /// The savings of a tree of that shape and that many bytes, which was built with `options`. `build` tells the bytes of the
    /// same mesh's tree with other options.
    pub fn measure<E>(
        (statistics, bytes): (&TreeStatistics, u64),
        options: &BuildOptions,
        mut build: impl FnMut(&BuildOptions) -> Result<u64, E>,
    ) -> Result<Self, E> {
        let mut no_collapse = options.clone();
        (no_collapse.layout, no_collapse.max_tree) = (Layout::FourByte, None);
        no_collapse.collapse = false;
        let mut standard = no_collapse.clone();
        standard.hoisting = None;

        let baseline = build(&standard)?;
        let four_byte = four_byte(statistics);
        let hoisted = match (&options.hoisting, options.collapse) {
            (None, _) => baseline,
            (Some(_), false) => four_byte,
            (Some(_), true) => build(&no_collapse)?,
        };
        let difference = |before: u64, after: u64| before as i64 - after as i64;
        Ok(Self {
            baseline,
            hoisting: difference(baseline, hoisted),
            collapse: difference(hoisted, four_byte),
            layout: difference(four_byte, bytes),
        })
    }
}

/// Bytes of the same tree in 8-byte nodes and 4-byte references.
pub fn four_byte(statistics: &TreeStatistics) -> u64 {
    let nodes = &statistics.nodes;
    8 * (nodes.inner + 2 * nodes.t_inner + nodes.leaf)
        + 4 * (statistics.references() - statistics.t_references)
}
