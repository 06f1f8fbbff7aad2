//! Crossing numbers: against a ray that is really displaced, in integers of any length; against brute force; and against meshes whose inside is known.
//!
//! The rays of one test run are few; `scripts/crossings` takes as many as one likes (`SLIMKD_CROSSING_RAYS` in all, on `SLIMKD_WORKERS` threads).

use crate::cells::Cells;
use crate::common::{Rng, hard_rays, how_many, on_workers, push_box, soup, sphere, variants, workers};
use crate::exact::displaced_crossing;
use slimkd::{BruteForce, Crossings, KdTree, OpenTree, Preset, Ray, Tracer, TriangleMesh};
use std::sync::Arc;

fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// Rays that meet vertices, edges and faces, begin and end on them, or run within faces: half of them from points of a coarse grid.
fn aimed_rays(mesh: &TriangleMesh, count: usize, seed: u64) -> Vec<Ray> {
    let mut rng = Rng::new(seed);
    let mut rays = hard_rays(mesh, count / 2, seed);
    while rays.len() < count {
        let [a, b, c] = mesh.corners(rng.below(mesh.len()) as u32);
        let other = mesh.corners(rng.below(mesh.len()) as u32)[0];
        let middle: [f32; 3] = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
        let target = [a, middle, c][rng.below(3)];
        let origin = match rng.below(4) {
            0 => other,
            1 => std::array::from_fn(|k| other[k] + (rng.below(5) as f32 - 2.0)),
            2 => std::array::from_fn(|k| 2.0 * target[k] - other[k]),
            _ => std::array::from_fn(|k| target[k] + if rng.below(2) == 0 { 1.0 } else { 0.0 }),
        };
        let range =
            [(0.0, f32::INFINITY), (0.0, 1.0), (1.0, 2.0), (f32::NEG_INFINITY, f32::INFINITY)][rng.below(4)];
        rays.push(Ray::new(origin, sub(target, origin)).with_range(range.0, range.1));
    }
    rays
}

fn meshes() -> Vec<(&'static str, TriangleMesh)> {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..8u32 {
        push_box(&mut vertices, &mut triangles, [i % 2, i / 2 % 2, i / 4].map(|x| x as f32), [1.0; 3]);
    }
    triangles.push([0, 0, 1]);
    triangles.push([0, 1, 2]);
    triangles.push([0, 1, 2]);
    let mut ends = soup(60, 1.0, 0.0, 8).vertices().to_vec();
    for (i, vertex) in ends.iter_mut().enumerate() {
        let scale = [1e-38f32, 1e30, 1.0, 1e-20][i / 3 % 4];
        *vertex = vertex.map(|x| x * scale);
    }
    let ends = TriangleMesh::new(ends, soup(60, 1.0, 0.0, 8).triangles().to_vec()).unwrap();
    vec![
        ("octahedron", sphere(0)),
        ("sphere", sphere(2)),
        ("boxes that share walls", TriangleMesh::new(vertices, triangles).unwrap()),
        ("cells", Cells::new(3, 2).mesh(0.0)),
        ("soup", soup(100, 1.0, 0.0, 1)),
        ("far soup", soup(60, 1.0, 1000.0, 2)),
        ("the ends of f32", ends),
    ]
}

#[test]
fn crossings_are_those_of_a_ray_that_is_really_displaced() {
    let (mut crossed, mut displaced_only) = (0, 0);
    for (name, mesh) in meshes() {
        let oracle = BruteForce::new(&mesh);
        for ray in aimed_rays(&mesh, 150, 3) {
            let mut expected = Crossings::default();
            if ray.is_valid() {
                for id in 0..mesh.len() as u32 {
                    match displaced_crossing(&ray, &mesh.corners(id)) {
                        1 => expected.leaving += 1,
                        -1 => expected.entering += 1,
                        _ => {}
                    }
                }
            }
            let found = oracle.crossings(&ray);
            assert_eq!(found, expected, "{name} {ray:?}");
            crossed += expected.count();
            displaced_only += usize::from(expected.count() != oracle.count(&ray));
        }
    }
    assert!(crossed > 500 && displaced_only > 100, "{crossed} {displaced_only}");
}

#[test]
fn every_tree_counts_what_brute_force_counts() {
    for (name, mesh) in meshes() {
        let oracle = BruteForce::new(&mesh);
        let rays = aimed_rays(&mesh, 400, 11);
        let expected: Vec<_> = rays.iter().map(|ray| oracle.crossings(ray)).collect();
        let mesh = Arc::new(mesh.clone());
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            let mut found = vec![Crossings::default(); rays.len()];
            tree.batch().threads(2).crossings(&rays, &mut found);
            for ((ray, found), expected) in rays.iter().zip(&found).zip(&expected) {
                assert_eq!(found, expected, "{name} {variant} {ray:?}");
            }
            let mut bytes = Vec::new();
            tree.write(&mut bytes).unwrap();
            let open = OpenTree::open(bytes).unwrap();
            for (ray, expected) in rays.iter().zip(&expected).step_by(9) {
                assert_eq!(open.crossings(ray), *expected, "{name} {variant}, open, {ray:?}");
            }
        }
    }
}

