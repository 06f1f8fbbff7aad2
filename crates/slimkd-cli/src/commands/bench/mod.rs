//! `slimkd bench`: rates of the presets on one scene, measured in turns within one run.

mod table;

use crate::args::{CameraArgs, MoreScenes, SceneArgs, Size, TuningArgs, preset, threads, within};
use crate::device::{self, Choice, Device, Pictures, Traces};
use crate::failure::Failure;
use crate::trees::Tree;
use crate::ui::{Ui, grouped};
use crate::{cameras, scenes, trees, ui};
use clap::Args;
use slimkd::Preset;
use slimkd_lab::measure::rates::{Kernel, MOST_RAYS, Named, Rates, RayDevice};
use slimkd_lab::measure::{self, Cpu};
use slimkd_lab::schema::RatesReport;
use slimkd_lab::{Progress, ReportError};
use slimkd_render::views::VIEWS;
use slimkd_scene::Warning;
use std::num::NonZeroUsize;

const EXAMPLES: &str = "\
Examples:
  slimkd bench building.ply.zst
  slimkd bench sponza.obj --presets standard,paper-small --view 1 --json
  slimkd bench kitchen --triangles 1000000 --threads 1,4 --frames
  slimkd bench kitchen --frames --size 256x256 --rays 1000
  slimkd bench kitchen --device cpu,gpu --frames
  slimkd bench kitchen --collapse       all presets, each with collapse
  slimkd bench tree.skd                 a saved tree alone
  slimkd bench tree.skd --presets slim,tiny     beside others of the same mesh

