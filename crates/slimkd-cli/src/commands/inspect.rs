//! `slimkd inspect`: the size and shape of a tree that is built for it, or read from its file.

use crate::args::{SceneArgs, TreeArgs};
use crate::failure::Failure;
use crate::report::{Report, histograms};
use crate::{trees, ui, ui::Ui};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  slimkd inspect building.ply.zst --preset standard
  slimkd inspect building.skd --json";

/// Arguments of `slimkd inspect`. SCENE may also be a saved tree.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct InspectArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    tree: TreeArgs,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Reports.
pub(crate) fn run(args: &InspectArgs, ui: Ui) -> Result<(), Failure> {
    let tree = trees::read_or_build(&args.scene.scene, args.scene.triangles, &args.tree, ui)?;
    let report = Report::new(&tree, args.tree.threads);
    if args.json {
        ui::print_json(&report)
    } else {
        ui::print(&(report.table(&tree) + &histograms(&tree.statistics)))
    }
}
