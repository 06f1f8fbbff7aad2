//! What every tree must satisfy, whatever the scene.

use crate::common::{check_invariants, soup, sphere, variants};
use slimkd::{BuildOptions, KdTree, Preset, TreeStatistics, TriangleMesh};
use std::num::NonZeroUsize;
use std::sync::Arc;

fn meshes() -> Vec<(&'static str, TriangleMesh)> {
    let mut holes = soup(600, 1.0, 0.0, 9);
    let (mut vertices, mut triangles) = (holes.vertices().to_vec(), holes.triangles().to_vec());
    vertices.extend([[f32::NAN; 3], [f32::INFINITY, 0.0, 0.0]]);
    let bad = vertices.len() as u32 - 1;
    triangles.extend([[0, 1, bad], [0, 1, bad - 1], [5, 5, 6], [7, 7, 7]]);
    holes = TriangleMesh::new(vertices, triangles).unwrap();
    vec![("soup", soup(600, 1.0, 0.0, 5)), ("sphere", sphere(5)), ("soup with degenerate triangles", holes)]
}

#[test]
fn sizes_counts_and_histograms_agree() {
    for (name, mesh) in meshes() {
        let mesh = Arc::new(mesh);
        for (variant, options) in variants() {
            let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            check_invariants(name, &variant, &tree);
            let degenerate = if name == "soup with degenerate triangles" { 4 } else { 0 };
            assert_eq!(tree.statistics().degenerate, degenerate, "{name}, {variant}");
        }
    }
}

#[test]
fn the_slides_intervals_have_no_gap() {
    let intervals = TreeStatistics::DUPLICATION_INTERVALS;
    assert!(intervals.windows(2).all(|pair| pair[0].1 + 1 == pair[1].0));
    assert_eq!((intervals[0], intervals.len()), ((0, 0), 33));
}

#[test]
fn hoisting_saves_and_collapse_never_costs() {
    let mesh = Arc::new(soup(3000, 1.0, 0.0, 6));
    let build = |preset: Preset, collapse: bool| {
        let mut options = BuildOptions::from(preset);
        options.collapse = collapse;
        // With a weight, bytes may be bought with rays; and a bound on bytes sets a weight.
        (options.byte_weight, options.max_tree) = (0.0, None);
        KdTree::build(Arc::clone(&mesh), &options).unwrap()
    };
    let [standard, fast, small] =
        [Preset::Standard, Preset::PaperFast, Preset::PaperSmall].map(|p| build(p, false));
    assert!(fast.memory().tree() < standard.memory().tree());
    assert!(small.memory().tree() < fast.memory().tree());
    assert!(small.statistics().t_references > fast.statistics().t_references);
    for preset in Preset::ALL {
        let (plain, collapsed) = (build(*preset, false), build(*preset, true));
        assert!(collapsed.statistics().sah_cost <= plain.statistics().sah_cost * (1.0 + 1e-6), "{preset:?}");
        assert!(collapsed.memory().nodes <= plain.memory().nodes, "{preset:?}");
    }
}

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let mesh = Arc::new(sphere(6)); // more triangles than one thread builds alone
    for (variant, options) in variants() {
        let bytes = |threads: usize| {
            let mut options = options.clone();
            options.threads = NonZeroUsize::new(threads);
            let mut out = Vec::new();
            KdTree::build(Arc::clone(&mesh), &options).unwrap().write(&mut out).unwrap();
            out
        };
        let one = bytes(1);
        assert!(one == bytes(2) && one == bytes(5), "{variant}");
    }
}

#[test]
fn the_bytes_do_not_depend_on_threads_where_bytes_are_priced_by_a_sample() {
    let mesh = Arc::new(sphere(8)); // enough subtrees that only some are built in full
    let bytes = |threads: usize| {
        let mut options = BuildOptions::from(Preset::Slim);
        options.threads = NonZeroUsize::new(threads);
        let mut out = Vec::new();
        KdTree::build(Arc::clone(&mesh), &options).unwrap().write(&mut out).unwrap();
        out
    };
    assert!(bytes(1) == bytes(3));
}
