//! Closed meshes do not leak, edges and vertices included.
//!
//! The rays of one test run are few; `SLIMKD_LEAK_RAYS=100000000 cargo test --release --test watertight` runs the full count.

mod common;

use common::{Rng, sphere, variants};
use slimkd::{KdTree, Ray};
use std::sync::Arc;

/// Rays of a batch.
const BATCH: usize = 3000;

#[test]
fn no_ray_leaves_a_sphere() {
    let rays: u64 = std::env::var("SLIMKD_LEAK_RAYS").ok().and_then(|n| n.parse().ok()).unwrap_or(300_000);
    let mesh = Arc::new(sphere(6));
    for (variant, options) in variants() {
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        let leaks = std::thread::scope(|scope| {
            let workers: Vec<_> = (0..2)
                .map(|worker| {
                    let (tree, mesh) = (&tree, &mesh);
                    scope.spawn(move || {
                        let mut rng = Rng::new(worker);
                        let batches = (rays / 2).div_ceil(BATCH as u64);
                        (0..batches).map(|batch| leaks_of(tree, mesh, &mut rng, batch)).sum::<usize>()
                    })
                })
                .collect();
            workers.into_iter().map(|worker| worker.join().unwrap()).sum::<usize>()
        });
        assert_eq!(leaks, 0, "{variant}: of {rays} rays");
    }
}

/// Leaks of a batch; the kernels take turns.
fn leaks_of(tree: &KdTree, mesh: &slimkd::TriangleMesh, rng: &mut Rng, batch: u64) -> usize {
    let rays: Vec<_> = (0..BATCH as u64).map(|i| ray_from_inside(mesh, rng, i % 4)).collect();
    let mut any = vec![false; BATCH];
    match batch % 3 {
        0 => rays.iter().zip(&mut any).for_each(|(ray, any)| *any = tree.any_hit(ray)),
        1 => tree.any_hits(&rays, &mut any),
        _ => tree.any_hits_coherent(&rays, &mut any),
    }
    any.into_iter().filter(|any| !any).count()
}

/// From near the centre anywhere, through an edge, through a vertex, or along the axes.
fn ray_from_inside(mesh: &slimkd::TriangleMesh, rng: &mut Rng, kind: u64) -> Ray {
    let origin = rng.point().map(|x| (x - 0.5) * 0.8);
    let [a, b, _] = mesh.corners(rng.below(mesh.len()) as u32);
    let target = match kind {
        0 => rng.point().map(|x| 4.0 * (x - 0.5)),
        1 => {
            let s = rng.unit();
            std::array::from_fn(|k| a[k] + s * (b[k] - a[k]))
        }
        2 => a,
        _ => {
            // An edge or vertex of the octahedron's axis planes, met by a ray inside such a plane.
            let axis = rng.below(3);
            let origin: [f32; 3] = std::array::from_fn(|k| if k == axis { 0.0 } else { origin[k] });
            let mut direction = rng.point().map(|x| x - 0.5);
            direction[axis] = 0.0;
            return Ray::new(origin, if direction == [0.0; 3] { [1.0, 0.0, 0.0] } else { direction });
        }
    };
    let direction: [f32; 3] = std::array::from_fn(|k| target[k] - origin[k]);
    Ray::new(origin, direction)
}
