//! What every tree of boxes promises, whatever divides it.

use super::build;
use crate::geometry::{Aabb, TriangleMesh};
use crate::job::{Job, Progress};
use crate::options::{BuildOptions, Preset, Splits};
use crate::plan::{BoxForest, BoxNode, MOST};
use crate::threads;

struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }
}

/// Hills over a square of `edge` × `edge` cells, two triangles each.
fn hills(edge: u32) -> TriangleMesh {
    let mut random = Random(3);
    let line = edge + 1;
    let vertices =
        (0..line * line).map(|i| [(i % line) as f32, 3.0 * random.unit(), (i / line) as f32]).collect();
    let cells = (0..edge * edge).map(|i| i / edge * line + i % edge);
    let triangles = cells.flat_map(|a| [[a, a + 1, a + line], [a + 1, a + line + 1, a + line]]).collect();
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// Triangles of all sizes, long and thin ones among them.
fn soup(count: u32) -> TriangleMesh {
    let mut random = Random(9);
    let mut vertices = Vec::new();
    for i in 0..count {
        let size = [0.02, 0.1, 0.5, 1.5][i as usize % 4];
        let middle: [f32; 3] = std::array::from_fn(|_| random.unit());
        let thin = if i % 3 == 0 { 0.01 } else { 1.0 };
        for _ in 0..3 {
            vertices.push(std::array::from_fn(|k| {
                middle[k] + size * (random.unit() - 0.5) * if k == 1 { thin } else { 1.0 }
            }));
        }
    }
    TriangleMesh::new(vertices, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

fn forest(mesh: &TriangleMesh, splits: Splits, threads: usize) -> BoxForest {
    let options = BuildOptions::from(Preset::Slim).with_splits(splits);
    let progress = Progress::new();
    let job = Job::new(mesh, &options, &progress);
    let ids: Vec<u32> = (0..mesh.len() as u32).collect();
    let mut bounds = Aabb::EMPTY;
    mesh.vertices().iter().for_each(|&vertex| bounds.include(vertex));
    let built = threads::with(threads, || build(&ids, &bounds, 1.0, &job).unwrap());
    built.map_err(|refused| refused.why).unwrap()
}

/// Each node with its two children.
fn families(nodes: &[BoxNode]) -> impl Iterator<Item = [&BoxNode; 3]> {
    nodes.iter().enumerate().filter_map(|(at, node)| {
        let right = node.right()?;
        Some([node, &nodes[at + 1], &nodes[right]])
    })
}

#[test]
fn every_point_of_a_triangle_is_in_a_leaf_that_names_it() {
    for mesh in [hills(40), soup(3000)] {
        for splits in [Splits::Both, Splits::Space] {
            let forest = forest(&mesh, splits, 1);
            let mut boxes: Vec<Vec<Aabb>> = vec![Vec::new(); mesh.len()];
            for part in &forest.parts {
                for node in &part.nodes {
                    let ids = &part.references[node.references()];
                    assert!(ids.len() <= MOST);
                    ids.iter().for_each(|&id| boxes[id as usize].push(node.bounds));
                }
            }
            let mut random = Random(1);
            for (id, boxes) in boxes.iter().enumerate() {
                let [a, b, c] = mesh.corners(id as u32);
                for _ in 0..20 {
                    let (s, r) = (random.unit(), random.unit());
                    let (s, r) = if s + r > 1.0 { (1.0 - s, 1.0 - r) } else { (s, r) };
                    let point: [f32; 3] =
                        std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + r * (c[k] - a[k]));
                    let nearly = 1e-5;
                    assert!(
                        boxes.iter().any(|own| (0..3)
                            .all(|k| { own.min[k] - nearly <= point[k] && point[k] <= own.max[k] + nearly })),
                        "{splits}, triangle {id}"
                    );
                }
            }
        }
    }
}

#[test]
fn parents_hold_their_children() {
    let mesh = soup(20_000);
    for splits in [Splits::Both, Splits::Space] {
        let forest = forest(&mesh, splits, 2);
        for nodes in forest.parts.iter().map(|part| &part.nodes).chain([&forest.top]) {
            for [node, left, right] in families(nodes) {
                assert_eq!(node.bounds.union(&left.bounds).union(&right.bounds), node.bounds);
            }
        }
    }
}

#[test]
fn cells_do_not_overlap() {
    let mesh = hills(120);
    let forest = forest(&mesh, Splits::Space, 2);
    for nodes in forest.parts.iter().map(|part| &part.nodes).chain([&forest.top]) {
        for [_, left, right] in families(nodes) {
            let (left, right) = (left.bounds, right.bounds);
            // Planes lie on borders between bins, which round.
            let apart = |a: &Aabb, b: &Aabb| (0..3).any(|k| a.max[k] <= b.min[k] + 1e-4);
            assert!(apart(&left, &right) || apart(&right, &left), "{left:?} {right:?}");
        }
    }
}

#[test]
fn trees_are_the_same_at_any_number_of_threads() {
    // Large enough for bins that all threads fill.
    let mesh = hills(200);
    for splits in [Splits::Both, Splits::Space] {
        let one = forest(&mesh, splits, 1);
        assert!(one.parts.len() > 1);
        for threads in [2, 3] {
            assert!(forest(&mesh, splits, threads) == one, "{splits}, {threads} threads");
        }
    }
}

#[test]
fn the_same_triangle_many_times_is_divided_all_the_same() {
    let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [0.0, 1.0, 0.2]];
    let mesh = TriangleMesh::new(vertices, vec![[0, 1, 2]; 500]).unwrap();
    for splits in [Splits::Both, Splits::Space] {
        let forest = forest(&mesh, splits, 1);
        let leaves = forest.parts.iter().flat_map(|part| &part.nodes).filter(|node| node.right().is_none());
        assert!(leaves.map(|leaf| leaf.references().len()).all(|count| (1..=MOST).contains(&count)));
    }
}
