//! Pictures whose pixels can be calculated by hand.

use crate::common::*;
use glam::Vec3;
use slimkd_render::dielectric_reflectance;
use slimkd_scene::{Camera, Light, Material};

const RED: Vec3 = Vec3::new(0.8, 0.1, 0.2);
const GREEN: Vec3 = Vec3::new(0.1, 0.9, 0.3);

fn close(a: Vec3, b: Vec3) {
    assert!(a.abs_diff_eq(b, 2e-5), "{a} is not {b}");
}

#[test]
fn a_mirror_shows_what_stands_opposite() {
    for share in [1.0, 0.25] {
        let mut parts = Parts::default();
        parts.material(Material { reflection: share, ..diffuse(Vec3::ZERO) });
        parts.quad(Vec3::new(-5.0, 0.0, 5.0), Vec3::X * 10.0, Vec3::NEG_Z * 10.0);
        parts.material(emitter(RED));
        parts.quad(Vec3::new(2.0, 0.0, 1.0), Vec3::Y * 4.0, Vec3::NEG_Z * 2.0);
        let scene = parts.scene(false);
        // In at 45°, out at 45° onto the emitter at x = 2; and past it where the mirror image ends.
        close(probe(&scene, Vec3::new(-2.0, 2.0, 0.0), Vec3::ZERO, DARK, 5), RED * share);
        close(probe(&scene, Vec3::new(-2.0, 2.0, 1.5), Vec3::new(0.0, 0.0, 1.5), DARK, 5), Vec3::ZERO);
        close(probe(&scene, Vec3::new(-2.0, 2.0, 0.0), Vec3::ZERO, DARK, 0), Vec3::ZERO);
    }
}

#[test]
fn a_slab_shifts_the_ray_by_snells_law() {
    let (eta, thickness) = (1.5, 1.0);
    for degrees in [0.0_f32, 20.0, 45.0, 70.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let sin_t = sin / eta;
        let x = thickness * sin_t / (1.0 - sin_t * sin_t).sqrt() + sin / cos;
        // Emitters on both sides of where the ray must come out 1 below the slab: green within ±0.01, red else.
        let mut parts = Parts::default();
        parts.material(glass(eta));
        parts.cuboid(Vec3::new(-9.0, -thickness, -9.0), Vec3::new(9.0, 0.0, 9.0));
        parts.material(emitter(GREEN));
        let floor = -thickness - 1.0;
        parts.quad(Vec3::new(x - 0.01, floor, 1.0), Vec3::X * 0.02, Vec3::NEG_Z * 2.0);
        parts.material(emitter(RED));
        parts.quad(Vec3::new(x - 5.0, floor, 1.0), Vec3::X * 4.99, Vec3::NEG_Z * 2.0);
        parts.quad(Vec3::new(x + 0.01, floor, 1.0), Vec3::X * 4.99, Vec3::NEG_Z * 2.0);
        let scene = parts.scene(false);
        let through = 1.0 - dielectric_reflectance(cos, eta);
        let seen = probe(&scene, Vec3::new(-2.0 * sin, 2.0 * cos, 0.0), Vec3::ZERO, DARK, 2);
        close(seen, GREEN * through * through);
    }
}

#[test]
fn total_internal_reflection_beyond_the_critical_angle() {
    let mut parts = Parts::default();
    parts.material(glass(1.5));
    parts.quad(Vec3::new(-9.0, 0.0, 9.0), Vec3::X * 18.0, Vec3::NEG_Z * 18.0);
    parts.material(emitter(RED));
    parts.quad(Vec3::new(-9.0, 3.0, 9.0), Vec3::X * 18.0, Vec3::NEG_Z * 18.0);
    parts.material(emitter(GREEN));
    parts.quad(Vec3::new(0.0, -3.0, 9.0), Vec3::X * 9.0, Vec3::NEG_Z * 18.0);
    let scene = parts.scene(false);
    let from_below = |degrees: f32| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        probe(&scene, Vec3::new(-2.0 * sin, -2.0 * cos, 0.0), Vec3::ZERO, DARK, 5)
    };
    close(from_below(45.0), GREEN);
    let share = dielectric_reflectance(30.0_f32.to_radians().cos(), 1.0 / 1.5);
    close(from_below(30.0), GREEN * share + RED * (1.0 - share));
}

#[test]
fn a_point_light_falls_off_and_throws_a_shadow_where_it_should() {
    let mut parts = Parts::default();
    parts.material(diffuse(RED));
    parts.quad(Vec3::new(-9.0, 0.0, 9.0), Vec3::X * 18.0, Vec3::NEG_Z * 18.0);
    parts.material(diffuse(GREEN));
    // Half way to the light: the shadow on the floor is twice as large, x and z from -1 to 1.
    parts.quad(Vec3::new(-0.5, 2.0, 0.5), Vec3::X, Vec3::NEG_Z);
    let scene = parts.scene(false);
    let light = Light::Point { position: Vec3::Y * 4.0, intensity: Vec3::splat(20.0) };
    let eye = Vec3::new(8.0, 1.0, 3.0);
    for step in 0..40 {
        let x = -2.0 + 0.1 * step as f32 + 0.013;
        let seen = probe(&scene, eye, Vec3::new(x, 0.0, 0.0), light, 5);
        let distance2 = 16.0 + x * x;
        let lit = RED * (20.0 / distance2 * 4.0 / distance2.sqrt());
        close(seen, if x.abs() < 1.0 { Vec3::ZERO } else { lit });
    }
}

