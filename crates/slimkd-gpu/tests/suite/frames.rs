//! Whole pictures: the twin's and the GPU's against the CPU's.
#![cfg(feature = "render")]

use crate::common::{build, device};
use glam::Vec3;
use slimkd::{KdTree, Preset, Progress, TriangleMesh};
use slimkd_gpu::frame::{Frame, FrameError, GpuScene};
use slimkd_gpu::twin::{Picture, Twin};
use slimkd_gpu::{Device, GpuError, Image, UploadOptions};
use slimkd_render::{Film, RenderError, RenderSettings, Setup, render, views};
use slimkd_scene::{Attribute, Camera, Light, Material, Scene, Texture, UpAxis, procedural};

/// Share of the pixels that may differ by more than 1/255 in a channel.
const UNLIKE: f64 = 1e-3;

fn settings(width: u32, height: u32) -> RenderSettings {
    let mut settings = RenderSettings::sized(width, height);
    settings.samples = 2;
    settings
}

/// Something of everything that shading knows: a floor with a texture, half of it without coordinates; smooth balls of mirror, glass
/// and clay; a lamp and a sun.
fn still_life() -> (Scene, Camera) {
    let (mut vertices, mut triangles, mut normals) = (Vec::new(), Vec::new(), Vec::new());
    let (mut ids, mut corners) = (Vec::new(), Vec::new());
    for (x, z) in [(-6.0, 6.0), (6.0, 6.0), (6.0, -6.0), (-6.0, -6.0)] {
        vertices.push([x, 0.0, z]);
        normals.push([0.0, 2.0, 0.0]);
    }
    triangles.extend([[0, 1, 2], [0, 2, 3]]);
    ids.extend([0, 0]);
    corners.extend([[0, 1, 2], [u32::MAX, 0, 0]]);
    for (ball, center) in
        [Vec3::new(-1.6, 1.0, -0.6), Vec3::new(0.4, 0.8, 1.2), Vec3::new(1.9, 1.0, -0.8)].iter().enumerate()
    {
        let base = vertices.len() as u32;
        let rows = 12;
        for row in 0..=rows {
            let (ring, height) = (row as f32 / rows as f32 * std::f32::consts::PI).sin_cos();
            for column in 0..=2 * rows {
                let (sin, cos) = (column as f32 / rows as f32 * std::f32::consts::PI).sin_cos();
                let normal = Vec3::new(ring * cos, height, ring * sin);
                vertices.push((*center + normal * center.y).to_array());
                normals.push(normal.to_array());
            }
        }
        for row in 0..rows {
            for column in 0..2 * rows {
                let a = base + row * (2 * rows + 1) + column;
                let b = a + 2 * rows + 1;
                triangles.extend([[a, a + 1, b], [a + 1, b + 1, b]]);
                ids.extend([ball as u32 + 1; 2]);
                corners.extend([[u32::MAX, 0, 0]; 2]);
            }
        }
    }
    let texels = (0..12).map(|k| [0.2 + 0.06 * k as f32, 0.5, 0.9 - 0.05 * k as f32]).collect();
    let mut materials = vec![Material::default(); 4];
    materials[0].texture = Some(0);
    materials[1].reflection = 0.8;
    materials[2].transmission = 1.0;
    materials[2].specular = Vec3::splat(0.4);
    materials[3].diffuse = Vec3::new(0.7, 0.25, 0.15);
    materials[3].specular = Vec3::splat(0.3);
    materials[3].shininess = 60.0;
    let scene = Scene {
        name: "still life".to_owned(),
        mesh: TriangleMesh::new(vertices, triangles).unwrap().into(),
        materials,
        material_ids: ids,
        normals: Some(Attribute { values: normals, indices: None }),
        uvs: Some(Attribute { values: vec![[0.0, 0.0], [5.0, 0.0], [5.0, 5.0]], indices: Some(corners) }),
        textures: vec![Texture { width: 4, height: 3, texels }],
        lights: vec![
            Light::Point { position: Vec3::new(-3.0, 5.0, 3.0), intensity: Vec3::splat(12.0) },
            Light::Directional { direction: Vec3::new(-0.5, -1.0, -0.4), irradiance: Vec3::splat(0.5) },
        ],
        up: Some(UpAxis::Y),
        ..Scene::default()
    };
    let eye = Vec3::new(0.5, 2.4, 6.5);
    (scene, Camera { eye, target: Vec3::new(0.1, 0.8, 0.0), up: Vec3::Y, fov: 40.0 })
}

fn built_in(name: &str) -> (Scene, Camera) {
    let scene = procedural::generate(name, 4_000).unwrap();
    let camera = views::of_scene(&scene, &build(&scene.mesh, Preset::Slim), 1)[0];
    (scene, camera)
}

