//! Hits against exact arithmetic: none is missed and none invented beyond the bound that `docs/promises.md` states.
//!
//! A test run takes some ten thousand rays; `scripts/oracle` as many as one likes (`SLIMKD_ORACLE_RAYS`, on
//! `SLIMKD_WORKERS` threads).

use crate::common::{Rng, hard_rays, how_many, on_workers, push_box, soup, sphere, workers};
use slimkd::{Hit, KdTree, Preset, Ray, Tracer, TriangleMesh};
use std::sync::Arc;

/// The stated bound, in units of 2⁻²⁴ of the largest distance per axis from the ray's origin to the scene's bounds.
const BOUND: f64 = 6.0;
/// Rays of a batch: one seed each.
const BATCH: usize = 5000;

/// The worst that was seen, in units of the bound's unit.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    rays: u64,
    hits: u64,
    /// Hits that are none exactly, and how far from their triangle.
    beside: u64,
    point: f64,
    /// Exact crossings that are no hit, and how near to the outline or an end of the range.
    missed: u64,
    outline: f64,
    /// Error of t times the cosine of the angle to the normal.
    t: f64,
}

impl Worst {
    fn merge(&mut self, other: &Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.beside += other.beside;
        self.missed += other.missed;
        self.point = self.point.max(other.point);
        self.outline = self.outline.max(other.outline);
        self.t = self.t.max(other.t);
    }
}

