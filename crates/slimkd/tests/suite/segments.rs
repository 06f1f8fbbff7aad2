//! What lies between two points: ends on surfaces hide nothing, whatever tree and batch are asked.

use crate::common::{Rng, push_box, soup, variants};
use slimkd::{BruteForce, KdTree, Preset, Segment, Tracer, TriangleMesh};
use std::sync::Arc;

/// A box, turned in space and moved.
fn turned_box(offset: f32, scale: f32) -> TriangleMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    push_box(&mut vertices, &mut triangles, [-1.0, -0.7, -0.4], [2.0, 1.4, 0.8]);
    let (s, c) = 0.7f32.sin_cos();
    let turn = |[x, y, z]: [f32; 3]| {
        let (x, y) = (c * x - s * y, s * x + c * y);
        let (y, z) = (c * y - s * z, s * y + c * z);
        [x, y, z].map(|x| scale * (x + offset))
    };
    TriangleMesh::new(vertices.into_iter().map(turn).collect(), triangles).unwrap()
}

/// A point of a triangle, rounded.
fn point_on(mesh: &TriangleMesh, id: u32, rng: &mut Rng) -> [f32; 3] {
    let corners = mesh.corners(id);
    let u = rng.unit();
    slimkd::Hit { t: 0.0, u, v: (1.0 - u) * rng.unit(), triangle: id }.point(&corners).map(|x| x as f32)
}

#[test]
fn points_on_the_walls_of_a_box_see_each_other() {
    let mut rng = Rng::new(4);
    for (offset, scale) in [(0.0, 1.0), (1000.0, 1.0), (-3.0, 1e-20), (50.0, 1e6)] {
        let mesh = turned_box(offset, scale);
        let tree = KdTree::build(mesh.clone(), &Preset::Slim.into()).unwrap();
        let mut segments = Vec::new();
        while segments.len() < 5000 {
            let ids = [rng.below(12) as u32, rng.below(12) as u32];
            // Two triangles of a wall see each other only in its plane.
            if ids[0] / 2 != ids[1] / 2 {
                let [from, to] = ids.map(|id| point_on(&mesh, id, &mut rng));
                segments.push(Segment { from, to });
            }
        }
        let mut visible = vec![false; segments.len()];
        tree.batch().threads(2).visible(&segments, &mut visible);
        for (segment, visible) in segments.iter().zip(&visible) {
            assert!(visible, "{offset} {scale} {segment:?}");
            assert_eq!(tree.visible(segment.to, segment.from), *visible, "{segment:?}");
        }
        let mut closed = vec![false; segments.len()];
        tree.batch().closed().visible(&segments, &mut closed);
        assert!(closed.iter().filter(|visible| !**visible).count() > 2500);
        // From outside, the wall in between hides all.
        let centre = std::array::from_fn(|k| 0.5 * (tree.bounds().min[k] + tree.bounds().max[k]));
        for segment in &segments[..100] {
            let beyond = std::array::from_fn(|k| segment.to[k] + 0.5 * (segment.to[k] - centre[k]));
            assert!(!tree.visible(centre, beyond), "{segment:?}");
            assert!(tree.visible(centre, segment.to), "{segment:?}");
        }
    }
}

#[test]
fn every_tree_and_batch_sees_the_same() {
    let mesh = Arc::new(soup(300, 1.0, 5.0, 6));
    let oracle = BruteForce::new(&mesh);
    let mut rng = Rng::new(8);
    let mut end = || {
        let id = rng.below(mesh.len()) as u32;
        let point = point_on(&mesh, id, &mut rng);
        if rng.below(2) == 0 { point } else { point.map(|x| x + 0.01 * rng.unit()) }
    };
    let mut segments: Vec<Segment> = (0..1500).map(|_| Segment { from: end(), to: end() }).collect();
    segments[5].to = segments[5].from;
    segments[6].to[1] = f32::NAN;
    let except: Vec<u32> = (0..segments.len() as u32).map(|i| i % 40).collect();
    let accept = |at: usize, hit: &slimkd::Hit| !(at + hit.triangle as usize).is_multiple_of(3);
    let mut expected = [(); 3].map(|()| vec![false; segments.len()]);
    let ask = |tracer: &dyn Tracer, out: &mut [Vec<bool>; 3]| {
        tracer.batch().visible(&segments, &mut out[0]);
        tracer.batch().except(&except).filter(&accept).threads(2).visible(&segments, &mut out[1]);
        tracer.batch().coherent().closed().visible(&segments, &mut out[2]);
    };
    ask(&oracle, &mut expected);
    assert!(expected[0][5] && expected[0][6]);
    for expected in &expected {
        let visible = expected.iter().filter(|visible| **visible).count();
        assert!((10..1450).contains(&visible), "{visible}");
    }
    for (variant, options) in variants() {
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        let mut found = [(); 3].map(|()| vec![false; segments.len()]);
        ask(&tree, &mut found);
        assert_eq!(found, expected, "{variant}");
    }
}

#[test]
fn the_first_hits_of_a_batch_are_those_of_its_rays() {
    let tree = KdTree::build(soup(300, 1.0, 0.0, 6), &Preset::Slim.into()).unwrap();
    let rays = crate::common::hard_rays(tree.mesh(), 200, 1);
    for most in [0, 1, 3, usize::MAX] {
        let all = tree.batch().threads(2).first(&rays, most);
        let mut hits = Vec::new();
        for (i, ray) in rays.iter().enumerate() {
            tree.query().first(ray, most, &mut hits);
            assert_eq!(all.of(i), hits, "{ray:?}");
        }
    }
}
