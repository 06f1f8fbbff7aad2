//! Rays in f64 and world coordinates: against integers of any length, against brute force on every kind of tree, and in files.

use crate::common::{Rng, hard_rays, soup, sphere, variants};
use num_bigint::{BigInt, Sign};
use slimkd::{
    BruteForce, Crossings, FileError, HitF64, KdTree, OpenTree, Preset, Ray, RayF64, Tracer, TriangleMesh,
};
use std::sync::Arc;

/// Numbers are whole multiples of 2⁻ᵁᴺᴵᵀ.
const UNIT: u32 = 400;

fn whole(x: f64) -> BigInt {
    let bits = x.to_bits();
    let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i64, bits & ((1 << 52) - 1));
    if exponent == 0 {
        assert_eq!(fraction, 0, "a number this small is not among the tests");
        return BigInt::ZERO;
    }
    let size = BigInt::from(fraction | 1 << 52) << (exponent - 1075 + i64::from(UNIT));
    if x < 0.0 { -size } else { size }
}

fn determinant(a: &[BigInt; 3], b: &[BigInt; 3], c: &[BigInt; 3]) -> BigInt {
    let minor = |i: usize, j: usize| &b[i] * &c[j] - &b[j] * &c[i];
    &a[0] * minor(1, 2) + &a[1] * minor(2, 0) + &a[2] * minor(0, 1)
}

/// The t of the ray's crossing with the closed triangle within its range, as numerator and denominator above 0.
fn crossing(ray: &RayF64, corners: &[[f32; 3]; 3]) -> Option<(BigInt, BigInt)> {
    let [a, b, c] = corners.map(|p| p.map(|x| whole(x.into())));
    let (o, d) = (ray.origin.map(whole), ray.direction.map(whole));
    let minus = |p: &[BigInt; 3], q: &[BigInt; 3]| std::array::from_fn::<BigInt, 3, _>(|k| &p[k] - &q[k]);
    let seen = [&a, &b, &c].map(|p| minus(p, &o));
    let sides = [(0, 1), (1, 2), (2, 0)].map(|(p, q)| determinant(&d, &seen[p], &seen[q]).sign());
    if sides.contains(&Sign::Plus) == sides.contains(&Sign::Minus) {
        return None;
    }
    let (e1, e2) = (minus(&b, &a), minus(&c, &a));
    let (mut above, mut below) = (determinant(&seen[0], &e1, &e2), determinant(&d, &e1, &e2));
    if below.sign() == Sign::Minus {
        (above, below) = (-above, -below);
    }
    let reaches = |t: f64| (&above << UNIT) - whole(t) * &below;
    let from = ray.t_min == f64::NEG_INFINITY || reaches(ray.t_min).sign() != Sign::Minus;
    let to = ray.t_max == f64::INFINITY || reaches(ray.t_max).sign() != Sign::Plus;
    (from && to).then_some((above, below))
}

/// Rays at vertices, edges and faces, from points that f32 cannot hold.
fn rays_f64(mesh: &TriangleMesh, count: usize, seed: u64) -> Vec<RayF64> {
    let mut rng = Rng::new(seed);
    hard_rays(mesh, count, seed)
        .into_iter()
        .map(|ray| {
            let [a, b, _] = mesh.corners(rng.below(mesh.len()) as u32).map(|p| p.map(f64::from));
            let near = 1e-9 * f64::from(rng.unit());
            let origin = ray.origin.map(|x| f64::from(x) * (1.0 + near));
            let target = match rng.below(4) {
                0 => a,
                1 => std::array::from_fn(|k| 0.5 * (a[k] + b[k])),
                2 => std::array::from_fn(|k| a[k] + near * (b[k] - a[k])),
                _ => return RayF64 { origin, ..in_f64(&ray) },
            };
            let direction: [f64; 3] = std::array::from_fn(|k| target[k] - origin[k]);
            let [t_min, t_max] =
                [[0.0, f64::INFINITY], [0.0, 1.0], [1.0, 3.0], [-2.0, 1.0 + near]][rng.below(4)];
            RayF64::new(origin, direction).with_range(t_min, t_max)
        })
        .collect()
}

fn in_f64(ray: &Ray) -> RayF64 {
    RayF64 {
        origin: ray.origin.map(f64::from),
        t_min: ray.t_min.into(),
        direction: ray.direction.map(f64::from),
        t_max: ray.t_max.into(),
    }
}

fn meshes() -> Vec<(&'static str, TriangleMesh)> {
    vec![
        ("sphere", sphere(2)),
        ("cells", crate::cells::Cells::new(3, 2).mesh(0.0)),
        ("soup", soup(100, 1.0, 0.0, 1)),
        ("far soup", soup(60, 1.0, 1000.0, 2)),
        ("tiny soup", soup(60, 1e-20, 0.0, 3)),
        ("huge soup", soup(60, 1e20, 0.0, 3)),
    ]
}

