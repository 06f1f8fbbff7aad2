//! `slimkd bench`: rates of the presets on one scene, measured in turns within one run.

mod report;
mod runner;

use crate::args::{CameraArgs, SceneArgs, TuningArgs, preset, threads};
use crate::failure::Failure;
use crate::kernel::Kernel;
use crate::trees::Tree;
use crate::ui::Ui;
use crate::{cameras, scenes, trees, ui};
use clap::Args;
use report::Report;
use runner::{Bench, MOST_RAYS, Steps};
use slimkd::Preset;
use std::num::NonZeroUsize;

const EXAMPLES: &str = "\
Examples:
  slimkd bench building.ply.zst
  slimkd bench sponza.obj --presets standard,paper-small --view 1 --json
  slimkd bench kitchen --triangles 1000000 --threads 4 --frames
  slimkd bench kitchen --collapse       all presets, each with collapse
  slimkd bench tree.skd                 a saved tree alone
  slimkd bench tree.skd --presets slim,tiny     beside others of the same mesh

Workloads: primary (camera rays, closest hit), shadow (from there to a light, any hit),
bounce (from there, cosine-distributed, closest hit), random (segments across the scene,
closest hit). All presets must give the same hits, bit by bit, before any rate is reported.
Rates are medians; compare them within one run only.";

/// Arguments of `slimkd bench`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BenchArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The presets to compare; all unless given
    #[arg(long, value_name = "a,b,...", value_delimiter = ',', value_parser = preset())]
    presets: Vec<Preset>,
    /// Threads to trace with
    #[arg(long, value_name = "N", default_value = "1", value_parser = threads)]
    threads: NonZeroUsize,
    /// How rays are traced; the hits are the same with all
    #[arg(long, value_enum, default_value_t = Kernel::Single)]
    kernel: Kernel,
    /// Rounds to take the median of
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(5..=1000))]
    rounds: u32,
    /// Rays of a workload; as many as take about a minute in all unless given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_RAYS as i64))]
    rays: Option<u32>,
    /// Measure whole pictures too: 1024 x 1024 pixels, Whitted's rays from one sample each, no ambient occlusion
    #[arg(long)]
    frames: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    tuning: TuningArgs,
}

/// Builds, compares, measures.
pub(crate) fn run(args: &BenchArgs, ui: Ui) -> Result<(), Failure> {
    let mut loaded = scenes::load(&args.scene.scene, &args.scene.details, ui)?;
    cameras::settle_up(&args.camera, &mut loaded.scene);
    let built = contenders(args, &mut loaded, ui)?;
    let scene = &loaded.scene;
    trees::warn_of_degenerate(&built[0].1.statistics, ui);
    let bench = Bench {
        scene,
        trees: built.iter().map(|(preset, tree)| (preset.name(), &tree.tree)).collect(),
        views: cameras::choose(&args.camera, scene, &built[0].1.tree, cameras::VIEWS)?,
        pool: trees::pool(args.threads.get())?,
        kernel: args.kernel,
        rounds: args.rounds as usize,
        rays: args.rays.map(|rays| rays as usize),
    };
    let steps = Steps::default();
    let results = ui.watch("trace", &steps, || bench.rates(&steps, ui))?;
    let frames = args.frames.then(|| {
        let steps = Steps::default();
        ui.watch("frames", &steps, || bench.frames(&steps))
    });
    let report = Report { results, frames: frames.transpose()? };
    if args.json { ui::print_json(&report) } else { ui::print(&report.table()) }
}

/// The trees to compare. A saved one stands for its preset; beside it there are those that were asked for.
fn contenders(args: &BenchArgs, loaded: &mut scenes::Loaded, ui: Ui) -> Result<Vec<(Preset, Tree)>, Failure> {
    let mut trees: Vec<(Preset, Tree)> = Vec::new();
    let saved = loaded.tree.take();
    let scene = &loaded.scene;
    let all = if saved.is_none() { Preset::ALL } else { &[] };
    if let Some(tree) = saved {
        trees.push((tree.options().preset, trees::saved(&scene.name, tree, loaded.seconds)?));
    }
    for &preset in if args.presets.is_empty() { all } else { &args.presets } {
        if trees.iter().all(|tree| tree.0 != preset) {
            let options = args.tuning.options(preset, None);
            trees.push((preset, trees::build(&scene.name, &scene.mesh, loaded.seconds, &options, ui)?));
        }
    }
    Ok(trees)
}
