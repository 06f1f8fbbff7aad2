//! `slimkd report`: the paper's experiments on any scene, as a page.

use crate::args::{CameraArgs, FileDetails, SceneDetails, Size, threads, triangles, within};
use crate::device::{self, Choice, Pictures};
use crate::failure::Failure;
use crate::output::{is_same, overwritten};
use crate::saved::is_saved;
use crate::ui::Ui;
use crate::{cameras, scenes};
use clap::Args;
use slimkd_lab::measure::Session;
use slimkd_lab::schema::{Options, Peers};
use slimkd_lab::{Progress, ReportError, report::output};
use std::num::{NonZeroU32, NonZeroUsize};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What is measured when nothing is named.
const DEFAULT_SCENE: &str = "kitchen";
/// Where measurements are kept, below the report's folder.
const MEASURED: &str = "measured";
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
What was measured is kept in DIR/measured: the same command goes on where an earlier one was \
interrupted. For other measurements of the same, take another DIR.";

/// Arguments of `slimkd report`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ReportArgs {
    /// Scene files, or built-in scenes' names, each measured for itself; the built-in kitchen unless given
    #[arg(value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// Folder of the report
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// How many triangles built-in scenes get, 1 to 100000000
    #[arg(long, value_name = "N", value_parser = triangles)]
    triangles: Option<NonZeroU32>,
    #[command(flatten)]
    files: FileDetails,
    /// Fewer and smaller measurements: a look at what a report is like
    #[arg(long)]
    quick: bool,
    /// Width and height of the pictures whose rates are measured, square, each 1 to 16384; 1024x1024 as in the paper
    /// unless given, or quick
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Rounds that medians of rates are taken of, 3 to 1000; 5 unless given, or quick
    #[arg(long, value_name = "N", value_parser = within::<u32>(3..=1000))]
    rounds: Option<u32>,
    /// Thread counts to build and render with, 1 to 1024; 1 and all cores unless given
    #[arg(long, value_name = "N,M,...", value_delimiter = ',', value_parser = threads)]
    threads: Vec<NonZeroUsize>,
    /// Measure frame rates on a GPU too; auto does where there is one in hardware
    #[arg(long, value_enum, default_value_t = Choice::Auto)]
    device: Choice,
    /// Triangles of the largest scene of the curve of build times, 0 to 4294967295; 0 leaves it out
    #[arg(long, value_name = "N", value_parser = within::<u32>(0..=u32::MAX))]
    scaling: Option<u32>,
    /// Adds the built-in power plant of N triangles as the very large scene: 38.2 million unless given, which take about
    /// 14 GB, 10 to 20 minutes
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = VERY_LARGE, value_parser = triangles)]
    very_large: Option<NonZeroU32>,
    /// Comparisons with other libraries, written by slimkd-bench --json
    #[arg(long, value_name = "FILE")]
    peers: Vec<PathBuf>,
    /// Begin no measurement after that many seconds, 0 to 4294967295; the same command goes on from there. Ends with status 1 while any is left
    #[arg(long, value_name = "SECONDS", value_parser = within::<u32>(0..=u32::MAX))]
    time_limit: Option<u32>,
    /// Write page, tables and plots from raw measurements, and measure nothing
    #[arg(long, value_name = "raw.json", conflicts_with_all = ["scenes", "quick", "size", "rounds", "threads", "device", "scaling",
        "very_large", "peers", "time_limit", "triangles", "allow_outside", "scene_index", "origin"])]
    from: Option<PathBuf>,
}

