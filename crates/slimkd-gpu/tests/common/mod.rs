//! Scenes, rays, and how answers are compared.

#![allow(dead_code)] // each test file uses its part

use slimkd::{Hit, KdTree, Preset, Ray, Tracer, TriangleMesh};
use slimkd_gpu::{Device, GpuError, t_bound};
use std::sync::Arc;

/// The device that tests run on; `None`, with a line that says so, on a machine without one.
pub(crate) fn device() -> Option<Device> {
    match Device::open(None) {
        Ok(device) => Some(device),
        Err(GpuError::NoAdapter) => {
            println!("skipped: no GPU adapter on this machine (mesa-vulkan-drivers brings a software one)");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

pub(crate) fn scene(name: &str, triangles: usize) -> Arc<TriangleMesh> {
    slimkd_scene::procedural::generate(name, triangles).unwrap().mesh
}

pub(crate) fn build(mesh: &Arc<TriangleMesh>, preset: Preset) -> KdTree {
    KdTree::build(Arc::clone(mesh), &preset.into()).unwrap()
}

/// Rays from inside and outside, at vertices and edges, along axes and in planes, of odd lengths and ranges, and invalid ones.
pub(crate) fn rays(mesh: &TriangleMesh, tree: &KdTree, count: usize) -> Vec<Ray> {
    let mut random = fastrand::Rng::with_seed(7);
    let bounds = tree.bounds();
    let mut rays = Vec::with_capacity(count);
    for k in 0..count {
        let mut point = || -> [f32; 3] {
            std::array::from_fn(|a| {
                bounds.min[a] + (bounds.max[a] - bounds.min[a]) * (1.4 * random.f32() - 0.2)
            })
        };
        let (origin, towards) = (point(), point());
        let corners = mesh.corners(random.u32(0..mesh.len() as u32));
        let target = match k % 6 {
            0 | 1 => towards,
            2 => corners[random.usize(0..3)],
            3 => std::array::from_fn(|a| 0.5 * (corners[0][a] + corners[1][a])),
            _ => std::array::from_fn(|a| (corners[0][a] + corners[1][a] + corners[2][a]) / 3.0),
        };
        let mut direction: [f32; 3] = std::array::from_fn(|a| target[a] - origin[a]);
        match k % 10 {
            7 => direction = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]][k % 3],
            8 => direction = direction.map(|d| d * 1e-12),
            _ => {}
        }
        let ray = if k % 5 == 4 { Ray::new(target, direction) } else { Ray::new(origin, direction) };
        rays.push(match k % 400 {
            11 => ray.with_range(0.1, 0.9),
            12 => Ray::new([f32::NAN; 3], direction),
            13 => Ray::new(origin, [0.0; 3]),
            14 => ray.with_range(f32::NEG_INFINITY, f32::INFINITY),
            15 => ray.with_range(1.0, 0.5),
            16 => Ray::new([3e30; 3], [-1.0; 3]),
            _ => ray,
        });
    }
    rays
}

/// What is wrong with `found` where the CPU says `wanted`, if anything: it must be the same triangle, or one whose t is within
/// the stated bound. A hit that near to an end of the ray's range may be on either side of it.
pub(crate) fn complaint(tree: &KdTree, ray: &Ray, wanted: Option<Hit>, found: Option<Hit>) -> Option<String> {
    let near = |a: f32, b: f32| (a - b).abs() <= t_bound(ray, &tree.bounds(), a);
    let agree = match (wanted, found) {
        (None, None) => true,
        (Some(wanted), Some(found)) => near(wanted.t, found.t),
        _ => false,
    };
    let at_an_end =
        |hit: Option<Hit>| hit.is_some_and(|hit| near(hit.t, ray.t_min) || near(hit.t, ray.t_max));
    (!agree && !at_an_end(wanted) && !at_an_end(found))
        .then(|| format!("{found:?} where the CPU says {wanted:?}"))
}
