//! `slimkd report`: the paper's experiments on any scene, as a page.

use crate::args::{CameraArgs, SceneDetails, Size, threads, triangles};
use crate::device::{self, Choice, Pictures};
use crate::failure::Failure;
use crate::ui::{Ui, Watched};
use crate::{cameras, scenes};
use clap::Args;
use slimkd_report::data::Options;
use slimkd_report::measure::Session;
use slimkd_report::{Progress, ReportError, output};
use std::num::{NonZeroU32, NonZeroUsize};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What is measured when nothing is named.
const DEFAULT_SCENE: &str = "kitchen";
/// Of the very large scene, where no number is given: the paper's.
const VERY_LARGE: &str = "38200000";
/// The built-in scene that can be very large.
const VERY_LARGE_SCENE: &str = "power-plant";

const EXAMPLES: &str = "\
Examples:
  slimkd report --quick -o report
  slimkd report building.ply.zst sponza.obj -o report
  slimkd report building.ply.zst -o report --time-limit 600      again and again, until it is done
  slimkd report kitchen --triangles 500000 -o report --size 512x512 --threads 1,8
  slimkd report building.ply.zst -o report --peers peers.json    of slimkd-bench --json
  slimkd report building.ply.zst -o report --device gpu          frame rates on the GPU too
  slimkd report --from report/raw.json -o again                  nothing is measured

