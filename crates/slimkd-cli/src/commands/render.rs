//! `slimkd render`: a picture of a scene.

use crate::args::{CameraArgs, MoreScenes, SceneDetails, Size, TreeArgs, stops, within};
use crate::device::{self, Choice, Device};
use crate::failure::Failure;
use crate::output::Output;
use crate::trees::{self, Tree};
use crate::ui::{Ui, bytes, grouped};
use crate::{cameras, interrupt, scenes, ui};
use clap::{Args, ValueEnum};
use slimkd::{KdTree, Preset, Progress};
use slimkd_lab::measure::DeviceError;
use slimkd_render::{BitDepth, Development, Film, RenderError, RenderSettings, ToneMap, render};
use slimkd_scene::{Camera, Scene};
use std::fmt::Write;
use std::num::NonZeroU32;
use std::path::PathBuf;
use std::time::Instant;

/// What is rendered when nothing is named.
const DEFAULT_SCENE: &str = "kitchen";
/// How many triangles that gets: curves look smooth, and all presets are built within seconds.
const DEFAULT_TRIANGLES: NonZeroU32 = NonZeroU32::new(150_000).unwrap();

const EXAMPLES: &str = "\
Examples:
  slimkd render
  slimkd render model.glb -o model.png --size 1920x1080 --spp 16
  slimkd render building.ply.zst --up z --view 2 -o building.png
  slimkd render building.ply.zst --device gpu -o building.png
  slimkd render terrain.asc houses.city.json -o town.png
  slimkd render bart.ply --camera 1.05,1.14,1.36,0.97,1.12,1.32,40 --up z -o bart.exr";

/// Arguments of `slimkd render`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct RenderArgs {
    /// A scene file, a built-in scene's name, or a saved tree; without it, the built-in kitchen of 150,000 triangles and
    /// its tree's size under each preset
    #[arg(value_name = "SCENE|tree.skd")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    more: MoreScenes,
    #[command(flatten)]
    details: SceneDetails,
    /// The picture: .png, or .exr for linear light
    #[arg(short, long, value_name = "out.png", default_value = "out.png")]
    output: PathBuf,
    /// What renders it; a GPU's picture is the CPU's but for a pixel in a thousand
    #[arg(long, value_enum, default_value_t = Choice::Cpu)]
    device: Choice,
    #[command(flatten)]
    tree: TreeArgs,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    picture: PictureArgs,
}

/// Size and quality of a picture.
#[derive(Debug, Args)]
#[command(next_help_heading = "Picture")]
struct PictureArgs {
    /// Width and height in pixels, each 1 to 16384
    #[arg(long, value_name = "WxH", default_value = "1024x1024")]
    size: Size,
    /// Samples per pixel, 1 to 4096
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().samples, value_parser = within::<u32>(1..=4096))]
    spp: u32,
    /// How often a ray may be mirrored or refracted, 0 to 64
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().max_depth, value_parser = within::<u32>(0..=64))]
    bounces: u32,
    /// Ambient occlusion rays per visible point, 0 to 1024; 0 is none
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().occlusion, value_parser = within::<u32>(0..=1024))]
    occlusion: u32,
    /// Stops by which a .png is made brighter, or darker if negative, -100 to 100
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, value_parser = stops, allow_negative_numbers = true)]
    exposure: f32,
    /// How bright light is folded into what a .png can show
    #[arg(long, value_enum, default_value_t = Tone::Neutral)]
    tone: Tone,
    /// Bits per channel of a .png
    #[arg(long, value_enum, default_value_t = Bits::Eight)]
    bits: Bits,
}

/// A tone map.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Tone {
    /// Cut off
    Clamp,
    /// Reinhard's curve on luminance
    Reinhard,
    /// Khronos PBR Neutral
    Neutral,
}

/// Bits per channel.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Bits {
    #[value(name = "8")]
    Eight,
    #[value(name = "16")]
    Sixteen,
}

impl PictureArgs {
    fn settings(&self, threads: Option<std::num::NonZeroUsize>) -> RenderSettings {
        let mut settings = RenderSettings::sized(self.size.width, self.size.height);
        settings.samples = self.spp;
        settings.max_depth = self.bounces;
        settings.occlusion = self.occlusion;
        settings.threads = threads;
        settings
    }

    fn development(&self) -> Development {
        let tone_map = match self.tone {
            Tone::Clamp => ToneMap::Clamp,
            Tone::Reinhard => ToneMap::Reinhard,
            Tone::Neutral => ToneMap::Neutral,
        };
        Development { exposure: self.exposure, tone_map }
    }

    fn depth(&self) -> BitDepth {
        match self.bits {
            Bits::Eight => BitDepth::Eight,
            Bits::Sixteen => BitDepth::Sixteen,
        }
    }
}

