//! `slimkd build`: a tree, its size and shape, and its file.

use crate::args::{MoreScenes, SceneArgs, TreeArgs};
use crate::failure::Failure;
use crate::output::Output;
use crate::report::{Report, savings_hint};
use crate::{saved, scenes, trees, ui, ui::Ui};
use clap::Args;
use slimkd::{BuildOptions, FileError};
use slimkd_lab::measure::savings::Savings;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  slimkd build sponza.obj
  slimkd build building.ply.zst --preset paper-small -o building.skd
  slimkd build building.ply.zst -o building.skd --no-mesh
  slimkd build building.ply.zst --preset paper-fast --savings
  slimkd build sponza.obj --preset standard --occupancy 0.5 --frequency 0.4 --rebuild
  slimkd build sponza.obj --preset standard --layout dense --byte-weight 0.2 --clipping 10000
  slimkd build kitchen --triangles 1000000 --threads 1 --json";

/// Arguments of `slimkd build`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BuildArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    more: MoreScenes,
    /// Save the tree, with its mesh
    #[arg(short, long, value_name = "tree.skd")]
    output: Option<PathBuf>,
    /// Save the tree without its mesh: who reads it gives that with --mesh
    #[arg(long, requires = "output")]
    no_mesh: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Show how much of the tree's size hoisting, collapse and the layout save, each: takes one build more, or two
    #[arg(long)]
    savings: bool,
    #[command(flatten)]
    tree: TreeArgs,
}

/// Builds, reports, saves.
pub(crate) fn run(args: &BuildArgs, ui: Ui) -> Result<(), Failure> {
    args.tree.tuning.check()?;
    let output =
        args.output.as_deref().map(|path| prepare(path, &args.scene, &args.more.more)).transpose()?;
    let mut loaded = scenes::load_all(&args.scene.scene, &args.more.more, &args.scene.details, ui)?;
    drop(loaded.tree.take());
    let (scene, options) = (&loaded.scene, args.tree.options());
    let tree = trees::build(&loaded.origin(), &scene.mesh, &options, ui)?;
    let degenerate = trees::warn_of_degenerate(&tree, ui)?;
    if let Some(output) = output {
        let mut draft = output.draft()?;
        let written = match args.no_mesh {
            true => tree.tree.write_without_mesh(&mut draft),
            false => tree.tree.write(&mut draft),
        };
        written.map_err(|error| match error {
            FileError::Io(error) => crate::output::unwritable(output.path(), &error),
            other => Failure::at(output.path(), other),
        })?;
        draft.commit()?;
        ui.note(format_args!("wrote {}", output.path().display()));
    }
    let bytes = tree.tree.memory().tree();
    let other = |options: &BuildOptions| {
        let tree = trees::build(&tree.origin, &scene.mesh, options, ui)?;
        Ok::<_, Failure>(tree.tree.memory().tree())
    };
    let measure = || Savings::measure((&tree.statistics, bytes), &options, other);
    let savings = args.savings.then(measure).transpose()?;
    let report = Report::new(&tree, args.tree.threads)
        .with_savings(savings)
        .with_warnings(scene.warnings.iter().chain(&degenerate));
    if args.json {
        return ui::print_json(&report);
    }
    let hint = if args.savings { String::new() } else { savings_hint(&tree.statistics, bytes) };
    ui::print(&(report.table(&tree) + &hint))
}

/// A place for the tree; a name with another ending would be a scene's, or nobody could read the tree under it.
fn prepare(path: &Path, scene: &SceneArgs, more: &[PathBuf]) -> Result<Output, Failure> {
    let is_device = path.metadata().is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir());
    if !is_device && !saved::is_saved(path) {
        return Err(Failure::usage(format_args!(
            "{}: trees are saved as .skd; end the name in .skd",
            path.display()
        )));
    }
    Output::prepare(path)?
        .apart_from(scenes::files(&scene.scene, &scene.details))?
        .apart_from(more.iter().map(PathBuf::as_path))
}
