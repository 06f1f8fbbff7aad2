//! Broken input is refused or harmless; nothing panics.

use crate::common::*;
use glam::Vec3;
use slimkd::{Progress, TriangleMesh};
use slimkd_render::{CameraError, RenderError, RenderSettings, default_lights, render, views};
use slimkd_scene::{Attribute, Camera, Light, Material, Scene, Texture};

const CAMERA: Camera = Camera { eye: Vec3::new(0.0, 1.0, 5.0), target: Vec3::ZERO, up: Vec3::Y, fov: 45.0 };

fn triangle() -> Scene {
    let mesh = TriangleMesh::new(vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
    Scene { mesh: mesh.unwrap().into(), materials: vec![Material::default()], ..Scene::default() }
}

fn attempt(
    scene: &Scene,
    camera: &Camera,
    lights: &[Light],
    settings: &RenderSettings,
) -> Option<RenderError> {
    render(scene, &tree(scene), camera, lights, settings, &Progress::new()).err()
}

#[test]
fn broken_scenes() {
    let small = RenderSettings::sized(16, 16);
    let refused = |scene: &Scene| attempt(scene, &CAMERA, &[], &small).expect("refused").to_string();
    let whole = triangle();
    assert!(refused(&Scene { material_ids: vec![1], ..whole.clone() }).contains("material ids"));
    let textured = Material { texture: Some(0), ..Material::default() };
    assert!(refused(&Scene { materials: vec![textured], ..whole.clone() }).contains("textures"));
    let short = Texture { width: 2, height: 2, texels: vec![[1.0; 3]] };
    assert!(refused(&Scene { textures: vec![short], ..whole.clone() }).contains("texture sizes"));
    let normals = Some(Attribute { values: vec![], indices: Some(vec![]) });
    assert!(refused(&Scene { normals, ..whole.clone() }).contains("normal indices"));
    let uvs = Some(Attribute { values: vec![], indices: Some(vec![]) });
    assert!(refused(&Scene { uvs, ..whole.clone() }).contains("coordinate indices"));

    let other = tree(&Scene::default());
    let result = render(&whole, &other, &CAMERA, &[], &small, &Progress::new());
    assert!(matches!(result, Err(RenderError::WrongTree { tree: 0, scene: 1 })));
}

#[test]
fn odd_but_harmless_scenes() {
    let small = RenderSettings::sized(16, 16);
    let odd = Material {
        shininess: f32::NAN,
        reflection: 7.0,
        transmission: f32::NAN,
        ior: 0.0,
        specular: Vec3::INFINITY,
        ..Material::default()
    };
    let normals = Some(Attribute { values: vec![[0.0; 3], [f32::NAN; 3], [1.0, 0.0, 0.0]], indices: None });
    let uvs = Some(Attribute { values: vec![[f32::NAN; 2]; 3], indices: None });
    let glassy = Material { reflection: 0.0, transmission: 1.0, ior: f32::NAN, ..odd.clone() };
    let texture = Texture { width: 0, height: 0, texels: vec![] };
    for materials in
        [vec![], vec![odd], vec![glassy], vec![Material { texture: Some(0), ..Material::default() }]]
    {
        let (normals, uvs, textures) = (normals.clone(), uvs.clone(), vec![texture.clone()]);
        let scene = Scene { materials, normals, uvs, textures, ..triangle() };
        let film = render(&scene, &tree(&scene), &CAMERA, &[], &small, &Progress::new()).unwrap();
        assert!(film.pixels().iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
    }
}

#[test]
fn no_geometry_shows_the_sky() {
    let vertices = vec![[f32::NAN; 3], [f32::INFINITY, 0.0, 0.0], [0.0; 3], [1e-30, 0.0, 0.0]];
    let broken = TriangleMesh::new(vertices, vec![[0, 1, 2], [2, 2, 2], [2, 3, 2]]).unwrap();
    for scene in [Scene::default(), Scene { mesh: broken.into(), ..Scene::default() }] {
        assert!(attempt(&scene, &CAMERA, &[], &RenderSettings::sized(8, 8)).is_none());
        assert!(views::find(&scene, &tree(&scene), 3).is_empty());
    }
}

#[test]
fn cameras_lights_and_settings() {
    let scene = triangle();
    let small = RenderSettings::sized(8, 8);
    let camera = |camera: Camera| match attempt(&scene, &camera, &[], &small) {
        Some(RenderError::Camera(error)) => error,
        other => panic!("{other:?}"),
    };
    assert_eq!(camera(Camera { target: CAMERA.eye, ..CAMERA }), CameraError::NoDirection);
    assert_eq!(camera(Camera { up: CAMERA.eye, ..CAMERA }), CameraError::UpParallel);
    assert_eq!(camera(Camera { fov: 180.0, ..CAMERA }), CameraError::FieldOfView(180.0));
    assert_eq!(camera(Camera { eye: Vec3::NAN, ..CAMERA }), CameraError::NotFinite);
    assert!(default_lights(&tree(&scene), &Camera { fov: 0.0, ..CAMERA }, Vec3::Y).is_empty());

    for light in [
        Light::Point { position: Vec3::NAN, intensity: Vec3::ONE },
        Light::Directional { direction: Vec3::ZERO, irradiance: Vec3::ONE },
    ] {
        assert!(matches!(attempt(&scene, &CAMERA, &[DARK, light], &small), Some(RenderError::Light(1))));
    }
    // In the light itself, and in its own eye.
    let within = Light::Point { position: Vec3::new(0.0, 0.5, 0.0), intensity: Vec3::splat(f32::MAX) };
    assert!(attempt(&scene, &CAMERA, &[within], &small).is_none());

    let wrong = |change: fn(&mut RenderSettings)| {
        let mut settings = small.clone();
        change(&mut settings);
        attempt(&scene, &CAMERA, &[], &settings).expect("refused")
    };
    assert!(matches!(wrong(|s| s.width = 0), RenderError::Film(_)));
    assert!(matches!(wrong(|s| s.samples = 0), RenderError::Setting { .. }));
    assert!(matches!(wrong(|s| s.max_depth = 1000), RenderError::Setting { .. }));
    assert!(matches!(wrong(|s| s.min_contribution = f32::NAN), RenderError::Setting { .. }));
}
