//! Every query on every kind of tree against brute force, bit by bit.

use crate::common::{Rng, hard_rays, soup, variants};
use slimkd::{BruteForce, KdTree, Tracer, TriangleMesh};
use std::sync::Arc;

fn check(name: &str, mesh: &TriangleMesh, rays: usize) {
    let oracle = BruteForce::new(mesh);
    let rays = hard_rays(mesh, rays, 7);
    let mesh = Arc::new(mesh.clone());
    for (variant, options) in variants() {
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        let mut hits = 0;
        for ray in &rays {
            let expected = oracle.closest(ray);
            hits += usize::from(expected.is_some());
            assert_eq!(tree.closest(ray), expected, "{name} {variant} {ray:?}");
            assert_eq!(tree.any(ray), expected.is_some(), "{name} {variant} {ray:?}");
        }
        for ray in rays.iter().step_by(7) {
            assert_eq!(tree.all(ray), oracle.all(ray), "{name} {variant} {ray:?}");
        }
        assert!(hits * 10 > rays.len(), "{name}: the rays hit too little to prove anything: {hits}");
    }
}

#[test]
fn soups_of_every_scale() {
    for (scale, offset) in [(1.0, 0.0), (1e-20, 0.0), (1e12, 0.0), (1.0, 1000.0), (1e-3, 50.0)] {
        check(&format!("scale {scale} offset {offset}"), &soup(400, scale, offset, 1), 10_000);
    }
}

#[test]
fn a_grid_of_boxes_with_shared_planes() {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..4u32 {
        for j in 0..4u32 {
            for k in 0..4u32 {
                crate::common::push_box(
                    &mut vertices,
                    &mut triangles,
                    [i as f32, j as f32, k as f32],
                    [1.0; 3],
                );
            }
        }
    }
    check("grid of boxes", &TriangleMesh::new(vertices, triangles).unwrap(), 10_000);
}

#[test]
fn duplicates_and_coplanar_stacks_fall_to_the_lowest_id() {
    let mut rng = Rng::new(3);
    let base = soup(50, 1.0, 0.0, 2);
    let mut vertices = base.vertices().to_vec();
    let mut triangles: Vec<[u32; 3]> = base.triangles().iter().flat_map(|&t| [t; 9]).collect();
    for _ in 0..200 {
        let first = vertices.len() as u32;
        vertices.extend((0..3).map(|_| [rng.unit(), rng.unit(), 0.5]));
        triangles.push([first, first + 1, first + 2]);
    }
    check("duplicates", &TriangleMesh::new(vertices, triangles).unwrap(), 10_000);
}

#[test]
fn slivers_and_needles() {
    let mut rng = Rng::new(4);
    let mut vertices = Vec::new();
    for _ in 0..300 {
        let a = rng.point();
        let along = rng.point();
        let b: [f32; 3] = std::array::from_fn(|k| a[k] + 3.0 * (along[k] - 0.5));
        let c: [f32; 3] = std::array::from_fn(|k| a[k] + 1e-6 * rng.unit());
        vertices.extend([a, b, c]);
    }
    let triangles = (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    check("slivers", &TriangleMesh::new(vertices, triangles).unwrap(), 10_000);
}
