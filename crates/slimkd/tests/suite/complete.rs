//! Trees that lack a triangle where it should be: whatever is proved complete answers as brute force does.

use crate::common::{Rng, hard_rays, push_box, soup, sphere, variants};
use slimkd::{
    BruteForce, BuildOptions, Clipping, CompletenessError, FileError, KdTree, OpenTree, Preset, Progress,
    Ray, Tracer, TriangleMesh,
};
use std::sync::Arc;

const NODES: u32 = 16;
const INDICES_4BYTE: u32 = 17;
const INDICES_2BYTE: u32 = 18;
const DENSE: u32 = 19;

fn written(tree: &KdTree) -> Vec<u8> {
    let mut bytes = Vec::new();
    tree.write(&mut bytes).unwrap();
    bytes
}

/// Rooms whose walls share their planes.
fn boxes(edge: u32) -> TriangleMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..edge.pow(3) {
        let low = [i % edge, i / edge % edge, i / edge / edge].map(|x| x as f32 / 3.0);
        push_box(&mut vertices, &mut triangles, low, [1.0 / 3.0; 3]);
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

fn check(tree: &KdTree) -> Result<(), CompletenessError> {
    tree.check_complete(&Progress::new())
}

#[test]
fn every_tree_that_is_built_is_complete() {
    let turned = {
        // Walls at an angle whose corners are as good as on the planes of others.
        let walls = boxes(3);
        let turn = |[x, y, z]: &[f32; 3]| [0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y, *z];
        TriangleMesh::new(walls.vertices().iter().map(turn).collect(), walls.triangles().to_vec()).unwrap()
    };
    let stack = soup(30, 1.0, 0.0, 6);
    let stack = TriangleMesh::new(stack.vertices().to_vec(), stack.triangles().repeat(40)).unwrap();
    for (name, mesh) in [
        ("nothing", TriangleMesh::default()),
        ("soup", soup(1500, 1.0, 0.0, 1)),
        ("far soup", soup(300, 1.0, 1e6, 2)),
        ("tiny soup", soup(300, 1e-37, 0.0, 3)),
        ("huge soup", soup(300, 1e37, 0.0, 3)),
        ("boxes", boxes(4)),
        ("turned boxes", turned),
        ("sphere", sphere(4)),
        ("stack", stack),
    ] {
        let mesh = Arc::new(mesh);
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            let progress = Progress::new();
            assert_eq!(tree.check_complete(&progress), Ok(()), "{name}, {variant}");
            assert!(mesh.is_empty() || (progress.fraction() - 1.0).abs() < 1e-6);
        }
    }
}

/// One triangle of one leaf left out, many times.
#[test]
fn a_triangle_that_is_missing_from_a_leaf_is_named() {
    let mesh = soup(600, 1.0, 0.0, 4);
    let least = 0.6;
    // Where boxes are cut instead of triangles, half of all references are too many.
    let mut options = BuildOptions::from(Preset::Standard);
    options.clipping = Clipping::Exact;
    let whole = crate::skd::parts(&written(&KdTree::build(mesh, &options).unwrap()));
    let indices = whole.iter().position(|part| part.0 == INDICES_4BYTE).unwrap();
    let (mut found, mut more) = (0, 0);
    for at in (0..whole[indices].1.len()).step_by(4 * 13) {
        let mut forged = whole.clone();
        let ids = &mut forged[indices].1;
        let missing = u32::from_le_bytes(ids[at..at + 4].try_into().unwrap());
        // Another id of this or the next leaf in its place: one too many is no harm.
        let other = if at >= 4 { at - 4 } else { at + 4 };
        ids.copy_within(other..other + 4, at);
        let Ok(forged) = KdTree::read(&mut &crate::skd::join(&forged)[..]) else { continue };
        match check(&forged) {
            Err(CompletenessError::Missing { triangle }) => {
                assert_eq!(triangle, missing);
                found += 1;
            }
            Ok(()) => more += 1, // it touches the voxel
            Err(error) => panic!("{error}"),
        }
    }
    assert!(f64::from(found) > least * f64::from(found + more), "{found} found, {more} not");
}

