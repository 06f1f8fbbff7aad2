//! Every peer that is at hand against brute force in double precision, and whole runs.

use clap::Parser;
use slimkd::{Preset, Ray, TriangleMesh};
use slimkd_lab::basics::soup::soup;
use slimkd_lab::basics::vector::{Vec64, cross, dot, sub, wide};
use slimkd_lab::bench::agree::Judge;
use slimkd_lab::bench::args::Args;
use slimkd_lab::bench::built::{Contender, Found, Traced};
use slimkd_lab::bench::report::Report;
use slimkd_lab::bench::{peers, report, run};
use slimkd_lab::schema::PeerPoint;
use slimkd_lab::workload::Kind;
use slimkd_util::Rng;
use std::sync::Arc;

/// Every triangle, in double precision.
fn brute_force(mesh: &TriangleMesh, ray: &Ray) -> Found {
    let (origin, direction): (Vec64, Vec64) = (wide(ray.origin), wide(ray.direction));
    let mut best = Found::MISS;
    for triangle in 0..mesh.len() as u32 {
        let [a, b, c] = mesh.corners(triangle).map(wide);
        let (e1, e2) = (sub(b, a), sub(c, a));
        let p = cross(direction, e2);
        let det = dot(e1, p);
        let s = sub(origin, a);
        let q = cross(s, e1);
        let (u, v, t) = (dot(s, p) / det, dot(direction, q) / det, dot(e2, q) / det);
        let inside = det != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        if inside && t >= f64::from(ray.t_min) && t <= f64::from(ray.t_max) && (t as f32) < best.t {
            best = Found { t: t as f32, triangle };
        }
    }
    best
}

fn rays() -> Vec<Ray> {
    let mut rng = Rng::new(5);
    let inside = (0..1500).map(|_| {
        let origin: [f32; 3] = std::array::from_fn(|_| rng.unit());
        let ray = Ray::new(origin, rng.direction());
        if rng.unit() < 0.5 { ray.with_range(0.0, 0.4) } else { ray }
    });
    let mut rays: Vec<Ray> = inside.collect();
    // Along the axes, from outside and from inside.
    for k in 0..3 {
        for sign in [-1.0, 1.0] {
            for start in [0.3, -2.0 * sign] {
                let mut origin = [0.41, 0.52, 0.63];
                origin[k] = start;
                let mut direction = [0.0; 3];
                direction[k] = sign;
                rays.push(Ray::new(origin, direction));
            }
        }
    }
    rays
}

fn agrees(name: &str, mesh: &TriangleMesh, traced: &dyn Traced, rays: &[Ray], expected: &[Found]) {
    struct Truth<'a>(&'a TriangleMesh);
    impl Traced for Truth<'_> {
        fn closest(&self, rays: &[Ray], found: &mut [Found]) {
            rays.iter().zip(found).for_each(|(ray, slot)| *slot = brute_force(self.0, ray));
        }
        fn any(&self, rays: &[Ray], blocked: &mut [bool]) {
            rays.iter().zip(blocked).for_each(|(ray, slot)| *slot = brute_force(self.0, ray).is_hit());
        }
        fn bytes(&self, _counted: u64) -> slimkd_lab::bench::built::Bytes {
            unreachable!("the truth takes no room")
        }
    }
    let judge = Judge::new(mesh);
    let truth: Vec<bool> = expected.iter().map(Found::is_hit).collect();
    for &interface in traced.interfaces() {
        let mut found = vec![Found::MISS; rays.len()];
        traced.closest_through(interface, rays, &mut found);
        let closest = judge.closest(rays, expected, &found);
        assert_eq!(
            (closest.wrong(), closest.rays),
            (0, rays.len() as u64),
            "{name} {interface:?}: {closest:?}"
        );
        assert!(closest.excused <= 3, "{name} {interface:?}: {closest:?}");

        let mut blocked = vec![false; rays.len()];
        traced.any_through(interface, rays, &mut blocked);
        let any = judge.any(rays, (&Truth(mesh), traced), &truth, &blocked);
        assert_eq!(any.wrong(), 0, "{name} {interface:?}: {any:?}");
    }
}

fn everybody() -> Vec<Box<dyn Contender>> {
    let (mut all, absent) = peers::others(None, None);
    absent.iter().for_each(|absent| println!("without {}: {}", absent.name, absent.reason));
    all.extend(peers::slimkd(Preset::ALL.iter().copied().map(Into::into).collect(), None));
    all
}

#[test]
fn everybody_agrees_with_brute_force() {
    let mesh = Arc::new(soup(2000, 11));
    let rays = rays();
    let expected: Vec<Found> = rays.iter().map(|ray| brute_force(&mesh, ray)).collect();
    assert!(expected.iter().filter(|found| found.is_hit()).count() > 100);
    for contender in everybody() {
        let name = contender.info().name;
        for threads in [1, 2] {
            let traced = contender.build(&mesh, threads).unwrap_or_else(|error| panic!("{name}: {error}"));
            agrees(&name, &mesh, traced.as_ref(), &rays, &expected);
            let bytes = traced.bytes(1 << 20);
            assert!(bytes.structure > 0 && bytes.resident() >= bytes.tree(), "{name}: {bytes:?}");
        }
    }
}

