//! The `slimkd-judge` command: every kernel against every other bit by bit, and their hits against an independent judge.

use anyhow::{Result, ensure};
use clap::Parser;
use rayon::prelude::*;
use slimkd::{BuildOptions, Hit, InstructionSet, KdTree, Preset, Ray, Tracer, TriangleMesh};
use slimkd_bench::args::Args as BenchArgs;
use slimkd_bench::peers::own::OwnTree;
use slimkd_bench::scene;
use slimkd_bench::truth::{Truth, Verdicts};
use slimkd_bench::workload::{Kind, Recipe, generate};
use std::process::ExitCode;

/// Rays of a batch.
const PIECE: usize = 4096;
/// Pixels along one side of the picture that tells how many camera rays hit something.
const PILOT: usize = 256;
/// Camera rays beyond what that picture says are needed.
const MARGIN: f64 = 1.01;
/// Pixels along one side of a picture, at most: 3 GB of rays.
const MOST: f64 = 10_000.0;

/// Traces rays of every kind through every kernel, with presets standard and slim. All must give the same hits, bit by
/// bit, and an independent judge in f64 must find none missing and none invented. See docs/testing.md.
#[derive(Debug, Parser)]
#[command(name = "slimkd-judge", version)]
struct Args {
    /// A scene file or the name of a built-in scene
    scene: String,
    /// Rays of each kind, at least: as many camera rays as it takes for that many to hit something
    #[arg(long, default_value_t = 10_000_000)]
    rays: usize,
    /// Seed of bounce and random rays
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

fn main() -> ExitCode {
    match work(&Args::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("slimkd-judge: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Whether all is right.
fn work(args: &Args) -> Result<bool> {
    ensure!(args.rays > 0, "--rays must be at least 1");
    let bench = BenchArgs::try_parse_from(["slimkd-judge", &args.scene])?;
    let scene = scene::open(&bench)?;
    let build = |preset| KdTree::build(scene.mesh.clone(), &BuildOptions::from(preset));
    let trees = [build(Preset::Standard)?, build(Preset::Slim)?];
    let own = OwnTree { tree: trees[0].clone(), isa: InstructionSet::best() };
    let view = scene::view(&bench, &scene, &trees[0])?;
    let recipe = Recipe { view, size: PILOT, random_rays: args.rays, seed: args.seed };
    let recipe = Recipe { size: picture_size(&scene.mesh, &own, &recipe)?, ..recipe };
    let truth = Truth::new(&scene.mesh);
    let mut right = true;
    println!("| scene | rays | traced | hits | kernels differ | borderline | invented | missing |");
    println!("|---|---|---|---|---|---|---|---|");
    for &kind in Kind::ALL {
        let rays = &generate(&scene.mesh, &own, &recipe, &[kind]).workloads[0].rays;
        let pieces = rays.par_chunks(PIECE).map(|rays| judge(&trees, &truth, kind, rays));
        let (differ, verdicts) = pieces.reduce(
            || (0, Verdicts::default()),
            |(a, mut all), (b, more)| {
                all += more;
                (a + b, all)
            },
        );
        right &= differ == 0 && verdicts.wrong() == 0;
        println!(
            "| {} | {} | {} | {} | {differ} | {} | {} | {} |",
            scene.name,
            kind.name(),
            verdicts.rays,
            verdicts.hits,
            verdicts.borderline,
            verdicts.invented,
            verdicts.missing
        );
    }
    Ok(right)
}

/// Pixels along one side of a picture on which enough camera rays hit something: shadow and bounce rays begin there.
fn picture_size(mesh: &TriangleMesh, tree: &OwnTree, pilot: &Recipe) -> Result<usize> {
    let rays = generate(mesh, tree, pilot, &[Kind::Primary]).workloads.swap_remove(0).rays;
    let hits = rays.iter().filter(|ray| tree.tree.any(ray)).count();
    ensure!(hits > 0, "the camera sees nothing of this scene");
    let needed = (MARGIN * pilot.random_rays as f64 * rays.len() as f64 / hits as f64).sqrt().ceil();
    ensure!(needed <= MOST, "the camera sees too little of this scene: name fewer rays");
    Ok(needed as usize)
}

/// Rays on which some kernel or preset differs from single rays through the first tree, and the verdicts on those.
fn judge(trees: &[KdTree], truth: &Truth<'_>, kind: Kind, rays: &[Ray]) -> (u64, Verdicts) {
    let mut verdicts = Verdicts::default();
    let mut differs = vec![false; rays.len()];
    let mut compare = |same: &mut dyn Iterator<Item = bool>| {
        differs.iter_mut().zip(same).for_each(|(differs, same)| *differs |= !same);
    };
    if kind.is_any() {
        let reference: Vec<bool> = rays.iter().map(|ray| trees[0].any(ray)).collect();
        let mut answers = vec![false; rays.len()];
        for tree in trees {
            compare(&mut rays.iter().zip(&reference).map(|(ray, answer)| tree.any(ray) == *answer));
            for batch in [tree.batch(), tree.batch().coherent()] {
                batch.any(rays, &mut answers);
                compare(&mut answers.iter().zip(&reference).map(|(a, b)| a == b));
            }
        }
        rays.iter().zip(&reference).for_each(|(ray, &blocked)| verdicts += truth.any(ray, blocked));
    } else {
        let reference: Vec<Option<Hit>> = rays.iter().map(|ray| trees[0].closest(ray)).collect();
        let mut answers = vec![None; rays.len()];
        for tree in trees {
            compare(&mut rays.iter().zip(&reference).map(|(ray, hit)| bits(&tree.closest(ray)) == bits(hit)));
            for batch in [tree.batch(), tree.batch().coherent()] {
                batch.closest(rays, &mut answers);
                compare(&mut answers.iter().zip(&reference).map(|(a, b)| bits(a) == bits(b)));
            }
        }
        rays.iter().zip(&reference).for_each(|(ray, &hit)| verdicts += truth.closest(ray, hit));
    }
    (differs.iter().filter(|&&differs| differs).count() as u64, verdicts)
}

fn bits(hit: &Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.triangle])
}
