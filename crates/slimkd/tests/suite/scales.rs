//! Scenes and rays at the ends of f32: the same hits from brute force, single rays, packets and streams.
//!
//! `SLIMKD_SCALES=100000` makes a campaign of it.

use crate::common::{Rng, hard_rays};
use proptest::prelude::*;
use slimkd::{
    BruteForce, BuildOptions, Hit, InstructionSet, KdTree, Layout, Preset, Ray, Tracer, TriangleMesh,
};
use std::sync::Arc;

/// 2^e, from the smallest subnormal to the largest power of two.
fn power(e: i32) -> f32 {
    f64::from(e).exp2() as f32
}

/// Powers of two that meet each other's ends: mostly one for all, else each of its own.
fn exponent() -> impl Strategy<Value = i32> {
    prop_oneof![
        2 => -149..128,
        1 => prop::sample::select(vec![-149, -127, -126, -105, -40, 0, 1, 40, 67, 87, 102, 120, 125, 126, 127]),
    ]
}

fn exponents() -> impl Strategy<Value = [i32; 3]> {
    prop_oneof![
        exponent().prop_map(|e| [e; 3]),
        prop::array::uniform3(exponent()),
        (exponent(), prop::array::uniform3(-20..20i32))
            .prop_map(|(e, d)| d.map(|d| (e + d).clamp(-149, 127))),
    ]
}

/// A soup whose axes have these scales, around a point at these distances.
fn mesh(scales: [i32; 3], offsets: Option<[i32; 3]>, seed: u64) -> TriangleMesh {
    let mut rng = Rng::new(seed);
    let center = offsets.map_or([0.0; 3], |e| e.map(|e| power(e) * (2.0 * rng.unit() - 1.0)));
    let mut vertices: Vec<[f32; 3]> = Vec::new();
    let size = [0.1, 0.5, 1.0][rng.below(3)];
    for _ in 0..30 {
        let at = rng.point();
        for _ in 0..3 {
            let corner = rng.point();
            vertices.push(std::array::from_fn(|k| {
                let x = at[k] + size * (corner[k] - 0.5);
                // On a coarse raster, planes and corners are shared.
                let x = if seed.is_multiple_of(2) { (8.0 * x).round() / 8.0 } else { x };
                center[k] + power(scales[k]) * (2.0 * x - 1.0)
            }));
        }
    }
    let triangles = (0..60).map(|i| {
        if i < 30 { [3 * i, 3 * i + 1, 3 * i + 2] } else { [0; 3].map(|_: u32| rng.below(90) as u32) }
    });
    let triangles = triangles.collect();
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// Hard rays; with directions of other lengths; from far away; towards a corner from a place of a given distance.
fn rays(mesh: &TriangleMesh, lengths: [i32; 3], far: [i32; 3], seed: u64) -> Vec<Ray> {
    let mut rng = Rng::new(seed);
    let mut rays = hard_rays(mesh, 30, seed);
    for ray in rays.clone() {
        for length in lengths {
            let direction = ray.direction.map(|x| x * power(length));
            rays.push(Ray { direction, ..ray });
        }
    }
    for i in 0..36 {
        let corner = mesh.corners(rng.below(mesh.len()) as u32)[0];
        let origin: [f32; 3] = std::array::from_fn(|k| {
            let distance = if i % 3 == 0 && k != i % 2 { 0.0 } else { power(far[k]) };
            corner[k] + distance * (2.0 * rng.unit() - 1.0)
        });
        let direction: [f32; 3] = std::array::from_fn(|k| corner[k] - origin[k]);
        rays.push(Ray::new(origin, direction));
        let range = [(f32::NEG_INFINITY, f32::INFINITY), (0.5, 1.0), (1.0, 1.0), (0.0, 1e-45)][i % 4];
        rays.push(
            Ray::new(origin, direction.map(|x| x * power(lengths[i % 3]))).with_range(range.0, range.1),
        );
        // Packets take what starts at one point.
        for _ in 0..2 {
            let target = mesh.corners(rng.below(mesh.len()) as u32)[rng.below(3)];
            rays.push(Ray::new(origin, std::array::from_fn::<f32, 3, _>(|k| target[k] - origin[k])));
        }
    }
    let eye = rays[rays.len() - 1].origin;
    for id in 0..mesh.len() as u32 {
        let [a, b, _] = mesh.corners(id);
        for target in [a, std::array::from_fn(|k| 0.5 * a[k] + 0.5 * b[k])] {
            rays.push(Ray::new(eye, std::array::from_fn::<f32, 3, _>(|k| target[k] - eye[k])));
        }
    }
    rays
}

fn bits(hit: &Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.triangle])
}

fn options() -> Vec<(&'static str, BuildOptions)> {
    let mut dense = BuildOptions::from(Preset::Standard);
    dense.layout = Layout::Dense;
    vec![
        ("standard", Preset::Standard.into()),
        ("standard, dense", dense),
        ("paper-small", Preset::PaperSmall.into()),
        ("slim", Preset::Slim.into()),
    ]
}

