//! `slimkd trace`: rays from a file, hits to a file, a batch at a time.

use crate::args::{Kind, MoreScenes, SceneArgs, TreeArgs};
use crate::device::{self, Choice, Tracer};
use crate::failure::Failure;
use crate::interrupt;
use crate::output::{Output, unwritable};
use crate::rays::{BATCH, RayFile, Rays, encode_any, encode_closest};
use crate::ui::{Ui, grouped};
use crate::{saved, scenes, trees};
use clap::Args;
use memmap2::Mmap;
use rayon::prelude::*;
use slimkd::{Hit, KdTree, OpenTree, Progress, Ray, RayF64};
use slimkd_lab::measure::rates::Kernel;
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

/// Rays that a thread takes at a time: long enough to hide the cost of sharing out, short enough to even out.
const CHUNK: usize = 1024;

const EXAMPLES: &str = "\
Examples:
  slimkd trace building.ply.zst --rays rays.f32 --out hits.bin
  slimkd trace building.skd --rays rays.f32 --out hits.bin --device gpu
  slimkd trace building.skd --rays rays.f32 --out hits.bin --kind any --threads 4
  slimkd trace huge.skd --rays few.f32 --out hits.bin --no-verify
  slimkd trace town-in-utm.obj --rays rays.f64 --out hits.bin

Rays: little-endian f32 x 8 each, ox oy oz t_min dx dy dz t_max, in the coordinates of the \
scene's file; in a file that ends in .f64 little-endian f64. Those are decided in f64, as are all \
rays of a scene that has an origin (--origin).
Hits: 16 bytes each, t f32 (+inf on a miss), triangle u32 (0xFFFFFFFF on a miss), u f32, \
v f32; with --kind any, t is 0 on a hit and only \"hit or not\" counts.";

/// Arguments of `slimkd trace`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct TraceArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    more: MoreScenes,
    /// The rays to trace
    #[arg(long, value_name = "rays.f32|rays.f64")]
    rays: PathBuf,
    /// Where the hits go, in the order of the rays
    #[arg(long, value_name = "hits.bin")]
    out: PathBuf,
    /// What is asked of each ray
    #[arg(long, value_enum, default_value_t = Kind::Closest)]
    kind: Kind,
    /// How rays are traced; the hits are the same with all. Rays in f64 go one by one
    #[arg(long, value_enum, default_value_t = Kernel::Single)]
    kernel: Kernel,
    /// Trace a saved tree where it lies, ready at once: it is not proved sound, every access is checked instead, and a ray
    /// takes longer. Its mesh must be inside. Excludes --mesh, --triangles, --kernel and --device
    #[arg(long, conflicts_with_all = ["mesh", "triangles", "kernel", "device"])]
    no_verify: bool,
    /// What traces them; a GPU's t may differ in its last bits
    #[arg(long, value_enum, default_value_t = Choice::Cpu)]
    device: Choice,
    #[command(flatten)]
    tree: TreeArgs,
}

/// Traces the file.
pub(crate) fn run(args: &TraceArgs, ui: Ui) -> Result<(), Failure> {
    args.device.check(args.kernel)?;
    args.tree.tuning.check()?;
    let SceneArgs { scene, details } = &args.scene;
    let inputs = scenes::files(scene, details)
        .chain([args.rays.as_path()])
        .chain(args.more.more.iter().map(PathBuf::as_path));
    let output = Output::prepare(&args.out)?.apart_from(inputs)?;
    let mut input = RayFile::open(&args.rays)?;
    let device = device::open(args.device, ui)?;
    let tree = Source::of(args, ui)?;
    let in_f64 = input.is_f64() || tree.tracer().origin() != [0.0; 3];
    if in_f64 && args.device == Choice::Gpu {
        let what =
            "only the CPU traces in f64, as rays.f64 and scenes with an --origin need; leave out --device";
        return Err(Failure::Usage(format!("{}: {what}", args.scene.scene.display())));
    }
    let gpu = match (&tree, &device) {
        (Source::Proved(tree), Some(device)) if !in_f64 => args.device.or_cpu(device.tree(tree), ui)?,
        _ => None,
    };
    let pool = trees::pool(trees::thread_count(args.tree.threads))?;
    // Ctrl-C is looked at between batches.
    let progress = Progress::new();
    let (mut rays, mut hits) = (0, 0);
    let started = Instant::now();
    ui.watch("trace", &progress, || {
        let mut draft = output.draft()?;
        let mut buffers = Buffers::default();
        loop {
            interrupt::check()?;
            input.next_batch(&mut buffers.rays)?;
            if buffers.rays.len() == 0 {
                return draft.commit();
            }
            let found = match &gpu {
                Some(gpu) => buffers.trace_on(gpu.as_ref(), args.kind)?,
                None => pool.install(|| buffers.trace(&tree, args.kernel, args.kind, in_f64))?,
            };
            let bytes = buffers.records.as_flattened();
            draft.write_all(bytes).map_err(|error| unwritable(output.path(), &error))?;
            rays += buffers.rays.len() as u64;
            hits += found;
            progress.set(rays as f64 / input.count().unwrap_or(0).max(1) as f64);
        }
    })?;
    let seconds = started.elapsed().as_secs_f64();
    ui.note(format_args!(
        "{} rays, {} hits ({:.1} %), {seconds:.2} s; wrote {}",
        grouped(rays),
        grouped(hits),
        100.0 * hits as f64 / rays.max(1) as f64,
        args.out.display()
    ));
    Ok(())
}

