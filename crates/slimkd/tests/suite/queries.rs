//! Filters, skipped triangles, nearest points and refined hits, against brute force and exact arithmetic.

use crate::common::{Rng, hard_rays, soup, sphere, variants};
use slimkd::{
    BruteForce, HitColumns, InstructionSet, KdTree, Ray, RayColumns, RefinedHit, Tracer, TriangleMesh,
};
use std::sync::Arc;

fn meshes() -> Vec<(&'static str, Arc<TriangleMesh>)> {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..27u32 {
        let low = [i % 3, i / 3 % 3, i / 9].map(|x| x as f32);
        crate::common::push_box(&mut vertices, &mut triangles, low, [1.0; 3]);
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
                let mut odd = |hit: &slimkd::Hit| hit.triangle as usize % 3 != i % 3;
                let expected = oracle.query().filter(&mut odd).closest(ray);
                assert_eq!(tree.query().filter(&mut odd).closest(ray), expected, "{name} {variant} {ray:?}");
                assert_eq!(
                    tree.query().filter(&mut odd).any(ray),
                    expected.is_some(),
                    "{name} {variant} {ray:?}"
                );
                if i % 5 == 0 {
                    let mut all = oracle.all(ray);
                    if let Some(first) = all.first() {
                        let own = first.triangle;
                        let rest = oracle.query().filter(&mut |hit| hit.triangle != own).closest(ray);
                        assert_eq!(tree.query().except(own).closest(ray), rest, "{name} {variant} {ray:?}");
                        assert_eq!(tree.query().except(own).any(ray), rest.is_some());
                    }
                    if let Some(first) = all.first().copied() {
                        let others: Vec<_> =
                            all.iter().copied().filter(|hit| hit.triangle != first.triangle).collect();
                        assert_eq!(
                            tree.query().except(first.triangle).all(ray),
                            others,
                            "{name} {variant} {ray:?}"
                        );
                    }
                    all.retain(|hit| odd(hit));
                    assert_eq!(tree.query().filter(&mut odd).all(ray), all, "{name} {variant} {ray:?}");
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
            let own: Vec<_> = rays.iter().map(|ray| tree.closest(ray).map(|hit| hit.triangle)).collect();
            let accept = |ray: usize, hit: &slimkd::Hit| match ray % 3 {
                0 => true,
                1 => Some(hit.triangle) != own[ray],
                _ => hit.triangle as usize % 4 != ray % 4,
            };
            let single = |ray: usize| tree.query().filter(&mut |hit| accept(ray, hit)).closest(&rays[ray]);
            for count in [90, 5] {
                let rays = &rays[..count];
                let (mut hits, mut any) = (vec![None; count], vec![false; count]);
                for coherent in [true, false] {
                    let batch = tree.batch().filter(&accept);
                    let batch = if coherent { batch.coherent() } else { batch };
                    batch.closest(rays, &mut hits);
                    batch.any(rays, &mut any);
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
                let (hit, cost) = tree.cost(ray);
                assert_eq!(hit, tree.closest(ray), "{name} {variant} {ray:?}");
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
                let expected = oracle.nearest(point, f32::INFINITY);
                assert_eq!(tree.nearest(point, f32::INFINITY), expected, "{name} {variant} {point:?}");
                let found = expected.unwrap();
                let below = 0.99 * found.distance;
                assert_eq!(tree.nearest(point, below), oracle.nearest(point, below));
                assert_eq!(tree.nearest(point, 1.01 * found.distance), expected);
                let filtered = oracle
                    .query()
                    .filter(&mut |other| other.triangle != found.triangle)
                    .nearest(point, f32::INFINITY);
                let other = tree.query().except(found.triangle).nearest(point, f32::INFINITY);
                assert_eq!(other, filtered, "{name} {variant} {point:?}");
            }
            assert_eq!(tree.nearest([f32::NAN, 0.0, 0.0], f32::INFINITY), None);
            assert_eq!(tree.nearest([0.0; 3], f32::NAN), None);
            assert_eq!(tree.nearest([0.0; 3], -1.0), None);
        }
    }
    let nothing = KdTree::build(TriangleMesh::default(), &Default::default()).unwrap();
    assert_eq!(nothing.nearest([0.0; 3], f32::INFINITY), None);
}

#[test]
fn the_nearest_point_of_a_sphere_is_where_it_should_be() {
    let tree = KdTree::build(sphere(5), &Default::default()).unwrap();
    let mut rng = Rng::new(1);
    for _ in 0..2000 {
        let point: [f32; 3] = rng.point().map(|x| 6.0 * (x - 0.5));
        let length = point.iter().map(|x| x * x).sum::<f32>().sqrt();
        let found = tree.nearest(point, f32::INFINITY).unwrap();
        assert!((found.distance - (length - 1.0).abs()).abs() < 2e-3, "{point:?} {found:?}");
    }
}