#[test]
fn hits_are_those_of_whole_numbers() {
    let mut seen = 0;
    for (name, mesh) in meshes() {
        let oracle = BruteForce::new(&mesh);
        for ray in rays_f64(&mesh, 120, 3) {
            let hits = oracle.all_f64(&ray);
            let mut ids: Vec<u32> = hits.iter().map(|hit| hit.triangle).collect();
            ids.sort_unstable();
            let expected: Vec<u32> =
                (0..mesh.len() as u32).filter(|&id| crossing(&ray, &mesh.corners(id)).is_some()).collect();
            assert_eq!(ids, expected, "{name} {ray:?}");
            for hit in &hits {
                let (above, below) = crossing(&ray, &mesh.corners(hit.triangle)).unwrap();
                // |t − N/D| ≤ 2⁻⁵⁰ · |N/D|, all times D.
                let apart = whole(hit.t) * &below - (&above << UNIT);
                let apart = if apart.sign() == Sign::Minus { -apart } else { apart };
                let size = if above.sign() == Sign::Minus { -above } else { above };
                assert!(apart << 50u32 <= size << UNIT, "{name} {ray:?} {hit:?}");
                assert!(hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v <= 1.0 + 1e-15, "{hit:?}");
            }
            assert_eq!(oracle.closest_f64(&ray), hits.first().copied(), "{name} {ray:?}");
            seen += hits.len();
        }
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn every_tree_says_what_brute_force_says() {
    let origin = [5.3e5, -1.8e5, 1e3];
    for (name, mesh) in meshes() {
        // The world's coordinates must not be so much larger than the mesh's that a ray of the world has no room for these.
        let origin = if name.starts_with("tiny") { [0.0; 3] } else { origin };
        let mesh = mesh.with_origin(origin);
        let oracle = BruteForce::new(&mesh);
        let rays: Vec<RayF64> = rays_f64(&mesh, 400, 5)
            .into_iter()
            .map(|ray| RayF64 { origin: [0, 1, 2].map(|k| ray.origin[k] + origin[k]), ..ray })
            .collect();
        let except: Vec<u32> = (0..rays.len() as u32).map(|i| i % mesh.len() as u32).collect();
        let accept = |at: usize, hit: &slimkd::Hit| !(at + hit.triangle as usize).is_multiple_of(3);
        type Answers =
            (Vec<Option<HitF64>>, Vec<Option<HitF64>>, Vec<bool>, Vec<Vec<HitF64>>, Vec<Crossings>);
        let ask = |tracer: &dyn Tracer| -> Answers {
            let mut closest = vec![None; rays.len()];
            let mut filtered = closest.clone();
            let mut any = vec![false; rays.len()];
            tracer.batch().threads(2).closest_f64(&rays, &mut closest);
            tracer.batch().except(&except).filter(&accept).closest_f64(&rays, &mut filtered);
            tracer.batch().except(&except).any_f64(&rays, &mut any);
            let mut hits = Vec::new();
            let lists = rays.iter().enumerate().map(|(i, ray)| {
                let most = [0, 1, 3, usize::MAX][i % 4];
                tracer.query().except(except[i]).first_f64(ray, most, &mut hits);
                hits.clone()
            });
            let lists = lists.collect();
            (closest, filtered, any, lists, rays.iter().map(|ray| tracer.crossings_f64(ray)).collect())
        };
        let expected = ask(&oracle);
        assert!(expected.0.iter().flatten().count() > 100, "{name}");
        for (i, ray) in rays.iter().enumerate().step_by(3) {
            let mut all = oracle.all_f64(ray);
            assert_eq!(all.first().copied(), expected.0[i]);
            assert_eq!(oracle.any_f64(ray), !all.is_empty());
            all.retain(|hit| hit.triangle != except[i]);
            assert_eq!(all.is_empty(), !expected.2[i]);
            all.truncate([0, 1, 3, usize::MAX][i % 4]);
            assert_eq!(all, expected.3[i], "{name} {ray:?}");
        }
        let shared = Arc::new(mesh.clone());
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&shared), &options).unwrap();
            assert_eq!(tree.origin(), origin);
            assert!(ask(&tree) == expected, "{name} {variant}");
        }
        let mut bytes = Vec::new();
        KdTree::build(Arc::clone(&shared), &Preset::Slim.into()).unwrap().write(&mut bytes).unwrap();
        assert!(ask(&OpenTree::open(bytes).unwrap()) == expected, "{name}, open");
    }
}

