//! Filters, skipped triangles, nearest points and refined hits, against brute force and exact arithmetic.

mod common;

use common::{Rng, hard_rays, soup, sphere, variants};
use slimkd::{BruteForce, KdTree, Ray, TriangleMesh};
use std::sync::Arc;

fn meshes() -> Vec<(&'static str, Arc<TriangleMesh>)> {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..27u32 {
        let low = [i % 3, i / 3 % 3, i / 9].map(|x| x as f32);
        common::push_box(&mut vertices, &mut triangles, low, [1.0; 3]);
    }
    let mut stacked = soup(40, 1.0, 0.0, 6).triangles().repeat(4);
    stacked.push([0, 0, 1]);
    vec![
        ("soup", Arc::new(soup(400, 1.0, 0.0, 1))),
        ("far soup", Arc::new(soup(200, 1.0, 1000.0, 2))),
        ("tiny soup", Arc::new(soup(200, 1e-20, 0.0, 3))),
        ("huge soup", Arc::new(soup(200, 1e30, 0.0, 3))),
        ("boxes", Arc::new(TriangleMesh::new(vertices, triangles).unwrap())),
        ("stack", Arc::new(TriangleMesh::new(soup(40, 1.0, 0.0, 6).vertices().to_vec(), stacked).unwrap())),
    ]
}

#[test]
fn filters_say_what_brute_force_says() {
    for (name, mesh) in meshes() {
        let oracle = BruteForce::new(&mesh);
        let rays = hard_rays(&mesh, 600, 5);
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            for (i, ray) in rays.iter().enumerate() {
                let odd = |hit: &slimkd::Hit| hit.triangle as usize % 3 != i % 3;
                let expected = oracle.closest_hit_where(ray, odd);
                assert_eq!(tree.closest_hit_where(ray, odd), expected, "{name} {variant} {ray:?}");
                assert_eq!(tree.any_hit_where(ray, odd), expected.is_some(), "{name} {variant} {ray:?}");
                if i % 5 == 0 {
                    let mut all = oracle.all_hits(ray);
                    if let Some(first) = all.first() {
                        let own = first.triangle;
                        let rest = oracle.closest_hit_where(ray, |hit| hit.triangle != own);
                        assert_eq!(tree.closest_hit_except(ray, own), rest, "{name} {variant} {ray:?}");
                        assert_eq!(tree.any_hit_except(ray, own), rest.is_some());
                    }
                    if let Some(first) = all.first().copied() {
                        let others: Vec<_> =
                            all.iter().copied().filter(|hit| hit.triangle != first.triangle).collect();
                        assert_eq!(
                            tree.all_hits_except(ray, first.triangle),
                            others,
                            "{name} {variant} {ray:?}"
                        );
                    }
                    all.retain(odd);
                    assert_eq!(tree.all_hits_where(ray, odd), all, "{name} {variant} {ray:?}");
                }
            }
        }
    }
}