fn cpu(scene: &Scene, tree: &KdTree, camera: &Camera, settings: &RenderSettings) -> Film {
    render(scene, tree, camera, &scene.lights, settings, &Progress::new()).unwrap()
}

fn twin(scene: &Scene, tree: &KdTree, camera: &Camera, settings: &RenderSettings) -> Film {
    let setup = Setup::new(scene, tree, camera, &scene.lights, settings).unwrap();
    let mut image = Image::new(tree).unwrap();
    let (frame, lights) = Frame::append(&mut image, scene).unwrap().of_picture(&setup, settings);
    let picture = Picture::new(Twin::new(&image, 12), &frame, &lights);
    let mut film = Film::new(settings.width, settings.height).unwrap();
    for (index, pixel) in film.pixels_mut().iter_mut().enumerate() {
        let index = index as u32;
        *pixel = picture.pixel(index % settings.width, index / settings.width);
    }
    film
}

fn gpu(
    device: &Device,
    (scene, tree, camera): (&Scene, &KdTree, &Camera),
    settings: &RenderSettings,
    options: &UploadOptions,
) -> (Film, u32) {
    let setup = Setup::new(scene, tree, camera, &scene.lights, settings).unwrap();
    let gpu = GpuScene::upload(device, scene, tree, options).unwrap();
    let progress = Progress::new();
    let (film, _) = gpu.render(&setup, settings, &progress).unwrap();
    assert_eq!(progress.fraction(), 1.0);
    (film, gpu.shards())
}

fn assert_alike(scene: &Scene, wanted: &Film, found: &Film, by: &str) {
    let apart = wanted.share_apart(found);
    assert!(apart <= UNLIKE, "{}: {apart} of {by}'s pixels are unlike the CPU's", scene.name);
}

#[test]
fn the_twin_shows_the_cpus_picture() {
    for ((scene, camera), preset) in
        [(still_life(), Preset::Slim), (built_in("conference"), Preset::PaperSmall)]
    {
        let (tree, settings) = (build(&scene.mesh, preset), settings(64, 48));
        let wanted = cpu(&scene, &tree, &camera, &settings);
        assert_alike(&scene, &wanted, &twin(&scene, &tree, &camera, &settings), "the twin");
    }
}

#[test]
fn the_gpu_shows_the_cpus_picture() {
    let Some(device) = device() else { return };
    for ((scene, camera), preset) in [
        (still_life(), Preset::Tiny),
        (built_in("kitchen"), Preset::Slim),
        (built_in("conference"), Preset::PaperFast),
    ] {
        let (tree, settings) = (build(&scene.mesh, preset), settings(64, 48));
        let wanted = cpu(&scene, &tree, &camera, &settings);
        let (film, _) = gpu(&device, (&scene, &tree, &camera), &settings, &UploadOptions::default());
        assert_alike(&scene, &wanted, &film, "the GPU");
        assert_alike(&scene, &twin(&scene, &tree, &camera, &settings), &film, "the GPU (by the twin)");
        let (wanted, found) = (wanted.rays(), film.rays());
        assert_eq!(wanted.primary, found.primary);
        let (wanted, found) = (wanted.total() as f64, found.total() as f64);
        assert!((wanted - found).abs() < 0.002 * wanted, "{wanted} rays on the CPU, {found} on the GPU");
    }
}

#[test]
fn shards_and_workgroups_do_not_show() {
    let Some(device) = device() else { return };
    let (scene, camera) = still_life();
    let (tree, settings) = (build(&scene.mesh, Preset::PaperSmall), settings(40, 30));
    let parts = (&scene, &tree, &camera);
    let (wanted, _) = gpu(&device, parts, &settings, &UploadOptions::default());
    let mut small = UploadOptions::default();
    (small.binding_limit, small.stack, small.block) = (Some(16 << 10), 1, [8, 8]);
    let (film, shards) = gpu(&device, parts, &settings, &small);
    assert!(shards > 3, "{shards} shards");
    assert!(film == wanted, "{} of the pixels differ", wanted.share_apart(&film));
}

#[test]
fn cancelled_and_lost_are_errors() {
    let Some(device) = device() else { return };
    let (scene, camera) = still_life();
    let (tree, settings) = (build(&scene.mesh, Preset::Slim), settings(8, 8));
    let setup = Setup::new(&scene, &tree, &camera, &scene.lights, &settings).unwrap();
    let gpu = GpuScene::upload(&device, &scene, &tree, &UploadOptions::default()).unwrap();
    let progress = Progress::new();
    progress.cancel();
    let error = gpu.render(&setup, &settings, &progress).unwrap_err();
    assert!(matches!(error, FrameError::Render(RenderError::Cancelled)), "{error}");
    device.destroy();
    let error = gpu.render(&setup, &settings, &Progress::new()).unwrap_err();
    assert!(matches!(error, FrameError::Gpu(GpuError::Lost(_))), "{error}");
}
