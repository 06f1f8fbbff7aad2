//! Lights for scenes that name none.

use crate::camera::PinholeFrame;
use glam::{Vec2, Vec3};
use slimkd::{Hit, KdTree, Ray, Tracer};
use slimkd_scene::{Camera, Light};

/// Edge of the grid of rays that looks at the scene before lights are set.
const PROBES: u32 = 16;
/// Irradiance of the headlight at the median distance of what the camera sees.
const HEADLIGHT: f32 = 0.12;
/// Irradiance of the sun.
const SUN: f32 = 0.75;
/// Irradiance of the ceiling lamp at the median distance of what the camera sees.
const LAMP: f32 = 0.25;
/// Irradiance that lamps may reach on what is near, so that it is not blown out.
const GLARE: f32 = 0.6;
/// Height of the ceiling lamp over the free height.
const LAMP_HEIGHT: f32 = 0.6;
/// Below this share of sunlit points the camera is indoors and gets a lamp.
const INDOORS: f32 = 0.25;

/// A headlight at the camera and a sun from above; where the sun does not reach what the camera sees, a lamp below the
/// ceiling too. `up` need not have unit length. Empty for a camera that cannot take a picture.
pub fn default_lights(tree: &KdTree, camera: &Camera, up: Vec3) -> Vec<Light> {
    let (Ok(frame), Some(up)) = (PinholeFrame::new(camera, 1.0), up.try_normalize()) else {
        return Vec::new();
    };
    let bounds = tree.bounds();
    let diagonal = if bounds.is_empty() {
        1.0
    } else {
        (Vec3::from(bounds.max).as_dvec3() - Vec3::from(bounds.min).as_dvec3()).length() as f32
    };
    let seen = probe(tree, &frame);
    let at = |share: usize| seen.get(seen.len() * share / 100).map(|(_, hit)| hit.t);
    let median = at(50).unwrap_or(diagonal).max(diagonal * 1e-4);

    let near = at(10).unwrap_or(median);
    let headlight = (HEADLIGHT * median * median).min(GLARE * near * near);

    // The sun stands over the viewer's left shoulder.
    let forward = (camera.target - camera.eye).normalize_or(Vec3::NEG_Z);
    let right = forward.cross(up).normalize_or(up.any_orthonormal_vector());
    let ahead = up.cross(right);
    let sun = -(up * 1.0 - right * 0.55 - ahead * 0.45).normalize();
    let mut lights = vec![
        Light::Point { position: camera.eye, intensity: Vec3::splat(headlight) },
        Light::Directional { direction: sun, irradiance: Vec3::new(1.0, 0.97, 0.92) * SUN },
    ];

    let sunlit = seen.iter().filter(|(ray, hit)| {
        let point = Vec3::from(ray.at(hit.t * 0.999)) - sun * (diagonal * 1e-4);
        !tree.any(&Ray::new(point, -sun))
    });
    if !seen.is_empty() && (sunlit.count() as f32) < INDOORS * seen.len() as f32 {
        let base = eye_or(tree, camera.eye, camera.eye + forward * (median * 0.5));
        let free = tree.closest(&Ray::new(base, up)).map_or(median, |hit| hit.t.min(median));
        let position = base + up * (LAMP_HEIGHT * free);
        let below = (1.0 - LAMP_HEIGHT) * free;
        let power = (LAMP * median * median).min(4.0 * GLARE * below * below);
        let intensity = Vec3::new(1.0, 0.96, 0.9) * power;
        lights.push(Light::Point { position, intensity });
    }
    lights
}

/// What the camera sees, nearest first.
fn probe(tree: &KdTree, frame: &PinholeFrame) -> Vec<(Ray, Hit)> {
    let mut seen = Vec::new();
    for index in 0..PROBES * PROBES {
        let cell = Vec2::new((index % PROBES) as f32, (index / PROBES) as f32);
        let ray = frame.ray((cell + 0.5) / PROBES as f32);
        seen.extend(tree.closest(&ray).map(|hit| (ray, hit)));
    }
    seen.sort_by(|a, b| a.1.t.total_cmp(&b.1.t));
    seen
}

/// `point` if the eye sees it, else the eye.
fn eye_or(tree: &KdTree, eye: Vec3, point: Vec3) -> Vec3 {
    let blocked = tree.any(&Ray::new(eye, point - eye).with_range(0.0, 1.0));
    if blocked { eye } else { point }
}