/// Measures what is missing, and writes.
pub(crate) fn run(args: &ReportArgs, ui: Ui) -> Result<(), Failure> {
    check_inputs(args)?;
    if let Some(raw) = &args.from {
        let value = output::read_raw(raw)
            .map_err(|error| unread(error, "give --from the raw.json in a report's folder"))?;
        let pictures = raw.parent().unwrap_or(Path::new("."));
        output::render(&args.output, pictures, &value).map_err(failure)?;
        ui.note(format_args!("wrote {}", args.output.join(output::PAGE).display()));
        return Ok(());
    }
    let options = args.options()?;
    let unread = |error| unread(error, "give --peers a file that `slimkd-bench --json` wrote");
    let peers = args.peers.iter().map(|path| output::read_peers(path).map_err(unread));
    let peers = peers.collect::<Result<Vec<_>, _>>()?;
    let is_new = [args.output.join(MEASURED), args.output.clone()].map(|folder| (!folder.exists(), folder));
    let written = write(args, &options, peers, ui);
    if written.is_err() {
        // Whoever mistyped a name shall not have to clean up; what holds a measurement stays.
        for (_, folder) in is_new.iter().filter(|(is_new, _)| *is_new) {
            let _ = std::fs::remove_dir(folder);
        }
    }
    written
}

/// Measures what is missing into the folder, and writes the report there.
fn write(args: &ReportArgs, options: &Options, peers: Vec<Peers>, ui: Ui) -> Result<(), Failure> {
    let progress = Progress::new();
    let limit = args.time_limit.map(|seconds| Duration::from_secs(seconds.into()));
    let device = device::open(args.device, ui)?;
    let mut session = Session::new(&args.output, options, limit, &progress).map_err(failure)?;
    if let Some(device) = &device {
        let optional = args.device == Choice::Auto;
        session.add_device(Box::new(Pictures { device: device.as_ref(), optional }));
    }
    let mut measured = Vec::new();
    for scene in &args.scenes() {
        measured.push(measure(&session, &progress, scene, args.triangles, args.files.clone(), false, ui)?);
    }
    if args.very_large.is_some() {
        let scene = Path::new(VERY_LARGE_SCENE);
        measured.push(measure(
            &session,
            &progress,
            scene,
            args.very_large,
            FileDetails::default(),
            true,
            ui,
        )?);
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
    files: FileDetails,
    very_large: bool,
    ui: Ui,
) -> Result<slimkd_lab::schema::Scene, Failure> {
    let details =
        SceneDetails { triangles: triangles.filter(|_| scenes::find(path).is_some()), mesh: None, files };
    let mut loaded = scenes::load(path, &details, ui)?;
    scenes::check_triangles(&loaded, ui)?;
    cameras::settle_up(&CameraArgs::default(), &mut loaded.scene);
    let name = loaded.scene.name.clone();
    ui.watch(&name, progress, || session.scene(&loaded.scene, very_large)).map_err(failure)
}

/// Refuses what can be seen before anything is measured or made: one wrong name must not cost the measurements before it.
fn check_inputs(args: &ReportArgs) -> Result<(), Failure> {
    let scenes = args.scenes();
    for path in scenes.iter().filter(|_| args.from.is_none()) {
        if is_saved(path) {
            let what = "a report builds trees of its own; give the scene that this one was built from";
            return Err(Failure::at(path, what));
        }
        scenes::check(path)?;
    }
    // With --from, the raw measurements stay as they are.
    let written = if args.from.is_none() { &[output::RAW, output::PAGE][..] } else { &[output::PAGE] };
    for path in written.iter().map(|name| args.output.join(name)) {
        if let Some(input) = args.peers.iter().chain(&args.from).find(|input| is_same(&path, input)) {
            return Err(overwritten(&path, input));
        }
    }
    Ok(())
}

fn failure(error: ReportError) -> Failure {
    match error {
        ReportError::Cancelled => Failure::Interrupted,
        error => unread(error, "choose another folder with -o"),
    }
}

/// The error for a file; `fix` where it says nothing of the kind.
fn unread(error: ReportError, fix: &str) -> Failure {
    match error {
        ReportError::File { path, reason } if !reason.contains("; ") => {
            Failure::at(&path, format_args!("{reason}; {fix}"))
        }
        error => Failure::work(error),
    }
}

impl ReportArgs {
    fn scenes(&self) -> Vec<PathBuf> {
        if self.scenes.is_empty() { vec![DEFAULT_SCENE.into()] } else { self.scenes.clone() }
    }

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
