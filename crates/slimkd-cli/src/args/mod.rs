//! The command line as it is written; each group of options turns into what the library takes.

mod camera;
mod parse;
mod scene;
mod tree;

pub(crate) use camera::CameraArgs;
pub(crate) use parse::{Size, stops, threads, triangles, within};
pub(crate) use scene::{FileDetails, MoreScenes, SceneArgs, SceneDetails};
pub(crate) use tree::{Kind, TreeArgs, TuningArgs, listed, preset};

use crate::commands;
use clap::{Parser, Subcommand};

/// Ray tracing of large static triangle scenes with a small and fast SAH kd-tree.
#[derive(Debug, Parser)]
#[command(name = "slimkd", version, arg_required_else_help = true, after_help = EXAMPLES)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Print errors only
    #[arg(long, short, global = true, display_order = LAST)]
    pub(crate) quiet: bool,
    /// Fail, with status 1, where a scene file would only be warned of: something in it was left out or replaced
    #[arg(long, global = true, display_order = LAST)]
    pub(crate) strict: bool,
}

/// Behind a command's own options.
const LAST: usize = 900;

const EXAMPLES: &str = "\
Examples:
  slimkd render            a picture of the built-in kitchen, and how small its tree gets
  slimkd render model.glb -o model.png
  slimkd build building.ply.zst --preset standard
  slimkd inspect building.ply.zst --json
  slimkd report building.ply.zst -o report
  slimkd scene --list

SCENE is a file (.ply .obj .stl .off .gltf .glb .xml .serialized .json .jsonl .asc .npy, each also with .zst or \
.gz behind it), the name of a built-in scene, or a tree.skd saved by `slimkd build -o`.
Exit status: 0 done, 1 the work failed, 2 wrong usage, 130 interrupted.";

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to a picture
    Render(commands::render::RenderArgs),
    /// Build a tree, report its size and shape, and save it if asked to
    Build(commands::build::BuildArgs),
    /// Report the size and shape of a scene's tree or of a saved one, in more detail
    Inspect(commands::inspect::InspectArgs),
    /// Trace rays from a file and write their hits to another
    Trace(commands::trace::TraceArgs),
    /// Measure the presets against each other
    Bench(commands::bench::BenchArgs),
    /// Write the paper's tables and figures from scenes, as a page
    Report(commands::report::ReportArgs),
    /// List what rays can be traced on
    Devices(commands::devices::DevicesArgs),
    /// List the built-in scenes, or write one as a PLY file
    Scene(commands::scene::SceneCommandArgs),
    /// Write scenes as one binary PLY file, with the triangles' ids as they are
    Convert(commands::convert::ConvertArgs),
    /// Print a completion script for a shell
    Completions(commands::completions::CompletionsArgs),
}