/// How many rays hit; the first difference is an error.
fn check(mesh: TriangleMesh, rays: &[Ray]) -> Result<usize, String> {
    let mesh = Arc::new(mesh);
    let oracle = BruteForce::new(&mesh);
    let closest: Vec<_> = rays.iter().map(|ray| oracle.closest(ray)).collect();
    let same = |got: &Option<Hit>, i: usize, what: &str| {
        if bits(got) == bits(&closest[i]) {
            return Ok(());
        }
        Err(format!("{what}: {:?} gives {got:?}, not {:?}", rays[i], closest[i]))
    };
    let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
    for (name, options) in options() {
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        for (i, ray) in rays.iter().enumerate() {
            same(&tree.closest(ray), i, name)?;
            if i % 4 == 0 && tree.all(ray) != oracle.all(ray) {
                return Err(format!("{name}: all hits of {ray:?}"));
            }
        }
        let best = InstructionSet::best();
        // SSE2's lanes beside the best ones; one tree of each layout will do.
        let least = (name != "paper-small").then_some(InstructionSet::Sse2.or_below());
        for set in least.into_iter().chain([best]) {
            let batch = tree.batch().instruction_set(set);
            for coherent in [true, false] {
                let what = format!("{name} {} {}", set.name(), if coherent { "packets" } else { "streams" });
                if coherent {
                    batch.coherent().closest(rays, &mut hits);
                    batch.coherent().any(rays, &mut any);
                } else {
                    batch.closest(rays, &mut hits);
                    batch.any(rays, &mut any);
                }
                for i in 0..rays.len() {
                    same(&hits[i], i, &what)?;
                    if any[i] != closest[i].is_some() {
                        return Err(format!("{what}: any hit of {:?}", rays[i]));
                    }
                }
            }
        }
    }
    Ok(closest.iter().flatten().count())
}

fn cases() -> u32 {
    std::env::var("SLIMKD_SCALES").map_or(12, |n| n.parse().expect("SLIMKD_SCALES is a number of cases"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases()))]

    #[test]
    fn any_scale_agrees_with_brute_force(
        scales in exponents(), offsets in prop::option::weighted(0.3, exponents()),
        lengths in prop::array::uniform3(exponent()), far in exponents(), seed in any::<u64>(),
    ) {
        let mesh = mesh(scales, offsets, seed);
        let rays = rays(&mesh, lengths, far, seed);
        if let Err(what) = check(mesh, &rays) {
            prop_assert!(false, "{}", what);
        }
    }
}

/// Long thin scenes and rays nearly across: the grid's factor times 1/d is too large for f32.
#[test]
fn a_grid_plane_times_a_slope_beyond_f32() {
    for scale in [68, 80, 102, 126] {
        let mesh = mesh([0, scale, 40], None, 1);
        let mut many = rays(&mesh, [0, -100, 20], [0, 0, 40], 2);
        many.extend(rays(&mesh, [0, 0, 0], [0, scale - 30, 41], 3));
        assert!(check(mesh, &many).unwrap() > 50, "{scale}");
    }
}

/// Origins so far away that their place on a thin grid is too large for f32.
#[test]
fn an_origin_beyond_the_grid() {
    for (thin, far) in [(-90, 39), (-100, 50), (-120, 100), (-149, 20)] {
        let mesh = mesh([thin, 0, far], None, 1);
        let many = rays(&mesh, [0, 10, -10], [far, far, far], 2);
        assert!(check(mesh, &many).unwrap() > 50, "{thin} {far}");
    }
}

/// Small scenes and long directions: t is subnormal or 0, and many hits are equal.
#[test]
fn t_below_the_normal_numbers() {
    for (scale, length) in [(-20, 127), (-60, 100), (-66, 127), (-100, 60), (-120, 127)] {
        let mesh = mesh([scale; 3], None, 1);
        let many = rays(&mesh, [length, length - scale, length + 20].map(|e| e.min(127)), [scale; 3], 2);
        assert!(check(mesh, &many).unwrap() > 50, "{scale} {length}");
    }
}

/// t too large for f32 is no hit, whichever way.
#[test]
fn t_beyond_f32() {
    let mesh = mesh([3; 3], None, 1);
    let many = rays(&mesh, [-127, -135, -149], [5; 3], 2);
    assert!(check(mesh, &many).unwrap() > 50);
}

#[test]
fn scenes_at_both_ends_of_f32() {
    for scale in [-149, -140, -126, -107, 107, 124, 125, 126, 127] {
        let mesh = mesh([scale; 3], None, 1);
        let many = rays(&mesh, [0, -40, 40], [scale; 3], 2);
        let hits = check(mesh, &many).unwrap();
        assert!(hits > 50 || scale == -149, "{scale} {hits}");
    }
}
