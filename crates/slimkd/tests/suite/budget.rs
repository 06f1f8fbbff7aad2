//! Trees that must fit a number of bytes.

use crate::common::{hard_rays, soup, sphere};
use slimkd::{
    BuildError, BuildOptions, EncodedTree, KdTree, Layout, Preset, Tracer, TreeBudget, TriangleMesh,
};
use std::sync::Arc;

#[test]
fn a_tree_fits_its_budget_and_uses_it() {
    for mesh in [sphere(5), soup(3000, 1.0, 0.0, 5)] {
        let mesh = Arc::new(mesh);
        let rays = hard_rays(&mesh, 2000, 3);
        for (preset, layout) in [
            (Preset::Slim, Layout::Dense),
            (Preset::Slim, Layout::TwoByte),
            (Preset::Slim, Layout::Wide),
            (Preset::Standard, Layout::FourByte),
            (Preset::PaperSmall, Layout::TwoByte),
        ] {
            let mut options = BuildOptions::from(preset);
            options.layout = layout;
            options.max_tree = None;
            let whole = KdTree::build(Arc::clone(&mesh), &options).unwrap();
            let all = whole.memory().tree();
            let mut cost = whole.statistics().sah_cost;
            for share in [1.0, 0.8, 0.5] {
                let most = (all as f64 * share) as u64;
                options.max_tree = Some(TreeBudget::Bytes(most));
                let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
                let bytes = tree.memory().tree();
                let context = format!("{layout:?}, {bytes} of {most}");
                let is_wide = matches!(tree.encoded(), EncodedTree::Wide { .. });
                assert_eq!(is_wide, layout == Layout::Wide, "{context}");
                assert!(bytes <= most && bytes as f64 > 0.75 * most as f64, "{context}");
                assert_eq!(tree.options().max_tree, None);
                assert!(tree.options().byte_weight >= options.byte_weight);
                // The weight that was found builds the same tree.
                let again = KdTree::build(Arc::clone(&mesh), tree.options()).unwrap();
                assert_eq!(again.memory(), tree.memory(), "{context}");
                if whole.options().collapse {
                    assert!(tree.statistics().sah_cost >= 0.999 * cost, "{context}: smaller and cheaper");
                    cost = tree.statistics().sah_cost;
                }
                for ray in &rays {
                    assert_eq!(tree.closest(ray), whole.closest(ray), "{context}");
                }
            }
        }
    }
}

#[test]
fn bytes_a_triangle_count_the_whole_mesh() {
    let mesh = Arc::new(sphere(4));
    let mut options = BuildOptions::default();
    options.max_tree = Some(TreeBudget::BytesPerTriangle(4.0));
    let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
    assert!(tree.memory().tree() <= 64 + 4 * mesh.len() as u64);
}

#[test]
fn what_cannot_fit_is_an_error() {
    let mut options = BuildOptions::default();
    options.max_tree = Some(TreeBudget::Bytes(16));
    match KdTree::build(sphere(3), &options) {
        Err(BuildError::TreeTooLarge { needed, limit: 16 }) => assert!(needed > 16),
        other => panic!("{other:?}"),
    }
    options.max_tree = Some(TreeBudget::BytesPerTriangle(f32::NAN));
    assert!(matches!(KdTree::build(sphere(3), &options), Err(BuildError::InvalidOption { .. })));
}

#[test]
fn presets_build_whatever_the_mesh() {
    let triangle =
        TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    for mesh in [TriangleMesh::default(), triangle, soup(40, 1.0, 0.0, 1), soup(5000, 1.0, 0.0, 2)] {
        for (preset, most) in [(Preset::Slim, 10), (Preset::Tiny, 7)] {
            let tree = KdTree::build(mesh.clone(), &preset.into()).unwrap();
            assert!(tree.memory().tree() <= 64 + most * mesh.len() as u64);
        }
    }
}