Workloads: primary (camera rays, closest hit), shadow (from there to a lamp above the camera, any hit), \
bounce (from there, cosine-distributed, closest hit), random (from random points of the \
scene's box in random directions, closest hit). All presets must give the same hits, bit by bit, \
before any rate is reported; a GPU must give the CPU's hits and pictures within its bounds. Its times are those of its kernels, \
by its own clock where it has one, and count as one thread.
Rates are medians; compare them within one run only.";

/// Arguments of `slimkd bench`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BenchArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    more: MoreScenes,
    /// The presets to compare; all unless given
    #[arg(long, value_name = "a,b,...", value_delimiter = ',', value_parser = preset())]
    presets: Vec<Preset>,
    /// Threads to trace with, 1 to 1024; several numbers are measured one after the other
    #[arg(long, value_name = "N,M,...", default_value = "1", value_delimiter = ',', value_parser = threads)]
    threads: Vec<NonZeroUsize>,
    /// What traces them; several are measured one after the other
    #[arg(long, value_enum, value_name = "A,B", default_value = "cpu", value_delimiter = ',')]
    device: Vec<Choice>,
    /// How rays are traced; the hits are the same with all
    #[arg(long, value_enum, default_value_t = Kernel::Single)]
    kernel: Kernel,
    /// Rounds to take the median of, 5 to 1000
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = within::<u32>(5..=1000))]
    rounds: u32,
    /// Rays of a workload, 1 to 1048576; as many as take about a minute in all unless given
    #[arg(long, value_name = "N", value_parser = within(1..=MOST_RAYS))]
    rays: Option<usize>,
    /// Measure whole pictures too, each view's: Whitted's rays from one sample a pixel, no ambient occlusion
    #[arg(long)]
    frames: bool,
    /// Width and height of these pictures in pixels, each 1 to 16384
    #[arg(long, value_name = "WxH", default_value = "1024x1024", requires = "frames")]
    size: Size,
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
    args.tuning.check()?;
    let mut choices = args.device.clone();
    choices.dedup();
    let mut devices = Vec::new();
    for choice in choices {
        choice.check(args.kernel)?;
        devices.push((choice, device::open(choice, ui)?));
    }
    let mut loaded = scenes::load_all(&args.scene.scene, &args.more.more, &args.scene.details, ui)?;
    cameras::settle_up(&args.camera, &mut loaded.scene);
    let built = contenders(args, &mut loaded, ui)?;
    let scene = &loaded.scene;
    let degenerate = trees::warn_of_degenerate(&built[0].1, ui)?;
    let views = cameras::choose(&args.camera, &loaded, &built[0].1.tree, VIEWS)?;
    let trees: Vec<Named<'_>> = built.iter().map(|(preset, tree)| (preset.name(), &tree.tree)).collect();
    let mut counts = args.threads.clone();
    counts.dedup();
    let warnings = scene.warnings.iter().chain(&degenerate).map(Warning::to_string).collect();
    let mut report = RatesReport { warnings, ..Default::default() };
    let failed = |error| match error {
        ReportError::Cancelled => Failure::Interrupted,
        ReportError::Camera(error) => {
            Failure::work(format_args!("{}: {error} (--camera, --up)", loaded.place))
        }
        error => Failure::work(error),
    };
    let compared = |workload: &str, rays: usize, per_cent: f64, alike: &str| {
        let rays = grouped(rays as u64);
        ui.note(format_args!("{workload}: {rays} rays, {per_cent:.1} % hit, {alike}"));
    };
    let mut measure = |threads: usize, device: Option<&dyn Device>| -> Result<(), Failure> {
        let traces = device.map(Traces);
        let rates = Rates {
            scene,
            trees: &trees,
            views: &views,
            pool: &trees::pool(threads)?,
            kernel: args.kernel,
            device: traces.as_ref().map(|device| device as &dyn RayDevice),
            rounds: args.rounds as usize,
            rays: args.rays,
        };
        let progress = Progress::new();
        let results = ui.watch("trace", &progress, || rates.measure(&progress, &compared));
        report.results.extend(results.map_err(failed)?);
        if args.frames {
            let device: Box<dyn measure::Device + '_> = match device {
                Some(device) => Box::new(Pictures { device, optional: false }),
                None => Box::new(Cpu::new(threads).map_err(failed)?),
            };
            let size = [args.size.width, args.size.height];
            let progress = Progress::new();
            let frames = ui.watch("frames", &progress, || rates.frames(device.as_ref(), size, &progress));
            report.frames.get_or_insert_default().extend(frames.map_err(failed)?);
        }
        Ok(())
    };
    for (choice, device) in &devices {
        let takes_all = |device: &dyn Device| {
            built.iter().try_for_each(|(_, tree)| {
                device.scene(scene, &tree.tree).map(drop).map_err(|error| error.to_string())
            })
        };
        let device = match device.as_deref() {
            Some(device) if *choice == Choice::Auto => choice.or_cpu(takes_all(device), ui)?.map(|()| device),
            named => named,
        };
        match device {
            Some(device) => measure(trees::thread_count(None), Some(device))?,
            None => counts.iter().try_for_each(|threads| measure(threads.get(), None))?,
        }
    }
    if args.json { ui::print_json(&report) } else { ui::print(&table::table(&report, args.size)) }
}

/// The trees to compare. A saved one stands for its preset; beside it there are those that were asked for.
fn contenders(args: &BenchArgs, loaded: &mut scenes::Loaded, ui: Ui) -> Result<Vec<(Preset, Tree)>, Failure> {
    let mut trees: Vec<(Preset, Tree)> = Vec::new();
    let saved = loaded.tree.take();
    let origin = loaded.origin();
    let all = if saved.is_none() { Preset::ALL } else { &[] };
    if let Some(tree) = saved {
        if args.presets.is_empty() {
            trees::warn_of_ignored(&origin.place, &args.tuning.given(), ui);
        }
        trees.push((tree.options().preset, trees::saved(origin.clone(), tree)?));
    }
    for &preset in if args.presets.is_empty() { all } else { &args.presets } {
        if trees.iter().all(|tree| tree.0 != preset) {
            let options = args.tuning.options(preset, None);
            trees.push((preset, trees::build(&origin, &loaded.scene.mesh, &options, ui)?));
        }
    }
    Ok(trees)
}