/// Builds, renders, writes.
pub(crate) fn run(args: &RenderArgs, ui: Ui) -> Result<(), Failure> {
    args.tree.tuning.check()?;
    let output = Output::prepare(&args.output)?;
    Film::check_format(output.path()).map_err(Failure::usage)?;
    let inputs = args.scene.iter().flat_map(|scene| scenes::files(scene, &args.details));
    let output = output.apart_from(inputs.chain(args.more.more.iter().map(PathBuf::as_path)))?;
    let device = device::open(args.device, ui)?;
    let mut loaded = match &args.scene {
        Some(scene) => scenes::load_all(scene, &args.more.more, &args.details, ui)?,
        None if args.details.mesh.is_some() => {
            return Err(Failure::Usage("--mesh belongs to a saved tree; name that too".to_owned()));
        }
        None => scenes::built_in(DEFAULT_SCENE, args.details.triangles.or(Some(DEFAULT_TRIANGLES)), ui)?,
    };
    cameras::settle_up(&args.camera, &mut loaded.scene);
    let tree = if args.scene.is_some() {
        trees::take_or_build(&mut loaded, &args.tree, ui)?
    } else {
        compare_presets(&loaded, args, ui)?
    };
    trees::warn_of_degenerate(&tree, ui)?;

    let camera = cameras::choose(&args.camera, &loaded, &tree.tree, 1)?[0].1;
    let settings = args.picture.settings(args.tree.threads);
    let picture = Picture { place: &loaded.place, scene: &loaded.scene, tree: &tree.tree, camera, settings };
    let rendered = match &device {
        Some(device) => args.device.or_cpu(picture.on(device.as_ref(), ui)?, ui)?,
        None => None,
    };
    let (film, seconds) = match rendered {
        Some(rendered) => rendered,
        None => picture.on_the_cpu(ui)?,
    };
    interrupt::check()?;
    film.save(output.path(), &args.picture.development(), args.picture.depth()).map_err(Failure::work)?;
    ui.note(format_args!(
        "wrote {}: {} x {}, {} rays in {seconds:.2} s",
        args.output.display(),
        film.width(),
        film.height(),
        grouped(film.rays().total())
    ));
    Ok(())
}

/// What is rendered, wherever that is.
struct Picture<'a> {
    place: &'a str,
    scene: &'a Scene,
    tree: &'a KdTree,
    camera: Camera,
    settings: RenderSettings,
}

/// A picture, and the seconds that it took.
type Rendered = (Film, f64);

impl Picture<'_> {
    fn on_the_cpu(&self, ui: Ui) -> Result<Rendered, Failure> {
        let Self { scene, tree, camera, settings, .. } = self;
        let rendered = watched(ui, |progress| render(scene, tree, camera, &scene.lights, settings, progress));
        rendered.map_err(|error| self.failure(error))
    }

    /// The inner error is the device's.
    fn on(&self, device: &dyn Device, ui: Ui) -> Result<Result<Rendered, String>, Failure> {
        let Self { scene, tree, camera, settings, .. } = self;
        let rendered =
            watched(ui, |progress| Ok(device.scene(scene, tree)?.picture(camera, settings, progress)?.0));
        match rendered {
            Ok(rendered) => Ok(Ok(rendered)),
            Err(DeviceError::Render(error)) => Err(self.failure(error)),
            Err(error) => Ok(Err(error.to_string())),
        }
    }

    fn failure(&self, error: RenderError) -> Failure {
        let place = self.place;
        match error {
            RenderError::Cancelled => Failure::Interrupted,
            RenderError::Camera(error) => Failure::work(format_args!("{place}: {error} (--camera, --up)")),
            other => Failure::work(format_args!("{place}: {other}")),
        }
    }
}

fn watched<E>(ui: Ui, work: impl FnOnce(&Progress) -> Result<Film, E>) -> Result<Rendered, E> {
    let (progress, started) = (Progress::new(), Instant::now());
    let film = ui.watch("render", &progress, || work(&progress))?;
    Ok((film, started.elapsed().as_secs_f64()))
}

/// Builds the scene's tree under every preset, one after the other, shows how large each is, and keeps the one that
/// was asked for.
fn compare_presets(loaded: &scenes::Loaded, args: &RenderArgs, ui: Ui) -> Result<Tree, Failure> {
    let chosen = args.tree.preset.unwrap_or_default();
    let scene = &loaded.scene;
    let (mut kept, mut sizes) = (None, Vec::new());
    for &preset in Preset::ALL {
        let options = args.tree.options_of(preset);
        let tree = trees::build(&loaded.origin(), &scene.mesh, &options, ui)?;
        let nodes = &tree.statistics.nodes;
        let nodes = nodes.inner + nodes.t_inner + nodes.leaf;
        sizes.push((preset, nodes, tree.statistics.references(), tree.tree.memory().tree()));
        if preset == chosen {
            kept = Some(tree);
        }
    }
    if !ui.is_quiet() {
        ui::print(&size_table(scene, &sizes))?;
    }
    kept.ok_or_else(|| Failure::Usage(format!("preset {} is not among those compared", chosen.name())))
}

fn size_table(scene: &Scene, sizes: &[(Preset, u64, u64, u64)]) -> String {
    let triangles = scene.mesh.len() as u64;
    let standard = sizes.iter().find(|size| size.0 == Preset::Standard).map_or(0, |size| size.3);
    let mut out = format!("{}: {} triangles\n", scene.name, grouped(triangles));
    let _ = writeln!(
        out,
        "{:<12} {:>12} {:>12} {:>11} {:>11} {:>13}",
        "preset", "nodes", "references", "bytes", "B/triangle", "% of standard"
    );
    for &(preset, nodes, references, size) in sizes {
        let _ = writeln!(
            out,
            "{:<12} {:>12} {:>12} {:>11} {:>11.2} {:>13.1}",
            preset.name(),
            grouped(nodes),
            grouped(references),
            bytes(size),
            size as f64 / triangles.max(1) as f64,
            100.0 * size as f64 / standard.max(1) as f64
        );
    }
    out
}
