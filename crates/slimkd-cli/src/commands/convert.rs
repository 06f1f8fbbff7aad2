//! `slimkd convert`: scenes of any format as one binary PLY.

use crate::args::{MoreScenes, SceneArgs};
use crate::failure::Failure;
use crate::output::Output;
use crate::scenes;
use crate::ui::Ui;
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  slimkd convert model.glb -o model.ply
  slimkd convert terrain.asc houses.obj -o town.ply";

/// Arguments of `slimkd convert`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ConvertArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    more: MoreScenes,
    /// The PLY file to write: positions, triangles and the colours of both
    #[arg(short, long, value_name = "file.ply")]
    output: PathBuf,
}

/// Loads and writes.
pub(crate) fn run(args: &ConvertArgs, ui: Ui) -> Result<(), Failure> {
    let path = &args.output;
    let is_device = path.metadata().is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir());
    if !is_device && !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ply")) {
        return Err(Failure::Usage(format!(
            "{}: scenes are written as PLY; end the name in .ply",
            path.display()
        )));
    }
    let output = Output::prepare(path)?
        .apart_from(scenes::files(&args.scene.scene, &args.scene.details))?
        .apart_from(args.more.more.iter().map(PathBuf::as_path))?;
    let loaded = scenes::load_all(&args.scene.scene, &args.more.more, &args.scene.details, ui)?;
    scenes::check_triangles(&loaded, ui)?;
    output.write_ply(&loaded.scene, path, ui)
}
