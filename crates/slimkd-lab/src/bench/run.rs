//! A run from the command line to the report.

use crate::basics::machine::Machine;
use crate::bench::agree::{DISTANCE, GRAZING, Judge, MARKED_SHARE, T_RELATIVE};
use crate::bench::args::Args;
use crate::bench::built::{Contender, Found, Info, Interface, Traced};
use crate::bench::measure::{Buffers, measure};
use crate::bench::peers::{self, STANDARD};
use crate::bench::report::*;
use crate::bench::scene;
use crate::workload::view::View;
use crate::workload::{LIFT, Rays, Recipe, TILE, Workload, generate};
use anyhow::{Context, Result};
use slimkd::{Ray, TriangleMesh};
use slimkd_scene::Scene;
use slimkd_util::alloc::{Counted, count};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

/// A contender that stands.
struct Entrant {
    info: Info,
    traced: Box<dyn Traced>,
    counted: Counted,
    builds: Vec<Build>,
}

/// Does all that `args` asks for. `say` hears what is going on.
pub fn run(args: &Args, say: &mut dyn FnMut(&str)) -> Result<Report> {
    args.validate()?;
    let scene = scene::open(args)?;
    let threads = args.thread_counts();
    let mut skipped = Vec::new();
    let mut entrants = Vec::new();
    let mesh = peers::finite(&scene.mesh);

    let (others, absent) = peers::others(args.embree.as_deref(), args.instruction_set());
    let absent = absent.into_iter().filter(|absent| args.wants_peer(&absent.name));
    skipped.extend(absent.map(|absent| Skipped { name: absent.name, reason: absent.reason }));
    let own = peers::slimkd(args.own_trees()?, args.instruction_set())
        .into_iter()
        .map(|contender| (contender, &scene.mesh));
    let others = others.into_iter().map(|contender| (contender, &mesh));
    for (contender, mesh) in
        own.chain(others.filter(|(contender, _)| args.wants_peer(&contender.info().name)))
    {
        let info = contender.info();
        say(&format!("building {}", info.name));
        match enter(contender.as_ref(), info.clone(), mesh, &threads, args) {
            Ok(entrant) => entrants.push(entrant),
            Err(reason) => skipped.push(Skipped { name: info.name, reason }),
        }
    }
    let reference = entrants.first().filter(|e| e.info.name == STANDARD);
    let reference = reference.with_context(|| format!("{STANDARD} was not built: {}", reasons(&skipped)))?;

    let tree = reference.traced.kd_tree().context("the reference is not slimkd's")?;
    let view = scene::view(args, &scene, tree)?;
    let recipe = Recipe::picture(view, args.size, args.random_rays, args.seed);
    let closest = |rays: &[Ray], found: &mut [Found]| reference.traced.closest(rays, found);
    let rays = generate(&scene.mesh, &closest, &recipe, &args.workloads);

    say("comparing hits");
    let expected = Expected::new(reference.traced.as_ref(), &rays.workloads);
    let judge = Judge::new(&scene.mesh);
    let mut reports = Vec::new();
    let mut kept: Vec<Entrant> = Vec::new();
    for entrant in entrants {
        // The first one is the reference itself.
        let base = kept.first().map_or(entrant.traced.as_ref(), |first| first.traced.as_ref());
        let checked = catch_unwind(AssertUnwindSafe(|| check(&entrant, base, &rays, &expected, &judge)));
        match checked {
            Ok(report) => {
                reports.push(report);
                kept.push(entrant);
            }
            Err(panic) => {
                let reason = format!("panicked while tracing: {}", panic_text(panic.as_ref()));
                skipped.push(Skipped { name: entrant.info.name, reason });
            }
        }
    }

    let traced: Vec<&dyn Traced> = kept.iter().map(|entrant| entrant.traced.as_ref()).collect();
    let mut tell = |round| say(&format!("round {} of {}", round + 1, args.rounds));
    let wanted = |interface| args.wants_interface(interface);
    let series = measure(&traced, &rays.workloads, &threads, args.rounds, wanted, &mut tell)?;
    let mut measurements: Vec<Measurement> = series
        .into_iter()
        .map(|s| {
            let workload = &rays.workloads[s.workload];
            Measurement::new(
                &kept[s.contender].info.name,
                s.interface.name(),
                workload.kind.name(),
                s.threads,
                workload.rays.len() as u64,
                s.seconds,
            )
        })
        .collect();
    Measurement::fill_ratios(&mut measurements);
    Ok(Report {
        schema: SCHEMA,
        tool: concat!("slimkd-bench ", env!("CARGO_PKG_VERSION")).into(),
        machine: Machine::here(),
        settings: settings(args, threads, view, rays.lights[0]),
        scene: scene_report(args, &scene),
        workloads: rays.workloads.iter().zip(&expected.0).map(workload_report).collect(),
        points: points(&reports, &measurements),
        contenders: reports,
        skipped,
        measurements,
    })
}

fn reasons(skipped: &[Skipped]) -> String {
    skipped.iter().find(|s| s.name == STANDARD).map_or_else(String::new, |s| s.reason.clone())
}