fn slivers(count: u32) -> TriangleMesh {
    let mut rng = Rng::new(4);
    let mut vertices = Vec::new();
    for _ in 0..count {
        let (a, along, aside) = (rng.point(), rng.point(), rng.point());
        vertices.push(a);
        vertices.push(std::array::from_fn(|k| a[k] + 3.0 * (along[k] - 0.5)));
        vertices.push(std::array::from_fn(|k| a[k] + 3e-6 * (aside[k] - 0.5)));
    }
    TriangleMesh::new(vertices, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

/// Coordinates of 10⁻⁶ and 10⁷ in one scene.
fn mixed_scales() -> TriangleMesh {
    let mut vertices = Vec::new();
    for (scale, offset, seed) in [(1e-6, 0.0, 1), (1.0, -0.5, 2), (1e7, -5e6, 3), (1e7, 0.0, 4)] {
        vertices.extend_from_slice(soup(24, scale, offset, seed).vertices());
    }
    let ground = vertices.len() as u32;
    vertices.extend([[-1e7, -1e7, -1e-6], [1e7, -1e7, -1e-6], [1e7, 1e7, -1e-6], [-1e7, 1e7, -1e-6]]);
    let mut triangles: Vec<_> = (0..ground / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    triangles.extend([[ground, ground + 1, ground + 2], [ground, ground + 2, ground + 3]]);
    TriangleMesh::new(vertices, triangles).unwrap()
}

fn boxes() -> TriangleMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..8u32 {
        push_box(&mut vertices, &mut triangles, [i & 1, i >> 1 & 1, i >> 2].map(|x| x as f32), [1.0; 3]);
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// Checks a batch, through every interface; says what broke the bound.
fn check_batch(tree: &KdTree, rays: &[Ray], worst: &mut Worst) -> Result<(), String> {
    let (mut streams, mut packets) = (vec![None; rays.len()], vec![None; rays.len()]);
    tree.batch().closest(rays, &mut streams);
    tree.batch().coherent().closest(rays, &mut packets);
    for ((ray, &stream), &packet) in rays.iter().zip(&streams).zip(&packets) {
        check(tree, ray, [stream, packet], worst).map_err(|what| format!("{ray:?}: {what}"))?;
    }
    Ok(())
}

/// Checks a ray, and what batches found for it.
fn check(tree: &KdTree, ray: &Ray, batches: [Option<Hit>; 2], worst: &mut Worst) -> Result<(), String> {
    let mesh = tree.mesh();
    let bounds = tree.bounds();
    let reach = (0..3)
        .map(|k| {
            let o = f64::from(ray.origin[k]);
            (f64::from(bounds.min[k]) - o).abs().max((f64::from(bounds.max[k]) - o).abs())
        })
        .fold(0.0, f64::max);
    let unit = reach / f64::from(1 << 24);
    let size = crate::exact::length(crate::exact::wide(ray.direction));
    let hits = tree.all(ray);
    worst.rays += 1;
    if !hits.iter().all(|hit| hit.t.is_finite()) {
        return Ok(()); // the direction is so short that t leaves f32
    }
    let first = hits.first().copied();
    if tree.closest(ray) != first || batches != [first; 2] || tree.any(ray) == hits.is_empty() {
        return Err("queries disagree".into());
    }
    for id in 0..mesh.len() as u32 {
        let corners = mesh.corners(id);
        let hit = hits.iter().find(|hit| hit.triangle == id);
        let crosses = crate::exact::crosses(ray, &corners);
        if hit.is_none() && !crosses {
            continue;
        }
        let cosine = crate::exact::cosine(ray, &corners);
        let t = crate::exact::crossing(ray, &corners);
        if let Some(hit) = hit {
            worst.hits += 1;
            let at = std::array::from_fn(|k| {
                f64::from(ray.origin[k]) + f64::from(hit.t) * f64::from(ray.direction[k])
            });
            let apart = crate::exact::distance(at, &corners) / unit;
            worst.point = worst.point.max(apart);
            worst.beside += u64::from(!crosses);
            if apart > BOUND {
                return Err(format!("triangle {id} is hit {apart} units beside it"));
            }
            if let Some(t) = t.filter(|_| crosses) {
                let error = (f64::from(hit.t) - t).abs() * size * cosine / unit;
                worst.t = worst.t.max(error);
                if error > BOUND {
                    return Err(format!("triangle {id}: t is {error} units off"));
                }
            }
        } else if let Some(t) = t {
            // Beyond the range by more than t may be off: no hit either way.
            let slack = BOUND * unit / (size * cosine);
            if t < f64::from(ray.t_min) - slack || t > f64::from(ray.t_max) + slack {
                continue;
            }
            if t < f64::from(ray.t_min) + slack || t > f64::from(ray.t_max) - slack {
                continue;
            }
            let near = crate::exact::from_outline(ray, &corners) / unit;
            worst.missed += 1;
            worst.outline = worst.outline.max(near);
            if near > BOUND {
                return Err(format!("triangle {id} is missed {near} units inside its outline"));
            }
        }
    }
    Ok(())
}

fn campaign(name: &str, mesh: TriangleMesh, rays: usize) -> Worst {
    let mesh = Arc::new(mesh);
    let trees: Vec<_> =
        Preset::ALL.iter().map(|&preset| KdTree::build(Arc::clone(&mesh), &preset.into()).unwrap()).collect();
    let batches = rays.div_ceil(BATCH) as u64;
    let work = |worker: u64| {
        let mut worst = Worst::default();
        for batch in (worker..batches).step_by(workers() as usize) {
            let tree = &trees[batch as usize % trees.len()];
            let rays = hard_rays(&mesh, BATCH, batch);
            if let Err(what) = check_batch(tree, &rays, &mut worst) {
                panic!("{name}, {:?}, {what}", tree.options().preset);
            }
        }
        worst
    };
    let mut worst = Worst::default();
    on_workers(work).iter().for_each(|part| worst.merge(part));
    println!("{name}: {worst:?}");
    worst
}

#[test]
fn no_hit_is_missed_and_none_invented_beyond_the_bound() {
    let rays = how_many("SLIMKD_ORACLE_RAYS", 30_000);
    let mut all = Worst::default();
    for (name, mesh, share) in [
        ("sphere", sphere(2), 0.2),
        ("boxes with shared walls", boxes(), 0.2),
        ("slivers of aspect 10^6", slivers(96), 0.2),
        ("coordinates of 10^-6 and 10^7", mixed_scales(), 0.2),
        ("soup", soup(96, 1.0, 0.0, 1), 0.1),
        ("far soup", soup(96, 1.0, 1000.0, 1), 0.08),
        ("soup of 2,000", soup(2000, 1.0, 0.0, 7), 0.02),
    ] {
        all.merge(&campaign(name, mesh, (rays as f64 * share) as usize));
    }
    println!("all: {all:?}");
    assert!(all.hits > all.rays / 2, "too few hits to prove anything: {all:?}");
}

#[test]
fn the_oracle_s_steps_agree() {
    for (mesh, seed) in [(boxes(), 1), (slivers(96), 2), (mixed_scales(), 3), (soup(96, 1.0, 1000.0, 1), 4)] {
        for (i, ray) in hard_rays(&mesh, 400, seed).iter().enumerate() {
            for id in (i as u32 % 7..mesh.len() as u32).step_by(7) {
                let corners = mesh.corners(id);
                let apart = crate::exact::agrees_with_itself(ray, &corners)
                    .unwrap_or_else(|what| panic!("{ray:?} {corners:?}: {what}"));
                assert!(apart < 2.0f64.powi(-33), "{ray:?} {corners:?}: {apart}");
            }
        }
    }
}

#[test]
fn the_oracle_knows_edges_from_misses() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let down = |x: f32, y: f32| Ray::new([x, y, 1.0], [0.0, 0.0, -1.0]);
    let above = f32::from_bits(0.5f32.to_bits() + 1);
    assert!(
        crate::exact::crosses(&down(0.5, 0.5), &corners)
            && !crate::exact::crosses(&down(0.5, above), &corners)
    );
    assert!(
        crate::exact::crosses(&down(0.0, 0.0), &corners)
            && !crate::exact::crosses(&down(-1e-45, 0.0), &corners)
    );
    assert!(
        !crate::exact::crosses(&Ray::new([-1.0, 0.2, 0.0], [1.0, 0.0, 0.0]), &corners),
        "within the plane"
    );
    assert_eq!(
        crate::exact::crossing(&Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -3.0]), &corners),
        Some(1.0 / 3.0)
    );
    assert_eq!(crate::exact::distance([0.5, 0.5, 2.0], &corners), 2.0);
    assert_eq!(crate::exact::from_outline(&down(0.25, 0.25), &corners), 0.25);
}