/// What reading accepts and this proof too is right, however it came about.
#[test]
fn what_is_proved_complete_answers_right() {
    let mut rng = Rng::new(9);
    let (mut refused, mut wrong, mut right) = (0, 0, 0);
    for mesh in [soup(40, 1.0, 0.0, 4), boxes(2)] {
        let mut rays = hard_rays(&mesh, 200, 3);
        for id in 0..mesh.len() as u32 {
            let [a, b, c] = mesh.corners(id);
            let target: [f32; 3] = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
            let origin = rng.point().map(|x| 3.0 * x - 1.0);
            rays.push(Ray::new(origin, std::array::from_fn::<f32, 3, _>(|k| target[k] - origin[k])));
        }
        let oracle = BruteForce::new(&mesh);
        let expected: Vec<_> = rays.iter().map(|ray| oracle.all(ray)).collect();
        for (variant, options) in variants() {
            let bytes = written(&KdTree::build(mesh.clone(), &options).unwrap());
            for section in crate::skd::sections(&bytes) {
                if ![NODES, INDICES_4BYTE, INDICES_2BYTE, DENSE].contains(&section.kind) {
                    continue;
                }
                for round in 0..150 {
                    let mut forged = bytes.clone();
                    for _ in 0..1 + round % 2 {
                        let at = section.range.start + rng.below(section.range.len());
                        forged[at] = [forged[at] ^ (1 << rng.below(8)), rng.bits() as u8][rng.below(2)];
                    }
                    crate::skd::sign(&mut forged);
                    let Ok(tree) = KdTree::read(&mut &forged[..]) else { continue };
                    let complete = check(&tree);
                    let answers = rays.iter().map(|ray| tree.all(ray));
                    let same = answers.zip(&expected).all(|(found, expected)| found == *expected);
                    assert!(same || complete.is_err(), "{variant}: wrong, and not found");
                    refused += u32::from(complete.is_err());
                    *if same { &mut right } else { &mut wrong } += 1;
                }
            }
        }
    }
    assert!(
        wrong > 500 && right > 300 && refused < wrong + right / 2,
        "{refused} refused, {wrong} wrong, {right} right"
    );
}

#[test]
fn an_opened_tree_can_be_proved_complete_too() {
    let tree = KdTree::build(soup(60, 1.0, 0.0, 4), &Preset::Standard.into()).unwrap();
    let bytes = written(&tree);
    assert!(
        written(&OpenTree::open(&bytes[..]).unwrap().verify_complete(&Progress::new()).unwrap()) == bytes
    );
    let mut forged = crate::skd::parts(&bytes);
    let indices = forged.iter_mut().find(|part| part.0 == INDICES_4BYTE).unwrap();
    indices.1[4..].fill(0);
    for id in 0..60u32 {
        let at = 4 * id as usize;
        indices.1[at..at + 4].copy_from_slice(&id.to_le_bytes());
    }
    let forged = crate::skd::join(&forged);
    assert!(KdTree::read(&mut &forged[..]).is_ok(), "every triangle is somewhere");
    let refused = OpenTree::open(forged).unwrap().verify_complete(&Progress::new());
    assert!(matches!(refused, Err(FileError::Incomplete(CompletenessError::Missing { .. }))));
    let stopped = Progress::new();
    stopped.cancel();
    assert_eq!(tree.check_complete(&stopped), Err(CompletenessError::Cancelled));
}

/// Walls in one plane that is split again and again, and named nowhere but in the last leaf: the square of the size, were
/// it not for the bound.
#[test]
fn no_forged_tree_takes_for_ever() {
    let walls = 3000;
    let mut rng = Rng::new(3);
    let vertices: Vec<_> = (0..3 * walls)
        .map(|_| [0.5, rng.unit(), rng.unit()])
        .chain([[0.0; 3], [1.0; 3], [1.0, 0.0, 1.0]])
        .collect();
    let triangles = (0..=walls).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = TriangleMesh::new(vertices, triangles).unwrap();
    let tree = KdTree::build(mesh, &Preset::Standard.into()).unwrap();
    let mut parts = crate::skd::parts(&written(&tree));
    let (levels, leaf) = (15, 0b011u64);
    let inner = |children: u64| u64::from(0.5f32.to_bits()) << 32 | children << 3;
    let mut nodes: Vec<u64> = (0..(1 << levels) - 1).map(|at| inner(2 * at + 1)).collect();
    nodes.extend(vec![leaf; (1 << levels) - 1]);
    nodes.push(u64::from(walls + 1) << 32 | leaf);
    for (kind, content) in &mut parts {
        match *kind {
            NODES => *content = nodes.iter().flat_map(|node| node.to_le_bytes()).collect(),
            INDICES_4BYTE => *content = (0..=walls).flat_map(u32::to_le_bytes).collect(),
            2 => content[56..].copy_from_slice(&u64::from(levels as u32).to_le_bytes()),
            _ => {}
        }
    }
    let forged = KdTree::read(&mut &crate::skd::join(&parts)[..]).unwrap();
    assert_eq!(check(&forged), Err(CompletenessError::TooLong));
}