DIR gets index.html (one file, no network), raw.json, tables/*.csv, plots/*.svg and pictures/.
What was measured is kept in DIR/measured: the same command goes on where an earlier one was
interrupted. For other measurements of the same, take another DIR.";

/// Arguments of `slimkd report`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ReportArgs {
    /// Scene files, or built-in scenes' names; the built-in kitchen unless given
    #[arg(value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// Folder of the report
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// How many triangles built-in scenes get
    #[arg(long, value_name = "N", value_parser = triangles)]
    triangles: Option<NonZeroU32>,
    /// Fewer and smaller measurements: a look at what a report is like
    #[arg(long)]
    quick: bool,
    /// Edge of the pictures whose rates are measured, pixels; 1024x1024 as in the paper unless given, or quick
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Rounds that medians of rates are taken of; 5 unless given, or quick
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(3..=1000))]
    rounds: Option<u32>,
    /// Thread counts to build and render with; 1 and all cores unless given
    #[arg(long, value_name = "N,M,...", value_delimiter = ',', value_parser = threads)]
    threads: Vec<NonZeroUsize>,
    /// Measure frame rates on a GPU too; auto does where there is one in hardware
    #[arg(long, value_enum, default_value_t = Choice::Auto)]
    device: Choice,
    /// Largest scene of the curve of build times; 0 leaves it out
    #[arg(long, value_name = "N")]
    scaling: Option<u32>,
    /// Adds the built-in power plant of N triangles as the very large scene: 38.2 million takes 14 GB and twenty minutes
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = VERY_LARGE, value_parser = triangles)]
    very_large: Option<NonZeroU32>,
    /// Comparisons with other libraries, written by slimkd-bench --json
    #[arg(long, value_name = "FILE")]
    peers: Vec<PathBuf>,
    /// Begin no measurement after that many seconds; the same command goes on from there. Ends with status 1 while any is left
    #[arg(long, value_name = "SECONDS")]
    time_limit: Option<u32>,
    /// Write page, tables and plots from raw measurements, and measure nothing
    #[arg(long, value_name = "raw.json", conflicts_with_all = ["scenes", "quick", "size", "rounds", "threads", "device", "scaling",
        "very_large", "peers", "time_limit", "triangles"])]
    from: Option<PathBuf>,
}

impl Watched for Progress {
    fn fraction(&self) -> f64 {
        self.fraction()
    }

    fn cancel(&self) {
        self.cancel();
    }
}

/// Measures what is missing, and writes.
pub(crate) fn run(args: &ReportArgs, ui: Ui) -> Result<(), Failure> {
    if let Some(raw) = &args.from {
        let value = output::read_raw(raw).map_err(failure)?;
        let pictures = raw.parent().unwrap_or(Path::new("."));
        output::render(&args.output, pictures, &value).map_err(failure)?;
        ui.note(format_args!("wrote {}", args.output.join(output::PAGE).display()));
        return Ok(());
    }
    let options = args.options()?;
    let peers = args.peers.iter().map(|path| output::read_peers(path).map_err(failure));
    let peers = peers.collect::<Result<Vec<_>, _>>()?;
    let progress = Progress::new();
    let limit = args.time_limit.map(|seconds| Duration::from_secs(seconds.into()));
    let device = device::open(args.device, ui)?;
    let mut session = Session::new(&args.output, &options, limit, &progress).map_err(failure)?;
    if let Some(device) = &device {
        let optional = args.device == Choice::Auto;
        session.add_device(Box::new(Pictures { device: device.as_ref(), optional }));
    }
    let mut measured = Vec::new();
    let default = [PathBuf::from(DEFAULT_SCENE)];
    let scenes = if args.scenes.is_empty() { &default[..] } else { &args.scenes };
    for scene in scenes {
        measured.push(measure(&session, &progress, scene, args.triangles, false, ui)?);
    }
    if args.very_large.is_some() {
        let scene = Path::new(VERY_LARGE_SCENE);
        measured.push(measure(&session, &progress, scene, args.very_large, true, ui)?);
    }
    let scaling = ui.watch("builds", &progress, || session.scaling()).map_err(failure)?;
    let mut raw = session.raw(measured, scaling);
    raw.peers = peers;
    output::write_all(&args.output, &raw).map_err(failure)?;
    ui.note(format_args!("wrote {}", args.output.join(output::PAGE).display()));
    Ok(())
}

fn measure(
    session: &Session<'_>,
    progress: &Progress,
    path: &Path,
    triangles: Option<NonZeroU32>,
    very_large: bool,
    ui: Ui,
) -> Result<slimkd_report::data::Scene, Failure> {
    let built_in = path.to_str().is_some_and(|name| slimkd_scene::procedural::find(name).is_some());
    let details = SceneDetails { triangles: triangles.filter(|_| built_in), mesh: None };
    let mut loaded = scenes::load(path, &details, ui)?;
    if loaded.tree.is_some() {
        let what = "a report builds trees of its own; give the scene that this one was built from";
        return Err(Failure::at(path, what));
    }
    if loaded.scene.mesh.is_empty() {
        return Err(Failure::at(
            path,
            "there is no triangle in it; export the scene's surfaces as triangles",
        ));
    }
    cameras::settle_up(&CameraArgs::default(), &mut loaded.scene);
    let name = loaded.scene.name.clone();
    ui.watch(&name, progress, || session.scene(&loaded.scene, very_large)).map_err(failure)
}

fn failure(error: ReportError) -> Failure {
    match error {
        ReportError::Cancelled => Failure::Interrupted,
        error => Failure::work(error),
    }
}

impl ReportArgs {
    fn options(&self) -> Result<Options, Failure> {
        let mut counts: Vec<_> = self.threads.iter().map(|count| count.get()).collect();
        if counts.is_empty() {
            counts = vec![1, rayon::current_num_threads()];
        }
        counts.dedup();
        let mut options = if self.quick { Options::quick(counts) } else { Options::full(counts) };
        if let Some(size) = self.size {
            if size.width != size.height {
                return Err(Failure::Usage(
                    "--size: a report's pictures are square, as in 512x512".to_owned(),
                ));
            }
            options.frame_edge = size.width;
        }
        if let Some(rounds) = self.rounds {
            options.rounds = rounds as usize;
        }
        if let Some(most) = self.scaling {
            options.scaling.retain(|&size| size <= most);
        }
        Ok(options)
    }
}
