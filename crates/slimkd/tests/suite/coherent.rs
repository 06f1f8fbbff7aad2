//! Packets and groups against single rays, bit by bit, with every instruction set that is here.

use crate::common::{Rng, hard_rays, soup, variants};
use slimkd::{BuildOptions, Hit, InstructionSet, KdTree, Ray, Tracer, TriangleMesh};
use std::sync::Arc;

fn available() -> impl Iterator<Item = InstructionSet> {
    InstructionSet::ALL.iter().copied().filter(|set| set.is_available())
}

fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.triangle])
}

fn check(name: &str, tree: &KdTree, rays: &[Ray]) {
    let closest: Vec<_> = rays.iter().map(|ray| bits(tree.closest(ray))).collect();
    for set in available() {
        let mut hits = vec![None; rays.len()];
        tree.batch().instruction_set(set).coherent().closest(rays, &mut hits);
        let mut any = vec![false; rays.len()];
        tree.batch().instruction_set(set).coherent().any(rays, &mut any);
        for (index, ray) in rays.iter().enumerate() {
            assert_eq!(bits(hits[index]), closest[index], "{name} {} ray {index} {ray:?}", set.name());
            assert_eq!(any[index], closest[index].is_some(), "{name} {} ray {index} {ray:?}", set.name());
        }
    }
}

/// Tiles of 8 × 8 rays from one eye, aimed at corners and edges of triangles and around them.
fn fans(mesh: &TriangleMesh, count: usize, seed: u64) -> Vec<Ray> {
    let mut rng = Rng::new(seed);
    let eyes = hard_rays(mesh, count, seed);
    let mut rays = Vec::new();
    for eye in eyes.iter().map(|ray| ray.origin) {
        let [a, b, c] = mesh.corners(rng.below(mesh.len()) as u32);
        let spread = [0.01, 0.1, 1.0, 4.0][rng.below(4)];
        for pixel in 0..64 {
            let (x, y) =
                (spread * ((pixel % 8) as f32 / 4.0 - 1.0), spread * ((pixel / 8) as f32 / 4.0 - 1.0));
            let target: [f32; 3] = std::array::from_fn(|k| a[k] + x * (b[k] - a[k]) + y * (c[k] - a[k]));
            let direction: [f32; 3] = std::array::from_fn(|k| target[k] - eye[k]);
            let ray = Ray::new(eye, direction);
            rays.push(if rng.below(50) == 0 { ray.with_range(0.0, 1.0) } else { ray });
        }
    }
    rays
}

/// The same rays from points to one light.
fn towards_a_light(mesh: &TriangleMesh, count: usize, seed: u64) -> Vec<Ray> {
    let light = hard_rays(mesh, 1, seed)[0].origin;
    let flip = |ray: Ray| {
        let start = ray.at(0.75);
        Ray::new(start, std::array::from_fn::<f32, 3, _>(|k| light[k] - start[k])).with_range(0.0, 1.0)
    };
    fans(mesh, count, seed).into_iter().map(flip).collect()
}

fn check_all(name: &str, mesh: TriangleMesh) {
    let mesh = Arc::new(mesh);
    let hard = hard_rays(&mesh, 1000, 11);
    let (fans, light) = (fans(&mesh, 20, 12), towards_a_light(&mesh, 10, 13));
    for (variant, options) in variants() {
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        check(&format!("{name} {variant} hard"), &tree, &hard);
        check(&format!("{name} {variant} fans"), &tree, &fans);
        check(&format!("{name} {variant} light"), &tree, &light);
    }
}

#[test]
fn soups_of_every_scale() {
    for (scale, offset) in [(1.0, 0.0), (1e-20, 0.0), (1e12, 0.0), (1.0, 1000.0), (1e-3, 50.0)] {
        check_all(&format!("scale {scale} offset {offset}"), soup(400, scale, offset, 1));
    }
}

#[test]
fn boxes_with_shared_planes_and_ties() {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..27u32 {
        let low = [(i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32];
        crate::common::push_box(&mut vertices, &mut triangles, low, [1.0; 3]);
    }
    triangles.extend(triangles.clone());
    check_all("boxes", TriangleMesh::new(vertices, triangles).unwrap());
}

#[test]
fn slivers() {
    let mut rng = Rng::new(4);
    let mut vertices = Vec::new();
    for _ in 0..200 {
        let (a, along) = (rng.point(), rng.point());
        vertices.push(a);
        vertices.push(std::array::from_fn(|k| a[k] + 3.0 * (along[k] - 0.5)));
        vertices.push(std::array::from_fn(|k| a[k] + 1e-6 * rng.unit()));
    }
    let triangles = (0..200).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    check_all("slivers", TriangleMesh::new(vertices, triangles).unwrap());
}

#[test]
fn axis_parallel_views_and_rays_inside_split_planes() {
    let mesh = Arc::new(soup(300, 1.0, 0.0, 5));
    let tree = KdTree::build(Arc::clone(&mesh), &BuildOptions::default()).unwrap();
    let mut rays = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            for pixel in 0..256 {
                let mut origin = mesh.vertices()[pixel * 3];
                origin[axis] = -2.0 * sign;
                // Zeros of either sign: neighbours then descend differently on an axis that they do not move along.
                let zero = if pixel % 3 == 0 { -0.0 } else { 0.0 };
                rays.push(Ray::new(
                    origin,
                    std::array::from_fn::<_, 3, _>(|k| if k == axis { sign } else { zero }),
                ));
            }
        }
    }
    check("axis-parallel", &tree, &rays);
}

#[test]
fn batches_of_every_length_and_invalid_rays_among_good_ones() {
    let mesh = Arc::new(soup(300, 1.0, 0.0, 6));
    let tree = KdTree::build(Arc::clone(&mesh), &BuildOptions::default()).unwrap();
    let mut rays = fans(&mesh, 4, 7);
    for length in (0..70).chain([127, 128, 129, 255]) {
        check("length", &tree, &rays[..length]);
    }
    let mut rng = Rng::new(8);
    for ray in &mut rays {
        match rng.below(12) {
            0 => ray.direction[rng.below(3)] = f32::NAN,
            1 => ray.origin[rng.below(3)] = f32::INFINITY,
            2 => ray.direction = [0.0; 3],
            3 => (ray.t_min, ray.t_max) = (2.0, 1.0),
            4 => ray.t_min = f32::NAN,
            5 => ray.direction = ray.direction.map(|x| x * 1e-38),
            6 => ray.direction = ray.direction.map(|x| (x * 1e38).clamp(f32::MIN, f32::MAX)),
            _ => {}
        }
    }
    check("invalid", &tree, &rays);
}

#[test]
fn an_empty_mesh_and_a_scene_at_the_end_of_f32() {
    let nothing = TriangleMesh::new(Vec::new(), Vec::new()).unwrap();
    let rays = hard_rays(&soup(10, 1.0, 0.0, 1), 100, 1);
    check("empty", &mut KdTree::build(nothing, &BuildOptions::default()).unwrap(), &rays);
    let huge = soup(100, 4e37, 0.0, 9);
    let rays = hard_rays(&huge, 500, 2);
    check("huge", &mut KdTree::build(huge, &BuildOptions::default()).unwrap(), &rays);
}
