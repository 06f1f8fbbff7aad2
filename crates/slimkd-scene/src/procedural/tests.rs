//! What every built-in scene must be.

use super::*;
use crate::Light;
use glam::{DVec3, Vec3};
use slimkd::{BuildOptions, KdTree, Ray, Tracer};

/// The sizes that every run checks.
const TARGETS: [usize; 4] = [3_000, 10_000, 100_000, 1_000_000];

fn scenes(triangles: usize) -> impl Iterator<Item = Scene> {
    list().iter().map(move |built_in| generate(built_in.name, triangles).expect("a built-in scene"))
}

/// What must hold at any size.
fn check(scene: &Scene, target: usize) {
    let (name, mesh) = (&scene.name, &scene.mesh);
    assert!(mesh.len().abs_diff(target) * 20 <= target, "{name}: {} triangles for {target}", mesh.len());
    assert_eq!(scene.material_ids.len(), mesh.len(), "{name}");
    assert!(scene.material_ids.iter().all(|&id| (id as usize) < scene.materials.len()), "{name}");
    assert!(mesh.vertices().iter().flatten().all(|x| x.is_finite()), "{name}");
    let normals = scene.normals.as_ref().expect("normals");
    assert_eq!(normals.values.len(), mesh.vertices().len(), "{name}");
    let unit = |n: &[f32; 3]| (Vec3::from(*n).length() - 1.0).abs() < 1e-3;
    assert!(normals.values.iter().all(unit), "{name}: a normal is not of unit length");
}

/// Triangles without area, and those whose winding disagrees with their normals.
fn flaws(scene: &Scene) -> (usize, usize) {
    let normals = &scene.normals.as_ref().expect("normals").values;
    let (mut degenerate, mut turned) = (0, 0);
    for (id, corners) in scene.mesh.triangles().iter().enumerate() {
        let [a, b, c] = scene.mesh.corners(id as u32).map(|p| Vec3::from(p).as_dvec3());
        let area = (b - a).cross(c - a);
        let normal: DVec3 = corners.iter().map(|&k| Vec3::from(normals[k as usize]).as_dvec3()).sum();
        degenerate += usize::from(area == DVec3::ZERO);
        turned += usize::from(area.dot(normal) < -1e-3 * area.length() * normal.length());
    }
    (degenerate, turned)
}

#[test]
fn counts_and_buffers() {
    for target in TARGETS {
        scenes(target).for_each(|scene| check(&scene, target));
    }
}

#[test]
#[ignore = "takes gigabytes; run by hand"]
fn counts_and_buffers_of_large_scenes() {
    for target in [12_000_000, 38_000_000] {
        scenes(target).for_each(|scene| check(&scene, target));
    }
}

#[test]
fn few_flaws() {
    for target in [10_000, 300_000] {
        for scene in scenes(target) {
            let (degenerate, turned) = flaws(&scene);
            assert!(degenerate * 1000 <= target, "{}: {degenerate} of {target} are degenerate", scene.name);
            assert_eq!(turned, 0, "{} at {target}", scene.name);
        }
    }
}

#[test]
fn vertices_are_shared() {
    for built_in in list() {
        let scene = generate(built_in.name, built_in.triangles).expect("a built-in scene");
        assert!(scene.mesh.vertices().len() < scene.mesh.len(), "{}", scene.name);
    }
}

#[test]
fn the_same_bits_each_time() {
    for built_in in list() {
        let [a, b] = [0, 1].map(|_| generate(built_in.name, 30_000).expect("a built-in scene"));
        assert_eq!(a.mesh, b.mesh);
        assert_eq!((a.material_ids, a.normals), (b.material_ids, b.normals));
        let other = generate_seeded(built_in.name, 30_000, 7).expect("a built-in scene");
        assert_ne!(a.mesh.vertices(), other.mesh.vertices(), "{} ignores its seed", built_in.name);
    }
}

