//! Property tests: whatever a mesh holds, the tree says what brute force says.

use crate::common::{hard_rays, variants};
use proptest::prelude::*;
use slimkd::{BruteForce, KdTree, Ray, Tracer, TriangleMesh};
use std::sync::Arc;

/// Coordinates that collide often, lie far apart, or are nothing at all.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        8 => (-4i8..5).prop_map(|x| f32::from(x) * 0.25),
        4 => -1.0f32..1.0,
        1 => prop::sample::select(vec![1e-38, -1e-30, 1e-6, 1e7, -1e12, 3e30, f32::NAN, f32::INFINITY]),
    ]
}

fn mesh() -> impl Strategy<Value = TriangleMesh> {
    (prop::collection::vec(prop::array::uniform3(coordinate()), 3..60), any::<u64>(), 1usize..120).prop_map(
        |(vertices, seed, triangles)| {
            let mut rng = crate::common::Rng::new(seed);
            let count = vertices.len();
            let triangles =
                (0..triangles).map(|_| std::array::from_fn(|_| rng.below(count) as u32)).collect();
            TriangleMesh::new(vertices, triangles).unwrap()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn any_soup_agrees_with_brute_force(mesh in mesh(), seed in any::<u64>()) {
        let mesh = Arc::new(mesh);
        let oracle = BruteForce::new(&mesh);
        let rays = hard_rays(&mesh, 200, seed);
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            for ray in &rays {
                let expected = oracle.closest(ray);
                prop_assert_eq!(tree.closest(ray), expected, "{} {:?}", variant, ray);
                prop_assert_eq!(tree.any(ray), expected.is_some(), "{} {:?}", variant, ray);
                prop_assert_eq!(tree.all(ray), oracle.all(ray), "{} {:?}", variant, ray);
            }
        }
    }

    #[test]
    fn no_ray_is_too_odd(
        origin in prop::array::uniform3(prop::num::f32::ANY), direction in prop::array::uniform3(prop::num::f32::ANY),
        t_min in prop::num::f32::ANY, t_max in prop::num::f32::ANY,
    ) {
        let mesh = crate::common::soup(100, 1.0, 0.0, 1);
        let tree = KdTree::build(mesh.clone(), &Default::default()).unwrap();
        let ray = Ray { origin, direction, t_min, t_max };
        prop_assert_eq!(tree.closest(&ray), BruteForce::new(&mesh).closest(&ray));
    }
}

#[test]
fn an_empty_mesh_builds_and_is_never_hit() {
    let nothing = [
        TriangleMesh::default(),
        TriangleMesh::new(vec![[0.0; 3]], vec![[0, 0, 0]]).unwrap(),
        TriangleMesh::new(vec![[f32::NAN; 3]; 3], vec![[0, 1, 2]]).unwrap(),
    ];
    for mesh in nothing {
        for (variant, options) in variants() {
            let tree = KdTree::build(mesh.clone(), &options).unwrap();
            let ray = Ray::new([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]);
            assert_eq!((tree.closest(&ray), tree.any(&ray)), (None, false), "{variant}");
            assert!(tree.all(&ray).is_empty());
            assert_eq!(tree.statistics().nodes.leaf, 1);
            assert!(tree.bounds().is_empty());
        }
    }
}
