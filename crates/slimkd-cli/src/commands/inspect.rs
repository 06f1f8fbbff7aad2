//! `slimkd inspect`: the size and shape of a tree that is built for it, or read from its file.

use crate::args::{MoreScenes, SceneArgs, TreeArgs};
use crate::failure::Failure;
use crate::report::{Report, histograms};
use crate::{scenes, trees, ui, ui::Ui};
use clap::Args;
use slimkd_scene::MeshCheck;

const EXAMPLES: &str = "\
Examples:
  slimkd inspect building.ply.zst --preset standard
  slimkd inspect building.ply.zst --occupancy 0.7 --frequency 0.5 --collapse
  slimkd inspect building.skd --json
  slimkd inspect from-elsewhere.skd --complete";

/// Arguments of `slimkd inspect`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct InspectArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    more: MoreScenes,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Prove as well that no triangle is missing from any leaf: finds saved trees that were forged on purpose. Whatever else is
    /// wrong with a file is found without
    #[arg(long)]
    complete: bool,
    #[command(flatten)]
    tree: TreeArgs,
}

/// Reports.
pub(crate) fn run(args: &InspectArgs, ui: Ui) -> Result<(), Failure> {
    args.tree.tuning.check()?;
    let mut loaded = scenes::load_all(&args.scene.scene, &args.more.more, &args.scene.details, ui)?;
    let tree = trees::take_or_build(&mut loaded, &args.tree, ui)?;
    let degenerate = trees::warn_of_degenerate(&tree, ui)?;
    if args.complete {
        let pool = trees::pool(trees::thread_count(args.tree.threads))?;
        trees::prove_complete(&tree, &pool, ui)?;
    }
    let report = Report::new(&tree, args.tree.threads)
        .with_warnings(loaded.scene.warnings.iter().chain(&degenerate))
        .with_mesh_check(&MeshCheck::of(tree.tree.mesh()));
    if args.json {
        ui::print_json(&report)
    } else {
        ui::print(&(report.table(&tree) + &histograms(&tree.statistics)))
    }
}