#[test]
fn names_are_unique_and_facts_are_stated() {
    let mut names: Vec<String> = Vec::new();
    for contender in everybody() {
        let info = contender.info();
        assert!(!info.name.contains(' ') && !info.sah.is_empty() && !info.settings.is_empty());
        assert_ne!(info.version, "unknown", "{}", info.name);
        names.push(info.name);
    }
    names.sort();
    let count = names.len();
    names.dedup();
    assert_eq!(names.len(), count);
}

fn run_with(words: &str) -> Report {
    let args = Args::try_parse_from(["slimkd-bench"].into_iter().chain(words.split(' '))).unwrap();
    run::run(&args, &mut |_| {}).unwrap()
}

#[test]
fn a_run_without_embree_names_it_and_goes_on() {
    let report = run_with(
        "soup --triangles 300 --size 16 --random-rays 200 --rounds 2 --threads 1,2 --builds 2 --presets standard \
         --embree no/such/folder",
    );
    let embree = report.skipped.iter().find(|skipped| skipped.name == "embree").expect("named");
    assert!(embree.reason.contains("no/such/folder"));
    assert!(report.contenders.len() >= 7, "{:?}", report.skipped);
    assert!(report.contenders.iter().all(|contender| !contender.marked));
    assert_eq!(report.contenders[0].identical, Some(true));

    // Everybody through every interface that it has (slimkd has streams, and packets for two workloads), at every workload
    // and thread count, each round kept.
    let interfaces = report.contenders.len() + 1;
    assert_eq!(report.measurements.len(), interfaces * Kind::ALL.len() * 2 + 2 * 2);
    for m in &report.measurements {
        assert_eq!(m.seconds.len(), 2);
        assert!(m.mrays_per_s > 0.0 && m.ratio_to_standard.is_some() && m.ratio_to_embree.is_none());
    }
    assert_eq!(report.points.len(), (interfaces + 1) * 2);
    let workloads = |interface: &str| if interface == "packet" { 2 } else { 4 };
    let whole = |point: &PeerPoint| point.mrays.len() == workloads(&point.interface) && point.bytes_tree > 0;
    assert!(report.points.iter().all(whole));
    for contender in report.contenders.iter().filter(|c| c.name != "kdtree-ray" && c.library != "tinybvh-rs")
    {
        let threads: Vec<Option<usize>> = contender.builds.iter().map(|build| build.threads).collect();
        assert_eq!(threads, [Some(1), Some(2)], "{}", contender.name);
        assert!(contender.builds.iter().all(|build| build.seconds.len() == 2));
    }

    // The JSON says the same as the report.
    let text = serde_json::to_string(&report).unwrap();
    assert_eq!(serde_json::from_str::<Report>(&text).unwrap(), report);
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["schema"], 1);
    assert!(value["points"][0]["mrays"]["primary"].is_number());
    assert!(value["contenders"][1]["agreement"][0]["same"].is_number());

    let table = report::table(&report);
    assert!(table.contains("SMOKE RUN") && table.contains("skipped embree") && table.contains("parry3d"));
}

#[test]
fn slow_builds_wait_for_all() {
    let large = TriangleMesh::new(vec![[0.0; 3]], vec![[0; 3]; 300_001]).unwrap();
    for contender in everybody() {
        let reason = contender.too_slow(&large);
        assert_eq!(reason.is_some_and(|r| r.contains("--all")), contender.info().name == "kdtree-ray");
        assert_eq!(contender.too_slow(&soup(10, 1)), None);
    }
}

#[test]
fn workloads_and_peers_can_be_chosen() {
    let report = run_with(
        "soup --triangles 300 --size 2 --random-rays 10 --rounds 1 --threads 1 --presets standard --peers none \
         --workloads random",
    );
    assert_eq!((report.workloads.len(), report.contenders.len()), (1, 1));
    assert!(report.skipped.is_empty());
}

#[test]
fn what_cannot_be_opened_is_an_error() {
    for words in ["no-such-scene", "soup --triangles 0", "soup --camera 1,2", "soup --view 9"] {
        let args = Args::try_parse_from(["slimkd-bench"].into_iter().chain(words.split(' '))).unwrap();
        assert!(run::run(&args, &mut |_| {}).is_err(), "{words}");
    }
}

#[test]
fn not_finite_corners_are_survived() {
    let mut vertices = soup(200, 2).vertices().to_vec();
    vertices[7] = [f32::NAN, 0.0, f32::INFINITY];
    let triangles = (0..200).map(|id| [3 * id, 3 * id + 1, 3 * id + 2]).collect();
    let mesh = Arc::new(TriangleMesh::new(vertices, triangles).unwrap());
    let clean = peers::finite(&mesh);
    let rays = rays();
    let expected: Vec<Found> = rays.iter().map(|ray| brute_force(&clean, ray)).collect();
    for contender in everybody() {
        let info = contender.info();
        let given = if info.library == "slimkd" { &mesh } else { &clean };
        let traced = contender.build(given, 1).unwrap_or_else(|error| panic!("{}: {error}", info.name));
        agrees(&info.name, &clean, traced.as_ref(), &rays, &expected);
    }
}
