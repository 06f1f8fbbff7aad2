//! Automatic views: indoors where there is an inside, else around; always usable.

use crate::common::*;
use glam::Vec3;
use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
use slimkd_render::{RenderSettings, render, views};
use slimkd_scene::{Camera, Scene, load, procedural};
use std::path::PathBuf;

fn within(tree: &KdTree, point: Vec3) -> bool {
    let bounds = tree.bounds();
    (0..3).all(|k| bounds.min[k] < point[k] && point[k] < bounds.max[k])
}

/// Share of a coarse picture in which something is seen.
fn coverage(scene: &Scene, tree: &KdTree, camera: &Camera) -> f64 {
    render(scene, tree, camera, &[], &RenderSettings::sized(8, 8), &slimkd::Progress::new()).unwrap();
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let slope = (camera.fov.to_radians() / 2.0).tan();
    let hits = (0..64).filter(|k| {
        let across = |n: i32| ((n as f32 + 0.5) / 4.0 - 1.0) * slope;
        let direction = forward + right * across(k % 8) + right.cross(forward) * across(k / 8);
        tree.any(&Ray::new(camera.eye, direction))
    });
    hits.count() as f64 / 64.0
}

#[test]
fn built_in_rooms_are_seen_from_inside() {
    for name in ["kitchen", "conference"] {
        let scene = procedural::generate(name, 20_000).unwrap();
        let tree = tree(&scene);
        let found = views::find(&scene, &tree, 3);
        assert_eq!(found.len(), 3);
        assert_eq!(found, views::find(&scene, &tree, 3), "not deterministic");
        for camera in &found {
            assert!(within(&tree, camera.eye), "{name}: {camera:?}");
            assert!(coverage(&scene, &tree, camera) > 0.7, "{name}: {camera:?}");
        }
    }
}

#[test]
fn an_object_is_seen_from_outside() {
    let mut parts = Parts::default();
    parts.material(diffuse(Vec3::ONE)).sphere(Vec3::new(3.0, 1.0, -2.0), 1.0, 20);
    parts.cuboid(Vec3::new(2.5, 1.5, -2.5), Vec3::new(3.5, 3.0, -1.5));
    let (scene, tree) = parts.scene(true);
    let found = views::find(&scene, &tree, 3);
    assert_eq!(found.len(), 3);
    for camera in &found {
        assert!(!within(&tree, camera.eye), "{camera:?}");
        assert!(coverage(&scene, &tree, camera) > 0.1, "{camera:?}");
    }
}

#[test]
fn few_triangles_suffice() {
    for vertices in [
        vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        vec![[0.0, 5.0, 0.0], [1e-6, 5.0, 0.0], [0.0, 5.0, 1e-6]],
        vec![[0.0, 0.0, 0.0], [1e8, 0.0, 0.0], [0.0, 1e8, 1e8]],
    ] {
        let scene =
            Scene { mesh: TriangleMesh::new(vertices, vec![[0, 1, 2]]).unwrap().into(), ..Scene::default() };
        let tree = tree(&scene);
        assert!(views::find(&scene, &tree, 0).is_empty());
        for camera in views::find(&scene, &tree, 3) {
            coverage(&scene, &tree, &camera);
        }
        assert!(!views::find(&scene, &tree, 1).is_empty());
    }
}

/// Real scenes that lie beside the repository: a scan from outside, an atrium and a kitchen from inside.
#[test]
fn real_scenes() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    for (name, inside) in
        [("scan_stanford_bunny", false), ("sponza_dabrovic", true), ("bart_kitchen_101015", true)]
    {
        let path = folder.join(format!("{name}.ply.zst"));
        if !path.exists() {
            println!("skipped: {name} is not there");
            continue;
        }
        let scene = load(&path).unwrap();
        let tree = KdTree::build(scene.mesh.clone(), &BuildOptions::default()).unwrap();
        let found = views::find(&scene, &tree, 3);
        assert_eq!(found.len(), 3);
        for camera in &found {
            assert_eq!(camera.up, Vec3::Y);
            assert_eq!(within(&tree, camera.eye), inside, "{name}: {camera:?}");
            assert!(coverage(&scene, &tree, camera) > if inside { 0.7 } else { 0.1 }, "{name}: {camera:?}");
        }
    }
}