/// What is traced.
enum Source {
    Proved(Box<KdTree>),
    Open(Box<OpenTree<Mmap>>),
}

impl Source {
    fn tracer(&self) -> &dyn slimkd::Tracer {
        match self {
            Self::Proved(tree) => &**tree,
            Self::Open(tree) => &**tree,
        }
    }

    fn of(args: &TraceArgs, ui: Ui) -> Result<Self, Failure> {
        let scene = &args.scene.scene;
        if args.no_verify {
            if !saved::is_saved(scene) || !args.more.more.is_empty() {
                let what = "only a saved tree can be traced with --no-verify; leave it out";
                return Err(Failure::Usage(format!("{}: {what}", scene.display())));
            }
            let tree = saved::map(scene)?;
            trees::warn_of_ignored(&scene.display().to_string(), &args.tree.given(), ui);
            return Ok(Self::Open(Box::new(tree)));
        }
        let mut loaded = scenes::load_all(scene, &args.more.more, &args.scene.details, ui)?;
        let tree = trees::take_or_build(&mut loaded, &args.tree, ui)?;
        trees::warn_of_degenerate(&tree, ui)?;
        Ok(Self::Proved(Box::new(tree.tree)))
    }
}

/// One batch on its way through.
#[derive(Default)]
struct Buffers {
    rays: Rays,
    records: Vec<[u8; 16]>,
}

impl Buffers {
    /// Fills the records of the batch's rays; returns how many hit.
    fn trace(&mut self, tree: &Source, kernel: Kernel, kind: Kind, in_f64: bool) -> Result<u64, Failure> {
        debug_assert!(self.rays.len() <= BATCH);
        self.records.resize(self.rays.len(), [0; 16]);
        let (tracer, records) = (tree.tracer(), self.records.par_chunks_mut(CHUNK));
        let found = match &self.rays {
            Rays::F32(rays) if !in_f64 => {
                let chunks = rays.par_chunks(CHUNK).zip(records);
                chunks.map(|(rays, records)| trace_chunk(tracer, kernel, kind, rays, records)).sum()
            }
            Rays::F32(rays) => {
                let chunks = rays.par_chunks(CHUNK).zip(records);
                chunks
                    .map(|(rays, records)| trace_in_f64(tracer, kind, rays.iter().map(widened), records))
                    .sum()
            }
            Rays::F64(rays) => {
                let chunks = rays.par_chunks(CHUNK).zip(records);
                chunks.map(|(rays, records)| trace_in_f64(tracer, kind, rays.iter().copied(), records)).sum()
            }
        };
        if let Source::Open(tree) = tree {
            tree.check().map_err(Failure::work)?;
        }
        Ok(found)
    }

    /// The same on a GPU.
    fn trace_on(&mut self, gpu: &dyn Tracer, kind: Kind) -> Result<u64, Failure> {
        // No others come this way.
        let Rays::F32(rays) = &self.rays else { return Ok(0) };
        let mut closest = vec![None; if kind == Kind::Closest { self.rays.len() } else { 0 }];
        let mut any = vec![false; if kind == Kind::Any { self.rays.len() } else { 0 }];
        match kind {
            Kind::Closest => gpu.closest(rays, &mut closest),
            Kind::Any => gpu.any(rays, &mut any),
        }
        .map_err(Failure::work)?;
        self.records.clear();
        self.records.extend(closest.iter().map(|&hit| encode_closest(hit)));
        self.records.extend(any.iter().map(|&hit| encode_any(hit)));
        Ok(closest.iter().flatten().count() as u64 + any.iter().filter(|&&hit| hit).count() as u64)
    }
}

fn trace_chunk(
    tree: &dyn slimkd::Tracer,
    kernel: Kernel,
    kind: Kind,
    rays: &[Ray],
    records: &mut [[u8; 16]],
) -> u64 {
    let mut found = 0;
    match kind {
        Kind::Closest => {
            let mut hits = [None; CHUNK];
            kernel.closest(tree, rays, &mut hits[..rays.len()]);
            for (record, hit) in records.iter_mut().zip(hits) {
                found += u64::from(hit.is_some());
                *record = encode_closest(hit);
            }
        }
        Kind::Any => {
            let mut hits = [false; CHUNK];
            kernel.any(tree, rays, &mut hits[..rays.len()]);
            for (record, hit) in records.iter_mut().zip(hits) {
                found += u64::from(hit);
                *record = encode_any(hit);
            }
        }
    }
    found
}

/// A ray of f32 in f64, without any rounding.
fn widened(ray: &Ray) -> RayF64 {
    RayF64 {
        origin: ray.origin.map(f64::from),
        t_min: ray.t_min.into(),
        direction: ray.direction.map(f64::from),
        t_max: ray.t_max.into(),
    }
}

/// The same for rays in coordinates of the world.
fn trace_in_f64(
    tree: &dyn slimkd::Tracer,
    kind: Kind,
    rays: impl Iterator<Item = RayF64>,
    records: &mut [[u8; 16]],
) -> u64 {
    let mut found = 0;
    for (ray, record) in rays.zip(records) {
        let is_hit = match kind {
            Kind::Closest => {
                let hit = tree.closest_f64(&ray).map(Hit::from);
                *record = encode_closest(hit);
                hit.is_some()
            }
            Kind::Any => {
                let hit = tree.any_f64(&ray);
                *record = encode_any(hit);
                hit
            }
        };
        found += u64::from(is_hit);
    }
    found
}
