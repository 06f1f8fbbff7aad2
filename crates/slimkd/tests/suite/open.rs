//! Trees that are opened and not proved: the same answers from sound files, an error or a wrong answer from others, and always
//! an end.

use crate::common::{Rng, hard_rays, soup, variants};
use slimkd::{BuildOptions, FileError, KdTree, OpenTree, Preset, Ray, Tracer, TriangleMesh};
use std::sync::Arc;

const SHAPE: u32 = 2;
const NODES: u32 = 16;
const INDICES_4BYTE: u32 = 17;

fn written(tree: &KdTree) -> Vec<u8> {
    let mut bytes = Vec::new();
    tree.write(&mut bytes).unwrap();
    bytes
}

#[test]
fn an_open_tree_answers_as_the_proved_one() {
    let mesh = Arc::new(soup(2000, 1.0, 0.0, 3));
    let rays = hard_rays(&mesh, 1000, 1);
    for (variant, options) in variants() {
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        let bytes = written(&tree);
        let open = OpenTree::open(&bytes[..]).unwrap();
        assert_eq!((open.options(), open.bounds()), (tree.options(), tree.bounds()));
        for ray in &rays {
            assert_eq!(open.closest(ray), tree.closest(ray), "{variant} {ray:?}");
            assert_eq!(open.any(ray), tree.any(ray), "{variant} {ray:?}");
            assert_eq!(open.all(ray), tree.all(ray), "{variant} {ray:?}");
            let mut odd = |hit: &slimkd::Hit| hit.triangle % 2 == 1;
            assert_eq!(
                open.query().filter(&mut odd).closest(ray),
                tree.query().filter(&mut odd).closest(ray)
            );
            assert_eq!(open.query().filter(&mut odd).any(ray), tree.query().filter(&mut odd).any(ray));
            assert_eq!(open.query().filter(&mut odd).all(ray), tree.query().filter(&mut odd).all(ray));
        }
        // Batches and nearest points, and the mesh that an open tree has too.
        let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
        open.batch().threads(2).closest(&rays, &mut hits);
        open.batch().coherent().any(&rays, &mut any);
        for (ray, (hit, any)) in rays.iter().zip(hits.iter().zip(any)) {
            assert_eq!((*hit, any), (tree.closest(ray), tree.any(ray)), "{variant} {ray:?}");
            assert_eq!(open.nearest(ray.origin, 0.5), tree.nearest(ray.origin, 0.5), "{variant} {ray:?}");
        }
        assert_eq!(open.triangle_count(), mesh.len());
        assert_eq!((open.corners(7), open.triangle(7)), (tree.corners(7), Some(mesh.triangles()[7])));
        assert_eq!((open.corners(2000), open.triangle(2000)), (None, None));
        open.check().unwrap();
        assert!(written(&open.verify().unwrap()) == bytes);
        // Wherever the bytes begin.
        let mut shifted = vec![0];
        shifted.extend_from_slice(&bytes);
        let open = OpenTree::open(&shifted[1..]).unwrap();
        assert_eq!(open.closest(&rays[0]), tree.closest(&rays[0]));
        assert_eq!(OpenTree::open(bytes.clone()).unwrap().into_inner(), bytes);
    }
}

