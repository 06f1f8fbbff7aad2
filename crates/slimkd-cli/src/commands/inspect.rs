//! `slimkd inspect`: the size and shape of a tree that is built for it, or read from its file.

use crate::args::{SourceArgs, TreeArgs};
use crate::failure::Failure;
use crate::report::{Report, histograms};
use crate::{trees, ui, ui::Ui};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  slimkd inspect building.ply.zst --preset standard
  slimkd inspect building.ply.zst --occupancy 0.7 --frequency 0.5 --collapse
  slimkd inspect building.skd --json";

/// Arguments of `slimkd inspect`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct InspectArgs {
    #[command(flatten)]
    source: SourceArgs,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    tree: TreeArgs,
}

/// Reports.
pub(crate) fn run(args: &InspectArgs, ui: Ui) -> Result<(), Failure> {
    let tree = trees::read_or_build(&args.source, &args.tree, ui)?;
    let report = Report::new(&tree, args.tree.threads);
    if args.json {
        ui::print_json(&report)
    } else {
        ui::print(&(report.table(&tree) + &histograms(&tree.statistics)))
    }
}