/// Checksums of positions: a change here changes every published figure of the built-in scenes; so does a machine
/// whose arithmetic differs.
#[test]
fn the_same_bits_on_every_machine() {
    let sums: Vec<(String, u64)> = scenes(20_000)
        .map(|scene| {
            let bytes = scene.mesh.vertices().iter().flatten().flat_map(|x| x.to_bits().to_le_bytes());
            // FNV-1a
            let sum = bytes.fold(0xCBF2_9CE4_8422_2325, |sum, byte| {
                (sum ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3_u64)
            });
            (scene.name, sum)
        })
        .collect();
    let expected: Vec<(String, u64)> = SUMS.iter().map(|&(name, sum)| (name.to_owned(), sum)).collect();
    assert_eq!(sums, expected);
}

const SUMS: [(&str, u64); 5] = [
    ("kitchen", 8_068_143_635_084_070_414),
    ("conference", 11_715_488_059_933_351_351),
    ("building", 18_033_980_785_281_192_434),
    ("courtyard", 10_229_233_032_191_445_112),
    ("power-plant", 15_340_200_297_273_738_786),
];

#[test]
fn views_stand_in_the_open() {
    for scene in scenes(100_000) {
        assert_eq!(scene.cameras.len(), 3, "{}", scene.name);
        assert_eq!(scene.up, Some(UpAxis::Y));
        let tree = KdTree::build(scene.mesh.clone(), &BuildOptions::default()).expect("a tree");
        let bounds = tree.bounds();
        for (k, camera) in scene.cameras.iter().enumerate() {
            let eye = camera.eye.to_array();
            let inside = (0..3).all(|axis| bounds.min[axis] <= eye[axis] && eye[axis] <= bounds.max[axis]);
            assert!(inside, "{}: view {k} is outside", scene.name);
            // Nothing within 25 cm in any direction, and nothing within 1 m of the line of sight.
            let mut rng = math::Rng::new(k as u64);
            for _ in 0..200 {
                let ray = Ray::new(camera.eye, rng.direction()).with_range(0.0, 0.25);
                assert!(!tree.any(&ray), "{}: view {k} touches something", scene.name);
            }
            let sight = Ray::new(camera.eye, (camera.target - camera.eye).normalize()).with_range(0.0, 1.0);
            assert!(!tree.any(&sight), "{}: view {k} stares at a wall", scene.name);
        }
    }
}

#[test]
fn lights_shine() {
    for scene in scenes(10_000) {
        assert!(!scene.lights.is_empty(), "{}", scene.name);
        for light in &scene.lights {
            let (colour, place) = match light {
                Light::Point { position, intensity } => (intensity, position),
                Light::Directional { direction, irradiance } => (irradiance, direction),
            };
            assert!(
                colour.min_element() > 0.0 && colour.is_finite() && place.is_finite() && *place != Vec3::ZERO
            );
        }
        let wrong = |c: Vec3| c.min_element() < 0.0 || c.max_element() > 1.0;
        for m in &scene.materials {
            assert!(!wrong(m.diffuse) && !wrong(m.specular), "{}: {}", scene.name, m.name);
            assert!(m.reflection + m.transmission <= 1.0 && m.ior >= 1.0 && m.shininess >= 1.0);
        }
    }
}

#[test]
fn odd_requests() {
    assert!(generate("no such scene", 1000).is_none());
    assert!(generate("kitchen", usize::MAX).is_none());
    for scene in scenes(0) {
        assert!((1000..3_000).contains(&scene.mesh.len()), "{}: {}", scene.name, scene.mesh.len());
    }
    for built_in in list() {
        assert_eq!(find(built_in.name).map(|found| found.name), Some(built_in.name));
        assert!(!built_in.description.is_empty() && built_in.triangles >= 100_000);
    }
}

#[test]
fn sine_and_cosine() {
    for k in -4000..4000 {
        let x = k as f32 * 0.013;
        let (s, c) = math::sin_cos(x);
        assert!((f64::from(s) - f64::from(x).sin()).abs() < 1e-7, "sin {x}");
        assert!((f64::from(c) - f64::from(x).cos()).abs() < 1e-7, "cos {x}");
    }
}