/// Coordinates on a grid of 2⁻¹⁰: every determinant is exact in 128-bit integers.
#[test]
fn refined_hits_are_exact_to_the_last_bits() {
    let mut rng = Rng::new(2);
    let mut checked = 0;
    while checked < 20_000 {
        let mut grid = || std::array::from_fn::<i128, 3, _>(|_| i128::from(rng.bits() as i32 >> 9));
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
        let found = RefinedHit::new(&Ray::new(float(o), float(d)), &mesh.corners(0)).unwrap();
        for (found, part) in [(found.t, det(r, e1, e2)), (found.u, det(d, e2, r)), (found.v, det(d, r, e1))] {
            let expected = part as f64 / whole as f64;
            assert!((found - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(), "{found} {expected}");
        }
        checked += 1;
    }
}

/// A triangle that each ray leaves out, in batches of both orders with every instruction set; any hits too.
#[test]
fn batches_leave_out_a_triangle_a_ray() {
    for (name, mesh) in meshes() {
        let rays = hard_rays(&mesh, 300, 11);
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            let except: Vec<u32> = rays
                .iter()
                .enumerate()
                .map(|(i, ray)| tree.closest(ray).filter(|_| i % 4 != 0).map_or(u32::MAX, |hit| hit.triangle))
                .collect();
            let single = |i: usize| tree.query().except(except[i]).closest(&rays[i]);
            let expected: Vec<_> = (0..rays.len()).map(single).collect();
            let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
            for &set in InstructionSet::ALL.iter().filter(|set| set.is_available()) {
                for (coherent, threads) in [(false, 1), (true, 1), (true, 0)] {
                    let batch = tree.batch().except(&except).instruction_set(set).threads(threads);
                    let batch = if coherent { batch.coherent() } else { batch };
                    batch.closest(&rays, &mut hits);
                    batch.any(&rays, &mut any);
                    assert_eq!(hits, expected, "{name} {variant} {set:?} {coherent}");
                    assert!(
                        any.iter().zip(&expected).all(|(any, hit)| *any == hit.is_some()),
                        "{name} {variant}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_first_hits_are_the_first_of_all() {
    for (name, mesh) in meshes() {
        let rays = hard_rays(&mesh, 200, 13);
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            let mut first = Vec::new();
            for ray in &rays {
                let all = tree.all(ray);
                assert_eq!(tree.count(ray), all.len());
                for most in [0, 1, 2, 5, 1000] {
                    tree.query().first(ray, most, &mut first);
                    assert_eq!(first, all[..most.min(all.len())], "{name} {variant} {most} {ray:?}");
                }
            }
        }
    }
}

/// Columns, threads, and the verbs that only batches of single queries answer.
#[test]
fn every_form_of_a_batch_says_the_same() {
    let mesh = Arc::new(soup(500, 1.0, 0.0, 4));
    let tree = KdTree::build(Arc::clone(&mesh), &Default::default()).unwrap();
    let rays = hard_rays(&mesh, 9000, 17);
    let column = |of: fn(&slimkd::Ray) -> f32| rays.iter().map(of).collect::<Vec<f32>>();
    let origin = [column(|ray| ray.origin[0]), column(|ray| ray.origin[1]), column(|ray| ray.origin[2])];
    let direction =
        [column(|ray| ray.direction[0]), column(|ray| ray.direction[1]), column(|ray| ray.direction[2])];
    let (t_min, t_max) = (column(|ray| ray.t_min), column(|ray| ray.t_max));
    let columns = RayColumns::new(origin.each_ref().map(|x| &x[..]), direction.each_ref().map(|x| &x[..]))
        .with_range(&t_min, &t_max);
    let mut expected = vec![None; rays.len()];
    tree.batch().closest(&rays, &mut expected);
    for threads in [0, 1, 3] {
        let batch = tree.batch().threads(threads);
        let mut hits = vec![None; rays.len()];
        batch.closest(&rays, &mut hits);
        assert_eq!(hits, expected);
        batch.coherent().closest(columns, &mut hits);
        assert_eq!(hits, expected);
        let (mut t, mut triangle) = (vec![0.0; rays.len()], vec![0; rays.len()]);
        let (mut u, mut v) = (vec![0.0; rays.len()], vec![0.0; rays.len()]);
        batch.closest(columns, HitColumns::new(&mut t, &mut triangle).with_barycentrics(&mut u, &mut v));
        for (i, hit) in expected.iter().enumerate() {
            match hit {
                Some(hit) => assert_eq!((t[i], u[i], v[i], triangle[i]), (hit.t, hit.u, hit.v, hit.triangle)),
                None => assert_eq!((t[i], triangle[i]), (f32::INFINITY, u32::MAX)),
            }
        }
        let mut any = vec![false; rays.len()];
        batch.any(columns, &mut any);
        assert!(any.iter().zip(&expected).all(|(any, hit)| *any == hit.is_some()));
        let all = batch.all(&rays);
        let mut counts = vec![0; rays.len()];
        batch.count(columns, &mut counts);
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(all.of(i), tree.all(ray));
            assert_eq!(counts[i] as usize, all.of(i).len());
        }
        let points: Vec<[f32; 3]> = rays.iter().map(|ray| ray.origin).collect();
        let mut nearest = vec![None; points.len()];
        batch.nearest(&points, 0.25, &mut nearest);
        assert!(points.iter().zip(&nearest).all(|(point, found)| *found == tree.nearest(*point, 0.25)));
    }
    let tracer: &dyn Tracer = &tree;
    assert_eq!(tracer.query().except(3).closest(&rays[0]), tree.query().except(3).closest(&rays[0]));
    let mut hits = vec![None; rays.len()];
    tracer.batch().closest(&rays, &mut hits);
    assert_eq!(hits, expected);
}