#[test]
fn glass_dims_a_shadow_by_its_transmission() {
    let light = Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE };
    for (transmission, surfaces) in [(1.0, 1), (0.5, 1), (0.5, 2), (0.0, 1)] {
        let mut parts = Parts::default();
        parts.material(diffuse(RED));
        parts.quad(Vec3::new(-9.0, 0.0, 9.0), Vec3::X * 18.0, Vec3::NEG_Z * 18.0);
        parts.material(Material { transmission, ..glass(1.5) });
        for surface in 0..surfaces {
            parts.quad(Vec3::new(-1.0, 1.0 + surface as f32, 1.0), Vec3::X * 2.0, Vec3::NEG_Z * 2.0);
        }
        let scene = parts.scene(false);
        let seen = probe(&scene, Vec3::new(4.0, 0.5, 0.0), Vec3::new(0.1, 0.0, 0.2), light, 5);
        close(seen, RED * f32::powi(transmission, surfaces));
    }
}

#[test]
fn the_highlight_sits_in_the_mirror_direction() {
    let mut parts = Parts::default();
    parts.material(Material { specular: GREEN, shininess: 50.0, ..diffuse(Vec3::ZERO) });
    parts.quad(Vec3::new(-9.0, 0.0, 9.0), Vec3::X * 18.0, Vec3::NEG_Z * 18.0);
    let scene = parts.scene(false);
    let light = Light::Directional { direction: Vec3::new(1.0, -1.0, 0.0), irradiance: Vec3::splat(0.5) };
    close(probe(&scene, Vec3::new(3.0, 3.0, 0.0), Vec3::ZERO, light, 5), GREEN * 0.5);
    // 10° off: the half vector leans by 5°.
    let (sin, cos) = 55.0_f32.to_radians().sin_cos();
    let expected = GREEN * 0.5 * 5.0_f32.to_radians().cos().powf(50.0);
    close(probe(&scene, Vec3::new(3.0 * sin, 3.0 * cos, 0.0), Vec3::ZERO, light, 5), expected);
}

/// Each pixel of a sphere under a sun, beside what Lambert says: no speckles, near the origin or far from it, flat or
/// smooth, fine or coarse.
#[test]
fn no_acne_on_a_tessellated_sphere() {
    for (center, radius) in
        [(Vec3::ZERO, 1.0), (Vec3::new(2000.0, -700.0, 3000.0), 5.0), (Vec3::splat(0.01), 1e-3)]
    {
        for (rows, smooth) in [(12, true), (12, false), (100, true), (100, false)] {
            let mut parts = Parts::default();
            parts.material(diffuse(Vec3::ONE)).sphere(center, radius, rows);
            let scene = parts.scene(smooth);
            let towards = Vec3::new(0.3, 0.5, 0.8).normalize();
            let sun = Light::Directional { direction: -towards, irradiance: Vec3::ONE };
            let eye = center + Vec3::Z * (4.0 * radius);
            let camera = Camera { eye, target: center, up: Vec3::Y, fov: 30.0 };
            let film = picture(&scene, &camera, &[sun], &plain(80, 80));
            let slope = 15.0_f32.to_radians().tan();
            let mut compared = 0;
            for (x, y) in (0..80).flat_map(|y| (0..80).map(move |x| (x, y))) {
                let across = |k: u32| ((k as f32 + 0.5) / 40.0 - 1.0) * slope;
                let direction = Vec3::new(across(x), -across(y), -1.0).normalize();
                // The exact sphere, with a margin at its rim.
                let (b, c) = (-4.0 * direction.z, 15.0);
                let Some(root) = Some(b * b - c).filter(|d| *d > 0.1) else { continue };
                let normal = Vec3::Z * 4.0 + direction * (b - root.sqrt());
                let cos = normal.dot(towards);
                // A facet's normal leans by up to half a facet; the terminator of flat facets is jagged by nature.
                let tolerance = if smooth { 0.02 + 1.0 / rows as f32 } else { 3.0 / rows as f32 };
                if cos < tolerance.max(2.5 / rows as f32) {
                    continue;
                }
                compared += 1;
                let seen = film.pixel(x, y).x;
                assert!((seen - cos).abs() < tolerance, "{center} {rows} {smooth}: {seen}, not {cos}");
            }
            assert!(compared > 1000);
        }
    }
}

/// Inside a closed box in a bright world all is black, in each corner too.
#[test]
fn no_light_leaks_into_a_box() {
    for (corner, size) in
        [(Vec3::splat(-0.5), 1.0), (Vec3::new(1000.0, -300.0, 70.0), 3.0), (Vec3::ZERO, 1e-3)]
    {
        let mut parts = Parts::default();
        parts.material(diffuse(Vec3::ONE)).cuboid(corner, corner + size);
        let scene = parts.scene(false);
        let lights = [Vec3::new(1.0, -1.0, 0.7), Vec3::new(-0.2, -1.0, -0.1), Vec3::new(0.1, 1.0, 1.0)]
            .map(|direction| Light::Directional { direction, irradiance: Vec3::splat(10.0) });
        let mut settings = plain(120, 120);
        settings.sky.zenith = Vec3::splat(10.0);
        settings.sky.horizon = settings.sky.zenith;
        settings.sky.ground = settings.sky.zenith;
        let center = corner + 0.5 * size;
        for towards in [Vec3::ONE, -Vec3::ONE, Vec3::new(1.0, -1.0, 0.2), Vec3::X] {
            let camera = Camera { eye: center, target: center + towards * size, up: Vec3::Y, fov: 100.0 };
            let film = picture(&scene, &camera, &lights, &settings);
            let leaks = film.pixels().iter().filter(|pixel| **pixel != [0.0; 3]).count();
            assert_eq!(leaks, 0, "box at {corner}, towards {towards}");
        }
    }
}