/// A point of a cell, away from what `wobble` moves; and a ray from there, a tenth of them aimed at vertices and edges, and a tenth along the
/// axes and within planes of the grid.
fn ray_of_cells(mesh: &TriangleMesh, cells: &Cells, wobble: f32, rng: &mut Rng) -> ([i64; 3], Ray) {
    let cell: [i64; 3] = std::array::from_fn(|_| rng.below(cells.size + 2) as i64 - 1);
    let margin = 2.0 * wobble + 0.01;
    let inside = |x: f32| margin + (1.0 - 2.0 * margin) * x;
    let mut origin: [f32; 3] = std::array::from_fn(|k| cell[k] as f32 + inside(rng.unit()));
    let [a, b, _] = mesh.corners(rng.below(mesh.len()) as u32);
    let direction = match rng.below(20) {
        0 => sub(a, origin),
        1 => {
            let s = rng.unit();
            sub(std::array::from_fn(|k| a[k] + s * (b[k] - a[k])), origin)
        }
        2 => {
            // From the middle of the cell to vertices and middles of edges: without any rounding where there is no wobble.
            origin = cell.map(|x| x as f32 + 0.5);
            sub(std::array::from_fn(|k| 0.5 * (a[k] + b[k])), origin)
        }
        3 => {
            origin = cell.map(|x| x as f32 + 0.5);
            std::array::from_fn(|_| [0.0, 1.0, -1.0, 0.5][rng.below(4)])
        }
        _ => rng.point().map(|x| x - 0.5),
    };
    (cell, Ray::new(origin, if direction == [0.0; 3] { [0.0, 0.0, 1.0] } else { direction }))
}

#[test]
fn parity_and_winding_say_what_is_inside() {
    let rays = how_many("SLIMKD_CROSSING_RAYS", 200_000);
    let trees = [Preset::Standard, Preset::PaperSmall, Preset::Slim, Preset::Tiny];
    let mut inside = 0;
    for (seed, wobble) in [(1, 0.0), (2, 0.2)] {
        let cells = Cells::new(8, seed);
        let mesh = Arc::new(cells.mesh(wobble));
        for preset in trees {
            let tree = KdTree::build(Arc::clone(&mesh), &preset.into()).unwrap();
            let work = |worker: u64| {
                let mut rng = Rng::new(worker + 100);
                let mut inside = 0;
                for _ in (worker..rays / 8).step_by(workers() as usize) {
                    let (cell, ray) = ray_of_cells(&mesh, &cells, wobble, &mut rng);
                    let crossings = tree.crossings(&ray);
                    let full = cells.is_full(cell);
                    assert_eq!(crossings.count() % 2 == 1, full, "{preset}, wobble {wobble}: {ray:?}");
                    assert_eq!(crossings.signed(), i64::from(full), "{preset}, wobble {wobble}: {ray:?}");
                    inside += u64::from(full);
                }
                inside
            };
            inside += on_workers(work).iter().sum::<u64>();
        }
    }
    println!("{rays} rays, {inside} from inside: every parity and every winding number is right");
    assert!(inside * 10 > rays, "{inside} of {rays}");
}

/// An octahedron's inside is known without any rounding.
#[test]
fn points_near_a_surface_are_on_the_right_side() {
    let mesh = sphere(0);
    let tree = KdTree::build(mesh.clone(), &Preset::Slim.into()).unwrap();
    let mut rng = Rng::new(17);
    let mut beside = 0;
    for _ in 0..20_000 {
        let mut point = rng.point().map(|x| 2.0 * x - 1.0);
        point[2] = (1.0 - point[0].abs() - point[1].abs()).max(0.0);
        for _ in 0..rng.below(3) {
            point[2] = point[2].next_down();
        }
        // Exact: the numbers are multiples of 2⁻²⁴⁻⁹ or so.
        let sum = point.iter().map(|&x| f64::from(x).abs()).sum::<f64>();
        if sum == 1.0 {
            continue;
        }
        beside += 1;
        let target = mesh.vertices()[rng.below(6)];
        for direction in [sub(target, point), rng.point().map(|x| x - 0.5), [0.0, 0.0, 1.0], [-1.0, 1.0, 0.0]]
        {
            let crossings = tree.crossings(&Ray::new(point, direction));
            assert_eq!(crossings.signed(), i64::from(sum < 1.0), "{point:?} {direction:?}");
            assert_eq!(crossings.count() % 2 == 1, sum < 1.0, "{point:?} {direction:?}");
        }
    }
    assert!(beside > 5000, "{beside}");
}
