//! Closed meshes do not leak, edges and vertices included, whatever traces the rays.
//!
//! The rays of one test run are few; `scripts/leaks` takes as many as one likes (`SLIMKD_LEAK_RAYS` in all, on
//! `SLIMKD_WORKERS` threads).

use crate::common::{Rng, how_many, on_workers, sphere, variants, workers};
use slimkd::{KdTree, Ray, Tracer, TriangleMesh};
use std::sync::Arc;

/// Rays of a batch, which one interface takes.
const BATCH: u64 = 3000;
const INTERFACES: [&str; 6] = [
    "closest, single",
    "any, single",
    "closest, streams",
    "any, streams",
    "closest, packets",
    "any, packets",
];

/// A closed surface that can be seen whole from its centre.
struct Closed {
    name: &'static str,
    mesh: Arc<TriangleMesh>,
    center: [f32; 3],
    /// Origins lie within this of the centre, per axis.
    inside: [f32; 3],
}

fn closed() -> [Closed; 2] {
    let round = sphere(6);
    // Dents and bumps, a thousand times as long as wide and as wide as thick, far from the origin.
    let (center, half) = ([5000.0, -300.0, 40.0], [1000.0, 1.0, 1e-3]);
    let mut rng = Rng::new(7);
    let place = |vertex: &[f32; 3]| {
        let size = 0.7 + 0.6 * rng.unit();
        std::array::from_fn(|k| center[k] + half[k] * (size * vertex[k]))
    };
    let small = sphere(4);
    let bumpy = TriangleMesh::new(small.vertices().iter().map(place).collect(), small.triangles().to_vec());
    [
        Closed { name: "sphere", mesh: Arc::new(round), center: [0.0; 3], inside: [0.4; 3] },
        Closed { name: "bumpy", mesh: Arc::new(bumpy.unwrap()), center, inside: half.map(|x| 0.2 * x) },
    ]
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    let rays = how_many("SLIMKD_LEAK_RAYS", 3_000_000);
    let variants = variants();
    let mut counted = [0; INTERFACES.len()];
    for closed in closed() {
        let batches = rays.div_ceil(2 * variants.len() as u64 * BATCH);
        for (at, (variant, options)) in variants.iter().enumerate() {
            let tree = KdTree::build(Arc::clone(&closed.mesh), options).unwrap();
            let work = |worker| {
                let mut rng = Rng::new(worker);
                // Each variant begins with another interface, so that few batches meet all as well.
                (worker..batches)
                    .step_by(workers() as usize)
                    .map(|batch| {
                        let interface = (batch as usize + at) % INTERFACES.len();
                        (interface, leaks_of(&tree, &closed, &mut rng, interface))
                    })
                    .fold([(0, 0); INTERFACES.len()], |mut sums, (interface, leaks)| {
                        sums[interface] = (sums[interface].0 + BATCH, sums[interface].1 + leaks);
                        sums
                    })
            };
            for (interface, (rays, leaks)) in on_workers(work).into_iter().flat_map(|sums| (0..).zip(sums)) {
                assert_eq!(leaks, 0, "{}, {variant}, {}: of {rays}", closed.name, INTERFACES[interface]);
                counted[interface] += rays;
            }
        }
    }
    println!("no leak in {} rays:", counted.iter().sum::<u64>());
    INTERFACES.iter().zip(counted).for_each(|(name, rays)| println!("{rays} {name}"));
    assert!(counted.iter().all(|&rays| rays > 0));
}

/// How many rays of a batch get out.
fn leaks_of(tree: &KdTree, closed: &Closed, rng: &mut Rng, interface: usize) -> usize {
    let rays: Vec<_> = (0..BATCH).map(|i| ray_from_inside(closed, rng, i % 4)).collect();
    let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
    match interface {
        0 => rays.iter().zip(&mut hits).for_each(|(ray, hit)| *hit = tree.closest(ray)),
        1 => rays.iter().zip(&mut any).for_each(|(ray, any)| *any = tree.any(ray)),
        2 => tree.batch().closest(&rays, &mut hits),
        3 => tree.batch().any(&rays, &mut any),
        4 => tree.batch().coherent().closest(&rays, &mut hits),
        _ => tree.batch().coherent().any(&rays, &mut any),
    }
    hits.into_iter().zip(any).filter(|(hit, any)| hit.is_none() && !any).count()
}

/// From near the centre anywhere, through an edge, through a vertex, or along the axes.
fn ray_from_inside(closed: &Closed, rng: &mut Rng, kind: u64) -> Ray {
    let Closed { mesh, center, inside, .. } = closed;
    let point = rng.point();
    let origin: [f32; 3] = std::array::from_fn(|k| center[k] + inside[k] * (2.0 * point[k] - 1.0));
    let [a, b, _] = mesh.corners(rng.below(mesh.len()) as u32);
    let target = match kind {
        0 => {
            let point = rng.point();
            std::array::from_fn(|k| center[k] + 5.0 * inside[k] * (2.0 * point[k] - 1.0))
        }
        1 => {
            let s = rng.unit();
            std::array::from_fn(|k| a[k] + s * (b[k] - a[k]))
        }
        2 => a,
        _ => {
            // An edge or vertex of the octahedron's axis planes, met by a ray inside such a plane.
            let axis = rng.below(3);
            let origin: [f32; 3] = std::array::from_fn(|k| if k == axis { center[k] } else { origin[k] });
            let mut direction = rng.point().map(|x| x - 0.5);
            direction[axis] = 0.0;
            return Ray::new(origin, if direction == [0.0; 3] { [1.0, 0.0, 0.0] } else { direction });
        }
    };
    let direction: [f32; 3] = std::array::from_fn(|k| target[k] - origin[k]);
    let away = if direction == [0.0; 3] { [1.0, 0.0, 0.0] } else { direction };
    Ray::new(origin, away)
}
