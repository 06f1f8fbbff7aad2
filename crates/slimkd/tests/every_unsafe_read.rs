//! Everything that reads without bounds checks, in little: `scripts/memcheck` runs it under Valgrind. Sizes are such that pieces,
//! lanes and last entries are met: an array's last element is where a read goes wrong first.

mod common;

use common::{hard_rays, push_box, soup, variants};
use slimkd::{InstructionSet, KdTree, OpenTree, Progress, Tracer, TriangleMesh};
use std::sync::Arc;

/// Shared planes, and leaves of more than one piece of ids.
fn stacked_boxes() -> TriangleMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    push_box(&mut vertices, &mut triangles, [0.0; 3], [1.0; 3]);
    push_box(&mut vertices, &mut triangles, [1.0, 0.0, 0.0], [1.0; 3]);
    TriangleMesh::new(vertices, triangles.repeat(9)).unwrap()
}

#[test]
fn every_query_on_every_kind_of_tree() {
    for mesh in [soup(70, 1.0, 0.0, 1), stacked_boxes(), soup(1, 1.0, 0.0, 2)] {
        let mesh = Arc::new(mesh);
        let rays = hard_rays(&mesh, 83, 3);
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            let single: Vec<_> = rays.iter().map(|ray| tree.closest(ray)).collect();
            let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
            for &set in InstructionSet::ALL.iter().filter(|set| set.is_available()) {
                let batch = tree.batch().instruction_set(set);
                batch.closest(&rays, &mut hits);
                assert_eq!(hits, single, "{variant} {set:?}");
                batch.coherent().closest(&rays, &mut hits);
                assert_eq!(hits, single, "{variant} {set:?}");
                batch.any(&rays, &mut any);
                assert!(any.iter().zip(&single).all(|(any, hit)| *any == hit.is_some()));
                batch.coherent().any(&rays, &mut any);
                assert!(any.iter().zip(&single).all(|(any, hit)| *any == hit.is_some()));
            }
            let mut file = Vec::new();
            tree.write(&mut file).unwrap();
            let open = OpenTree::open(&file[..]).unwrap();
            let read = open.verify_complete(&Progress::new()).unwrap();
            assert_eq!(read.statistics(), tree.statistics());
            for (ray, hit) in rays.iter().zip(&single) {
                assert_eq!(open.closest(ray), *hit);
                assert_eq!(read.all(ray).first(), hit.as_ref());
                read.nearest(ray.origin, 1.0);
            }
        }
    }
}