/// Batches with a filter that knows the ray, in both orders; a batch too short for streams among them.
#[test]
fn filtered_batches_say_what_single_rays_say() {
    let bits = |hit: &Option<slimkd::Hit>| hit.map(|hit| [hit.t.to_bits(), hit.triangle]);
    for (name, mesh) in meshes() {
        let rays = hard_rays(&mesh, 90, 9);
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            let own: Vec<_> = rays.iter().map(|ray| tree.closest_hit(ray).map(|hit| hit.triangle)).collect();
            let accept = |ray: usize, hit: &slimkd::Hit| match ray % 3 {
                0 => true,
                1 => Some(hit.triangle) != own[ray],
                _ => hit.triangle as usize % 4 != ray % 4,
            };
            let single = |ray: usize| tree.closest_hit_where(&rays[ray], |hit| accept(ray, hit));
            for count in [90, 5] {
                let rays = &rays[..count];
                let (mut hits, mut any) = (vec![None; count], vec![false; count]);
                for coherent in [true, false] {
                    if coherent {
                        tree.closest_hits_coherent_where(rays, &mut hits, accept);
                        tree.any_hits_coherent_where(rays, &mut any, accept);
                    } else {
                        tree.closest_hits_where(rays, &mut hits, accept);
                        tree.any_hits_where(rays, &mut any, accept);
                    }
                    for ray in 0..count {
                        let expected = single(ray);
                        let context = format!("{name} {variant} {coherent} {:?}", rays[ray]);
                        assert_eq!(bits(&hits[ray]), bits(&expected), "{context}");
                        assert_eq!(any[ray], expected.is_some(), "{context}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_rays_cost_is_counted_and_its_hit_the_same() {
    for (name, mesh) in meshes() {
        let rays = hard_rays(&mesh, 100, 7);
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            for ray in &rays {
                let (hit, cost) = tree.closest_hit_cost(ray);
                assert_eq!(hit, tree.closest_hit(ray), "{name} {variant} {ray:?}");
                assert!(hit.is_none() || (cost.nodes > 0 && cost.tests > 0), "{name} {variant} {cost:?}");
            }
            let references: u64 = tree.references_per_triangle().iter().map(|&count| u64::from(count)).sum();
            assert_eq!(references, tree.statistics().references(), "{name} {variant}");
        }
    }
}

#[test]
fn nearest_points_are_brute_force_s() {
    for (name, mesh) in meshes() {
        let oracle = BruteForce::new(&mesh);
        let bounds = KdTree::build(Arc::clone(&mesh), &Default::default()).unwrap().bounds();
        let mut rng = Rng::new(8);
        let points: Vec<[f32; 3]> = (0..240)
            .map(|i| {
                if i % 4 == 0 {
                    return mesh.vertices()[rng.below(mesh.vertices().len())];
                }
                let grow = [1.0, 1.0, 1.2, 10.0][i % 4];
                std::array::from_fn(|k| {
                    let (middle, half) = (bounds.center()[k], 0.5 * bounds.max[k] - 0.5 * bounds.min[k]);
                    middle + grow * half * (2.0 * rng.unit() - 1.0)
                })
            })
            .collect();
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            for &point in &points {
                let expected = oracle.closest_point(point, f32::INFINITY);
                assert_eq!(tree.closest_point(point, f32::INFINITY), expected, "{name} {variant} {point:?}");
                let found = expected.unwrap();
                let below = 0.99 * found.distance;
                assert_eq!(tree.closest_point(point, below), oracle.closest_point(point, below));
                assert_eq!(tree.closest_point(point, 1.01 * found.distance), expected);
                let other = |triangle: u32| triangle != found.triangle;
                assert_eq!(
                    tree.closest_point_where(point, f32::INFINITY, other),
                    oracle.closest_point_where(point, f32::INFINITY, other),
                    "{name} {variant} {point:?}"
                );
            }
            assert_eq!(tree.closest_point([f32::NAN, 0.0, 0.0], f32::INFINITY), None);
            assert_eq!(tree.closest_point([0.0; 3], f32::NAN), None);
            assert_eq!(tree.closest_point([0.0; 3], -1.0), None);
        }
    }
    let nothing = KdTree::build(TriangleMesh::default(), &Default::default()).unwrap();
    assert_eq!(nothing.closest_point([0.0; 3], f32::INFINITY), None);
}

#[test]
fn the_nearest_point_of_a_sphere_is_where_it_should_be() {
    let tree = KdTree::build(sphere(5), &Default::default()).unwrap();
    let mut rng = Rng::new(1);
    for _ in 0..2000 {
        let point: [f32; 3] = rng.point().map(|x| 6.0 * (x - 0.5));
        let length = point.iter().map(|x| x * x).sum::<f32>().sqrt();
        let found = tree.closest_point(point, f32::INFINITY).unwrap();
        assert!((found.distance - (length - 1.0).abs()).abs() < 2e-3, "{point:?} {found:?}");
    }
}

/// Coordinates on a grid of 2⁻¹⁰: every determinant is exact in 128-bit integers.
#[test]
fn refined_hits_are_exact_to_the_last_bits() {
    let mut rng = Rng::new(2);
    let mut checked = 0;
    while checked < 20_000 {
        let mut grid = || std::array::from_fn::<i128, 3, _>(|_| i128::from(rng.next() as i32 >> 9));
        let (o, d) = (grid(), grid());
        // A thin triangle in a third of all cases.
        let a = grid();
        let b = grid();
        let thin = grid().map(|x| x >> 18);
        let c = if checked % 3 == 0 { std::array::from_fn(|k| (b[k] + a[k]) / 2 + thin[k]) } else { grid() };
        let minus = |p: [i128; 3], q: [i128; 3]| -> [i128; 3] { std::array::from_fn(|k| p[k] - q[k]) };
        let det = |a: [i128; 3], b: [i128; 3], c: [i128; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        let (e1, e2, r) = (minus(b, a), minus(c, a), minus(a, o));
        let whole = det(d, e1, e2);
        if whole == 0 {
            continue;
        }
        let float = |p: [i128; 3]| p.map(|x| x as f32 / 1024.0);
        let mesh = TriangleMesh::new(vec![float(a), float(b), float(c)], vec![[0, 1, 2]]).unwrap();
        let found = mesh.refine(&Ray::new(float(o), float(d)), 0).unwrap();
        for (found, part) in [(found.t, det(r, e1, e2)), (found.u, det(d, e2, r)), (found.v, det(d, r, e1))] {
            let expected = part as f64 / whole as f64;
            assert!((found - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(), "{found} {expected}");
        }
        checked += 1;
    }
}
