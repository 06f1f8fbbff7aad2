//! What makes a tree smaller than the standard one: hoisting, collapse and the layout, apart.
//!
//! The steps are taken in this order, each on top of those before, so that their savings add up to the whole:
//! 1. The baseline: the same constants, no hoisting, no collapse, 4-byte references alone.
//! 2. Hoisting, with all that it changes in the tree below.
//! 3. Collapse. A step that the options leave out saves nothing and costs no build.
//! 4. The layout: the same nodes and references with 8 and 4 bytes each are counted, not built.

use crate::failure::Failure;
use crate::report::{Rows, amount};
use crate::trees::{self, Tree};
use crate::ui::Ui;
use serde::Serialize;
use slimkd::{BuildOptions, Layout, TreeStatistics};

/// Bytes saved, step by step; a step that made the tree larger is below 0. Optional part of the JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Savings {
    /// Bytes of the standard tree.
    baseline: u64,
    hoisting: i64,
    collapse: i64,
    layout: i64,
}

impl Savings {
    /// Builds what `tree` is compared with.
    pub(crate) fn measure(tree: &Tree, options: &BuildOptions, ui: Ui) -> Result<Self, Failure> {
        let size = |options: &BuildOptions| {
            let other = trees::build(&tree.origin, tree.tree.mesh(), options, ui)?;
            Ok::<_, Failure>(other.tree.memory().tree())
        };
        let mut without_collapse = options.clone();
        without_collapse.layout = Layout::FourByte;
        without_collapse.collapse = false;
        without_collapse.max_tree = None;
        let mut standard = without_collapse.clone();
        standard.hoisting = None;

        let baseline = size(&standard)?;
        let four_byte = four_byte(&tree.statistics);
        let hoisted = match (&options.hoisting, options.collapse) {
            (None, _) => baseline,
            (Some(_), false) => four_byte,
            (Some(_), true) => size(&without_collapse)?,
        };
        Ok(Self {
            baseline,
            hoisting: difference(baseline, hoisted),
            collapse: difference(hoisted, four_byte),
            layout: difference(four_byte, tree.tree.memory().tree()),
        })
    }

    /// Lines below the table.
    pub(crate) fn table(&self, tree: &Tree) -> String {
        let triangles = tree.statistics.triangles.max(1) as f64;
        let whole = self.baseline.max(1) as f64;
        let mut rows = Rows::default();
        rows.add("standard-style", amount(self.baseline, self.baseline as f64 / triangles));
        for (step, saved) in
            [("hoisting", self.hoisting), ("collapse", self.collapse), ("layout", self.layout)]
        {
            let sign = if saved < 0 { '+' } else { '-' };
            let size = saved.unsigned_abs();
            let share = 100.0 * size as f64 / whole;
            let amount = amount(size, size as f64 / triangles);
            rows.add(&format!("{sign} {step}"), format!("{amount}  {share:>5.1} % of it"));
        }
        rows.finish()
    }
}

/// The line that stands for [`Savings::table`] where nothing was built for it.
pub(crate) fn hint(statistics: &TreeStatistics, bytes: u64) -> String {
    let mut rows = Rows::default();
    rows.add(
        "savings",
        format!(
            "{} by the layout; --savings builds again to show the rest, each apart",
            crate::ui::bytes(four_byte(statistics).saturating_sub(bytes))
        ),
    );
    rows.finish()
}

/// Bytes of the same tree in 8-byte nodes and 4-byte references.
fn four_byte(statistics: &TreeStatistics) -> u64 {
    let nodes = &statistics.nodes;
    8 * (nodes.inner + 2 * nodes.t_inner + nodes.leaf)
        + 4 * (statistics.references() - statistics.t_references)
}

fn difference(before: u64, after: u64) -> i64 {
    before as i64 - after as i64
}