/// Builds a contender at every number of threads. The last build stays; its allocations are counted, and at the smallest
/// number of threads counting disturbs least.
fn enter(
    contender: &dyn Contender,
    info: Info,
    mesh: &Arc<TriangleMesh>,
    threads: &[usize],
    args: &Args,
) -> Result<Entrant, String> {
    if let Some(reason) = contender.too_slow(mesh).filter(|_| !args.all) {
        return Err(reason);
    }
    let counts: Vec<usize> = match contender.threads_controllable() {
        true => threads.iter().rev().copied().collect(),
        false => threads.iter().max().copied().into_iter().collect(),
    };
    let mut builds = Vec::new();
    let mut last = None;
    for &n in &counts {
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(n).build().map_err(|error| error.to_string())?;
        let mut seconds = Vec::new();
        for _ in 0..args.builds {
            drop(last.take());
            let build = || {
                let start = Instant::now();
                let built = catch_unwind(AssertUnwindSafe(|| pool.install(|| contender.build(mesh, n))));
                (built, start.elapsed().as_secs_f64())
            };
            let is_last_count = counts.last() == Some(&n);
            let ((built, elapsed), counted) =
                if is_last_count { count(build) } else { (build(), Counted::default()) };
            let built = built
                .map_err(|panic| format!("panicked while building: {}", panic_text(panic.as_ref())))??;
            seconds.push(elapsed);
            last = Some((built, counted));
        }
        builds.push(Build { threads: contender.threads_controllable().then_some(n), seconds });
    }
    builds.reverse();
    let (traced, counted) = last.ok_or("no thread count")?;
    Ok(Entrant { info, traced, counted, builds })
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
    text.lines().next().unwrap_or_default().to_owned()
}

/// The reference's answers by workload: closest hits, or for any-hit ones whether each is blocked.
struct Expected(Vec<(Vec<Found>, Vec<bool>)>);

impl Expected {
    fn new(reference: &dyn Traced, workloads: &[Workload]) -> Self {
        Self(workloads.iter().map(|workload| answers(reference, Interface::Single, workload)).collect())
    }
}

fn answers(traced: &dyn Traced, interface: Interface, workload: &Workload) -> (Vec<Found>, Vec<bool>) {
    let mut buffers = Buffers::new(workload.rays.len());
    if workload.kind.is_any() {
        (Vec::new(), buffers.any(traced, interface, &workload.rays).to_vec())
    } else {
        (buffers.closest(traced, interface, &workload.rays).to_vec(), Vec::new())
    }
}

fn check(
    entrant: &Entrant,
    reference: &dyn Traced,
    rays: &Rays,
    expected: &Expected,
    judge: &Judge<'_>,
) -> ContenderReport {
    let traced = entrant.traced.as_ref();
    let mut identical = true;
    let mut agreement = Vec::new();
    for (workload, (closest, any)) in rays.workloads.iter().zip(&expected.0) {
        for &interface in traced.interfaces().iter().filter(|i| i.takes(workload.kind)) {
            let (found, blocked) = answers(traced, interface, workload);
            identical &= found == *closest && blocked == *any;
            let counts = if workload.kind.is_any() {
                judge.any(&workload.rays, (reference, traced), any, &blocked)
            } else {
                judge.closest(&workload.rays, closest, &found)
            };
            agreement.push(WorkloadAgreement {
                workload: workload.kind.name().into(),
                interface: interface.name().into(),
                agreement: counts,
            });
        }
    }
    let info = entrant.info.clone();
    ContenderReport {
        marked: agreement.iter().any(|a| a.agreement.is_marked()),
        identical: (info.library == "slimkd").then_some(identical),
        name: info.name,
        library: info.library.into(),
        version: info.version,
        settings: info.settings,
        sah: info.sah,
        bytes: ByteReport::new(traced.bytes(entrant.counted.live), entrant.counted),
        builds: entrant.builds.clone(),
        agreement,
    }
}

fn settings(args: &Args, threads: Vec<usize>, view: View, light: [f32; 3]) -> Settings {
    Settings {
        size: args.size,
        random_rays: args.random_rays,
        rounds: args.rounds,
        builds: args.builds,
        threads,
        seed: args.seed,
        isa: args.instruction_set().unwrap_or(slimkd::InstructionSet::best()).name().into(),
        view,
        light,
        lift: LIFT,
        tile: TILE,
        t_relative: T_RELATIVE,
        distance: DISTANCE,
        grazing: GRAZING,
        marked_share: MARKED_SHARE,
    }
}

fn scene_report(args: &Args, scene: &Scene) -> SceneReport {
    SceneReport {
        name: scene.name.clone(),
        source: args.scene.clone(),
        triangles: scene.mesh.len() as u64,
        vertices: scene.mesh.vertices().len() as u64,
        mesh_bytes: scene.mesh.memory_bytes(),
    }
}

fn workload_report((workload, (closest, any)): (&Workload, &(Vec<Found>, Vec<bool>))) -> WorkloadReport {
    let hits = closest.iter().filter(|found| found.is_hit()).count() + any.iter().filter(|&&b| b).count();
    WorkloadReport {
        name: workload.kind.name().into(),
        kind: if workload.kind.is_any() { "any" } else { "closest" }.into(),
        rays: workload.rays.len() as u64,
        hits: hits as u64,
    }
}