/// Rays in f32 that f64 holds as they are hit what they hit as f32, short of the rounding of f32.
#[test]
fn rays_of_f32_hit_the_same_in_f64() {
    let mesh = sphere(3);
    let tree = KdTree::build(mesh.clone(), &Preset::Slim.into()).unwrap();
    for ray in hard_rays(&mesh, 3000, 2) {
        let (single, double) = (tree.closest(&ray), tree.closest_f64(&in_f64(&ray)));
        let (Some(single), Some(double)) = (single, double) else { continue };
        let from = RayF64 { t_min: 0.0, ..in_f64(&ray) };
        let scale = from.direction.iter().map(|x| x.abs()).fold(0.0, f64::max);
        // They may lie on two sides of a fold where the ray starts on the surface or grazes it.
        if single.triangle == double.triangle {
            let refined = tree.refine_f64(&in_f64(&ray), double.triangle).unwrap();
            assert!((refined.t - double.t).abs() * scale < 1e-9 * (1.0 + double.t.abs() * scale), "{ray:?}");
            let across = (0..3).map(|k| refined.normal[k] * from.direction[k]).sum::<f64>().abs();
            // Six units of length at the angle at which the ray meets the triangle.
            let bound = 6.0 * 4.0 / f64::from(1 << 24);
            assert!((f64::from(single.t) - double.t).abs() * across < bound, "{ray:?} {single:?} {double:?}");
        }
    }
}

#[test]
fn points_of_the_world_are_inside_or_outside() {
    let origin = [528_980.0, 183_524.0, -40.0];
    let tree = KdTree::build(sphere(0).with_origin(origin), &Preset::Tiny.into()).unwrap();
    let near = 1e-9;
    for (offset, inside) in
        [([0.25, 0.25, 0.5 - near], true), ([0.25, 0.25, 0.5 + near], false), ([0.0; 3], true)]
    {
        let point = [0, 1, 2].map(|k| origin[k] + offset[k]);
        assert_eq!(tree.contains_f64(point), inside, "{offset:?}");
        let ray = RayF64::new(point, [1.0, -0.5, 0.25]);
        assert_eq!(tree.crossings_f64(&ray).signed(), i64::from(inside), "{offset:?}");
        assert_eq!(tree.any_f64(&ray), inside);
    }
    for odd in [f64::NAN, f64::INFINITY, 1e300, -1e300] {
        assert!(!tree.contains_f64([odd, origin[1], origin[2]]));
        assert_eq!(tree.closest_f64(&RayF64::new([odd, 0.0, 0.0], [1.0, 0.0, 0.0])), None);
        assert_eq!(tree.closest_f64(&RayF64::new(origin, [odd * 1e30, 0.0, 0.0])), None);
    }
    for direction in [[0.0; 3], [1e-305, 0.0, 0.0], [1.0, f64::NAN, 0.0]] {
        assert_eq!(tree.closest_f64(&RayF64::new(origin, direction)), None, "{direction:?}");
    }
    for size in [1e-300, 1e-30, 1e30, 1e300] {
        let hit = tree.closest_f64(&RayF64::new(origin, [0.0, size, size]));
        assert!(hit.is_some_and(|hit| (hit.t * size - 0.5).abs() < 1e-15), "{size} {hit:?}");
    }
    assert_eq!(tree.closest_f64(&RayF64::new(origin, [1.0; 3]).with_range(2.0, 1.0)), None);
}

#[test]
fn files_keep_the_origin() {
    let origin = [528_980.0, 183_524.0, 0.0];
    let near = KdTree::build(sphere(1), &Preset::Slim.into()).unwrap();
    let far = KdTree::build(sphere(1).with_origin(origin), &Preset::Slim.into()).unwrap();
    let written = |tree: &KdTree| {
        let mut bytes = Vec::new();
        tree.write(&mut bytes).unwrap();
        bytes
    };
    assert_ne!(near.mesh().content_hash(), far.mesh().content_hash());
    let bytes = written(&far);
    let read = KdTree::read(&bytes[..]).unwrap();
    assert_eq!((read.origin(), read.mesh()), (origin, far.mesh()));
    assert_eq!(written(&read), bytes);
    assert_eq!(OpenTree::open(bytes).unwrap().origin(), origin);
    // A mesh of another place is another mesh.
    let mut alone = Vec::new();
    far.write_without_mesh(&mut alone).unwrap();
    assert_eq!(KdTree::read_with_mesh(&alone[..], Arc::clone(far.mesh())).unwrap().origin(), origin);
    let wrong = KdTree::read_with_mesh(&alone[..], Arc::clone(near.mesh()));
    assert!(matches!(wrong, Err(FileError::MeshMismatch { .. })), "{wrong:?}");
    // Damage is found.
    let bytes = written(&far);
    for at in 0..bytes.len() {
        let mut bent = bytes.clone();
        bent[at] ^= 16;
        assert!(KdTree::read(&bent[..]).is_err(), "byte {at}");
    }
}
