//! `slimkd scene`: the built-in scenes, listed or written as PLY files.

use crate::args::triangles;
use crate::failure::Failure;
use crate::output::Output;
use crate::ui::Ui;
use crate::{scenes, ui};
use clap::Args;
use std::num::NonZeroU32;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  slimkd scene --list
  slimkd scene kitchen --triangles 100000 -o kitchen.ply";

/// Arguments of `slimkd scene`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SceneCommandArgs {
    /// The built-in scene
    #[arg(value_name = "NAME", required_unless_present = "list")]
    name: Option<String>,
    /// List the built-in scenes
    #[arg(long, conflicts_with_all = ["name", "triangles", "output"])]
    list: bool,
    /// How many triangles it gets, 1 to 100000000
    #[arg(long, value_name = "N", value_parser = triangles)]
    triangles: Option<NonZeroU32>,
    /// The PLY file to write
    #[arg(short, long, value_name = "file.ply", required_unless_present = "list")]
    output: Option<PathBuf>,
}

/// Lists or writes.
pub(crate) fn run(args: &SceneCommandArgs, ui: Ui) -> Result<(), Failure> {
    let (Some(name), Some(path)) = (&args.name, &args.output) else {
        return ui::print(&scenes::list());
    };
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ply")) {
        return Err(Failure::Usage(format!(
            "{}: scenes are written as PLY; end the name in .ply",
            path.display()
        )));
    }
    let output = Output::prepare(path)?;
    let scene = scenes::built_in(name, args.triangles, ui)?.scene;
    output.write_ply(&scene, path, ui)
}
