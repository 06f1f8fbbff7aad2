//! Every built-in scene, small, on every kind of tree, against brute force.

use crate::oracle::{check_invariants, common::variants, compare};
use slimkd::KdTree;
use slimkd_scene::procedural;
use std::sync::Arc;

/// Small enough for brute force, large enough for every thing that a scene has.
const TRIANGLES: usize = 8_000;

#[test]
fn built_in_scenes_agree_with_brute_force() {
    for scene in procedural::list() {
        let mesh = procedural::generate(scene.name, TRIANGLES).unwrap().mesh;
        let trees: Vec<_> = variants()
            .into_iter()
            .map(|(variant, options)| (variant, KdTree::build(Arc::clone(&mesh), &options).unwrap()))
            .collect();
        for (variant, tree) in &trees {
            check_invariants(scene.name, variant, tree);
        }
        compare(&mesh, &trees).verdict(scene.name);
    }
}
