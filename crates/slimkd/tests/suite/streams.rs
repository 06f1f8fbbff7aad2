//! Batches against single rays, bit by bit, with every instruction set that is here.

use crate::common::{Rng, hard_rays, soup, variants};
use slimkd::{BuildOptions, Hit, InstructionSet, KdTree, Layout, Preset, Ray, Tracer, TriangleMesh};
use std::sync::Arc;

/// Instruction sets to test.
fn sets() -> impl Iterator<Item = InstructionSet> {
    InstructionSet::ALL.iter().copied().filter(|set| set.is_available())
}

/// Both batch queries with all instruction sets, in one batch.
fn check(name: &str, tree: &KdTree, rays: &[Ray]) {
    let closest: Vec<Option<Hit>> = rays.iter().map(|ray| tree.closest(ray)).collect();
    let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
    for set in sets() {
        // Answers of another batch must not stay.
        hits.fill(Some(Hit { t: -1.0, u: 0.0, v: 0.0, triangle: 0 }));
        tree.batch().instruction_set(set).closest(rays, &mut hits);
        for (i, (hit, expected)) in hits.iter().zip(&closest).enumerate() {
            assert_eq!(bits(hit), bits(expected), "{name} {} {i} {:?}", set.name(), rays[i]);
        }
        for (i, answer) in any.iter_mut().enumerate() {
            *answer = i % 2 == 0;
        }
        tree.batch().instruction_set(set).any(rays, &mut any);
        for (i, (any, expected)) in any.iter().zip(&closest).enumerate() {
            assert_eq!(*any, expected.is_some(), "{name} {} {i} {:?}", set.name(), rays[i]);
        }
    }
}

fn bits(hit: &Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.triangle])
}

#[test]
fn hard_rays_through_every_kind_of_tree() {
    for (scale, offset) in [(1.0, 0.0), (1e-20, 0.0), (1e12, 0.0), (1.0, 1000.0)] {
        let mesh = Arc::new(soup(400, scale, offset, 1));
        let rays = hard_rays(&mesh, 1500, 7);
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            check(&format!("scale {scale} offset {offset} {variant}"), &tree, &rays);
        }
    }
}

#[test]
fn shared_planes_duplicates_and_large_leaves() {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..3u32 {
        for j in 0..3u32 {
            crate::common::push_box(&mut vertices, &mut triangles, [i as f32, j as f32, 0.0], [1.0; 3]);
        }
    }
    // A hundred times the same triangle: one leaf holds them all, and the lowest id wins.
    let twin = triangles[5];
    triangles.extend([twin; 100]);
    let mesh = Arc::new(TriangleMesh::new(vertices, triangles).unwrap());
    let rays = hard_rays(&mesh, 3000, 8);
    for (variant, options) in variants() {
        check(&variant, &mut KdTree::build(Arc::clone(&mesh), &options).unwrap(), &rays);
    }
}

#[test]
fn batches_of_any_length() {
    let mesh = Arc::new(soup(300, 1.0, 0.0, 2));
    let rays = hard_rays(&mesh, 200, 9);
    for options in [Preset::Standard, Preset::PaperSmall, Preset::Slim].map(BuildOptions::from) {
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        for length in (0..=40).chain([63, 64, 65, 200]) {
            check(&format!("{length} rays"), &tree, &rays[..length]);
        }
    }
}

#[test]
fn invalid_rays_between_others_miss_alone() {
    let mesh = Arc::new(soup(300, 1.0, 0.0, 3));
    let mut rays = hard_rays(&mesh, 600, 10);
    let mut rng = Rng::new(11);
    for i in 0..rays.len() {
        let ray = &mut rays[i];
        let axis = rng.below(3);
        match rng.below(12) {
            0 => ray.origin[axis] = f32::NAN,
            1 => ray.origin[axis] = f32::INFINITY,
            2 => ray.direction[axis] = f32::NAN,
            3 => ray.direction[axis] = f32::NEG_INFINITY,
            4 => ray.direction = [0.0, -0.0, 0.0],
            5 => *ray = ray.with_range(2.0, 1.0),
            6 => *ray = ray.with_range(f32::NAN, 1.0),
            7 => *ray = ray.with_range(0.0, f32::NAN),
            8 => ray.origin = [1e30, 1e30, 1e30],
            9 => ray.direction = ray.direction.map(|x| x * 1e-44),
            _ => (),
        }
    }
    for (variant, options) in variants() {
        check(&variant, &mut KdTree::build(Arc::clone(&mesh), &options).unwrap(), &rays);
    }
    // Whole vectors of nothing but invalid rays.
    let invalid = vec![Ray::new([0.0; 3], [0.0; 3]); 100];
    check("invalid", &mut KdTree::build(mesh, &BuildOptions::default()).unwrap(), &invalid);
}

#[test]
fn trees_deeper_than_the_small_stack() {
    // Ever smaller triangles towards the origin: splits cut off a few at a time.
    let mut vertices = Vec::new();
    for i in 0..900 {
        let size = 0.93f32.powi(i);
        for corner in [[1.0, 0.9, 0.8], [0.9, 1.0, 0.8], [0.8, 0.9, 1.0]] {
            vertices.push(corner.map(|x: f32| x * size));
        }
    }
    let triangles = (0..900).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = Arc::new(TriangleMesh::new(vertices, triangles).unwrap());
    let rays = hard_rays(&mesh, 600, 12);
    let mut options = BuildOptions::from(Preset::Standard);
    options.leaf_at_most = 1;
    options.sah.intersection = 1000.0;
    for layout in [Layout::FourByte, Layout::Dense] {
        options.layout = layout;
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        assert!(tree.statistics().max_depth > 64, "{}", tree.statistics().max_depth);
        check("deep", &tree, &rays);
    }
}

#[test]
fn an_empty_mesh_and_a_single_triangle() {
    let rays: Vec<Ray> = (0..50).map(|i| Ray::new([0.02 * i as f32, 0.2, 1.0], [0.0, 0.0, -1.0])).collect();
    let one = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    for mesh in [TriangleMesh::default(), one] {
        for (variant, options) in variants() {
            check(&variant, &mut KdTree::build(mesh.clone(), &options).unwrap(), &rays);
        }
    }
}