#[test]
fn what_the_table_shows_is_refused() {
    let mesh = soup(60, 1.0, 0.0, 4);
    let tree = KdTree::build(mesh, &BuildOptions::default()).unwrap();
    let bytes = written(&tree);
    for length in 0..bytes.len() {
        assert!(OpenTree::open(&bytes[..length]).is_err(), "cut to {length} of {}", bytes.len());
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(OpenTree::open(longer).is_err());
    let mut alone = Vec::new();
    tree.write_without_mesh(&mut alone).unwrap();
    assert!(matches!(OpenTree::open(alone), Err(FileError::MeshMissing { triangles: 60, .. })));
    let empty = written(&KdTree::build(TriangleMesh::default(), &BuildOptions::default()).unwrap());
    assert_eq!(OpenTree::open(empty).unwrap().closest(&Ray::new([0.0; 3], [1.0; 3])), None);
}

/// Also without checksums that fit: nobody looks at those of the arrays.
#[test]
fn whatever_the_arrays_hold_a_query_ends() {
    let mesh = soup(60, 1.0, 0.0, 4);
    let rays = hard_rays(&mesh, 40, 2);
    let mut rng = Rng::new(5);
    let (mut refused, mut broken, mut answered) = (0, 0, 0);
    for (_, options) in variants() {
        let bytes = written(&KdTree::build(mesh.clone(), &options).unwrap());
        for section in crate::skd::sections(&bytes) {
            for round in 0..200 {
                let mut damaged = bytes.clone();
                for _ in 0..1 + round % 5 {
                    let at = section.range.start + rng.below(section.range.len());
                    damaged[at] =
                        [damaged[at] ^ (1 << rng.below(8)), 0, 0xff, rng.bits() as u8][rng.below(4)];
                }
                crate::skd::sign(&mut damaged);
                let Ok(open) = OpenTree::open(&damaged[..]) else {
                    refused += 1;
                    continue;
                };
                let proved = open.verify().ok();
                for ray in &rays {
                    // Opened anew, since a tree does not forget what it met.
                    let open = OpenTree::open(&damaged[..]).unwrap();
                    let hits = open.all(ray);
                    match open.check() {
                        Err(_) => {
                            assert!(proved.is_none(), "what was proved is never broken");
                            broken += 1;
                        }
                        Ok(()) => {
                            answered += 1;
                            if let Some(proved) = &proved {
                                assert_eq!(hits, proved.all(ray));
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(refused > 1000 && broken > 1000 && answered > 100_000, "{refused} {broken} {answered}");
}

/// A standard tree's file with these nodes, as deep as it says.
fn forged(nodes: &[u64], depth: u64) -> Vec<u8> {
    let tree = KdTree::build(soup(2000, 1.0, 0.0, 4), &Preset::Standard.into()).unwrap();
    let mut parts = crate::skd::parts(&written(&tree));
    for (kind, content) in &mut parts {
        match *kind {
            NODES => *content = nodes.iter().flat_map(|node| node.to_le_bytes()).collect(),
            SHAPE => content[56..].copy_from_slice(&depth.to_le_bytes()),
            _ => {}
        }
    }
    assert!(parts.iter().any(|(kind, _)| *kind == INDICES_4BYTE));
    crate::skd::join(&parts)
}

/// An inner node at x = 0.5.
fn inner(children: u64) -> u64 {
    u64::from(0.5f32.to_bits()) << 32 | children << 3
}

fn leaf(first: u64, count: u64) -> u64 {
    count << 32 | first << 3 | 0b011
}

#[test]
fn shared_nodes_circles_and_shared_leaves_cost_no_time() {
    let across = Ray::new([0.5, 0.5, -1.0], [0.0, 0.0, 1.0]);
    // Children that overlap: 2^30 ways from the root, and one of 200 nodes.
    let mut shared: Vec<u64> = (0..200).map(|at| inner(at + 1)).collect();
    shared.extend([leaf(0, 0), leaf(0, 0)]);
    // Every leaf is all that there is.
    let mut leaves: Vec<u64> = (0..100_000).flat_map(|at| [inner(2 * at + 1), leaf(0, 1500)]).collect();
    leaves.push(leaf(0, 1500));
    let circle = vec![inner(0), leaf(0, 0)];
    let outside = vec![inner(1 << 28), leaf(0, 0)];
    for (name, nodes) in [("shared", shared), ("leaves", leaves), ("circle", circle), ("outside", outside)] {
        for depth in [0, 3, 64, 300, 60_000] {
            let bytes = forged(&nodes, depth);
            let open = OpenTree::open(bytes).unwrap();
            open.all(&across);
            assert!(open.check().is_err(), "{name} {depth}");
            assert!(open.verify().is_err(), "{name} {depth}");
        }
        assert!(OpenTree::open(forged(&nodes, 1 << 20)).is_err());
    }
}

/// A chain whose leaves share their indices is as deep as it says, and every pointer is inside.
#[test]
fn leaves_that_share_indices_are_refused() {
    let tree = KdTree::build(soup(2000, 1.0, 0.0, 4), &Preset::Standard.into()).unwrap();
    let indices =
        crate::skd::parts(&written(&tree)).iter().find(|part| part.0 == INDICES_4BYTE).unwrap().1.len() / 4;
    let chain = 200_000;
    let mut nodes = vec![inner(1)];
    for at in 1..chain {
        nodes.extend([leaf(0, indices as u64), inner(2 * at + 1)]);
    }
    nodes.extend([leaf(0, 0), leaf(0, 0)]);
    let refused = KdTree::read(&mut &forged(&nodes, chain)[..]);
    assert!(matches!(refused, Err(FileError::Damaged(what)) if what.contains("share")));
}
