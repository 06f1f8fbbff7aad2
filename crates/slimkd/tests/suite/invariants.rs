//! What every tree must satisfy, whatever the scene.

use crate::common::{soup, sphere, variants};
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
            let (s, m) = (tree.statistics(), tree.memory());
            let context = format!("{name}, {variant}");
            // The slides' size formula.
            let r = &s.leaf_references;
            let plain = 8 * (s.nodes.inner + s.nodes.t_inner + s.nodes.leaf)
                + 8 * s.nodes.t_inner
                + 4 * r.four_byte
                + 2 * r.two_byte;
            if r.other == 0 {
                assert_eq!(m.tree(), plain, "{context}");
            } else {
                // 4 bytes an inner node, at most 8 a leaf's header, at most 5 a further reference, 8 behind the end.
                let least = 4 * s.nodes.inner + s.nodes.leaf + 8;
                let most = least + 4 * s.nodes.inner + 7 * s.nodes.leaf + 5 * r.other;
                assert!((least..=most).contains(&m.tree()), "{context}");
            }
            assert_eq!(
                m.resident(),
                m.tree() + 12 * (mesh.vertices().len() + mesh.len()) as u64,
                "{context}"
            );
            assert_eq!(s.nodes.leaf, s.nodes.inner + s.nodes.t_inner + 1, "{context}");
            assert_eq!(s.t_references, s.nodes.t_inner, "{context}");
            assert_eq!(s.duplication[0], 0, "{context}: a triangle is lost");
            assert_eq!(s.duplication.iter().sum::<u64>(), s.triangles - s.degenerate, "{context}");
            assert_eq!(s.leaf_depths.iter().sum::<u64>(), s.nodes.leaf, "{context}");
            assert_eq!(s.leaf_depths.len(), s.max_depth as usize + 1, "{context}");
            assert!(s.leaf_depths[s.max_depth as usize] > 0, "{context}");
            assert!(s.nodes.empty_leaf < s.nodes.leaf, "{context}");
            assert_eq!(
                s.degenerate,
                if name == "soup with degenerate triangles" { 4 } else { 0 },
                "{context}"
            );
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
