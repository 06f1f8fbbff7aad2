//! Pictures against those in `tests/golden`. After a change that is meant to alter them, regenerate them with
//! `SLIMKD_UPDATE_GOLDEN=1 cargo test -p slimkd-render --test suite golden::`, and look at each before committing it.
//!
//! A picture that fails is written to the system's folder for temporary files, for comparison.

use crate::common::*;
use glam::Vec3;
use slimkd_render::{BitDepth, Development, Film, RenderSettings};
use slimkd_scene::{Camera, Material};
use slimkd_util::png;
use std::path::Path;

/// Largest mean difference of a channel, of 255: another processor's rounding moves single pixels only.
const MEAN: f64 = 0.5;

/// Occlusion is pinned, so that a new default for it is no new picture.
fn settings() -> RenderSettings {
    let mut settings = RenderSettings::sized(96, 72);
    settings.occlusion = 2;
    settings
}

fn compare(name: &str, film: &Film) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(format!("{name}.png"));
    let development = Development::default();
    if std::env::var_os("SLIMKD_UPDATE_GOLDEN").is_some() {
        film.save(&path, &development, BitDepth::Eight).unwrap();
    }
    let golden = png::read(&std::fs::read(&path).unwrap(), |_| Ok(1 << 30)).unwrap().1.into_flattened();
    let ours = film.to_srgb8(&development);
    assert_eq!(golden.len(), ours.len(), "{name}: the size differs");
    let apart: f64 = golden.iter().zip(&ours).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    let mean = apart / ours.len() as f64;
    if mean > MEAN {
        let failed = std::env::temp_dir().join(format!("slimkd-golden-{name}.png"));
        film.save(&failed, &development, BitDepth::Eight).unwrap();
        panic!("{name}: {mean:.2} of 255 apart on average; see {}", failed.display());
    }
}

#[test]
fn balls() {
    let (scene, camera, lights) = three_balls();
    compare("balls", &picture(&scene, &camera, &lights, &settings()));
}

#[test]
fn default_lights_and_view() {
    let mut parts = Parts::default();
    parts.material(Material::default());
    parts.quad(Vec3::new(-3.0, 0.0, 3.0), Vec3::X * 6.0, Vec3::NEG_Z * 6.0);
    parts.cuboid(Vec3::new(-1.5, 0.0, -1.5), Vec3::new(-0.5, 2.5, 0.0));
    parts.sphere(Vec3::new(0.9, 0.8, 0.4), 0.8, 20);
    let scene = parts.scene(false);
    let views = slimkd_render::views::find(&scene.0, &scene.1, 1);
    compare("default", &picture(&scene, &views[0], &[], &settings()));
}

#[test]
fn indoors() {
    let mut parts = Parts::default();
    parts.material(Material::default()).cuboid(Vec3::new(0.0, 0.0, 0.0), Vec3::new(8.0, 3.0, 5.0));
    parts.material(diffuse(Vec3::new(0.3, 0.45, 0.6)));
    for column in 0..4 {
        let x = 1.5 + 1.6 * column as f32;
        parts.cuboid(Vec3::new(x, 0.0, 3.2), Vec3::new(x + 0.3, 3.0, 3.5));
    }
    let scene = parts.scene(false);
    let eye = Vec3::new(0.6, 1.7, 1.0);
    let camera = Camera { eye, target: Vec3::new(6.0, 1.2, 3.5), up: Vec3::Y, fov: 65.0 };
    compare("indoors", &picture(&scene, &camera, &[], &settings()));
}
