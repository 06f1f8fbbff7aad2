//! Views of the whole scene from outside: three-quarter views from around and above.

use super::Candidate;
use super::score::Look;
use glam::{DVec3, Vec3};
use slimkd::{KdTree, Tracer, TriangleMesh};
use slimkd_scene::Camera;

/// Vertical field of view, degrees.
const FOV: f32 = 40.0;
/// Share of the picture that the scene's bounds may fill.
const FILL: f64 = 0.96;
/// Directions around, from 45° between the horizontal axes on.
const AZIMUTHS: u32 = 8;
/// Share of the corners, by count, that may fall out of the picture on each side of each axis: strays.
const STRAY: f64 = 0.002;
/// The same for a landscape, whose details matter more than its rim.
const RIM: f64 = 0.04;
/// Height over length below which a scene is a landscape.
const LANDSCAPE: f64 = 0.5;
/// How much nearer the camera stands to a landscape than to see all of it.
const NEARER: f32 = 0.62;
/// At most so many triangles are read for the bounds.
const SAMPLED: usize = 1 << 18;

/// Candidates around the scene; higher up the flatter it lies.
pub(super) fn around(mesh: &TriangleMesh, tree: &KdTree, up: Vec3) -> Vec<Candidate> {
    let slenderness = |(min, max): (DVec3, DVec3)| {
        let extent = max - min;
        (extent.dot(up.as_dvec3()) / extent.max_element().max(f64::MIN_POSITIVE)).min(1.0)
    };
    let mut bounds = core_bounds(mesh, tree, STRAY, 0.6);
    let landscape = slenderness(bounds) < LANDSCAPE;
    if landscape {
        bounds = core_bounds(mesh, tree, RIM, 1.0);
    }
    let (center, half) = ((bounds.0 + bounds.1) * 0.5, (bounds.1 - bounds.0) * 0.5);
    let elevation = (18.0 + 14.0 * (1.0 - slenderness(bounds))).to_radians();

    // Azimuth 0 is the front by custom: −y where z is up, +z where y is.
    let front = if up == Vec3::Y {
        DVec3::Z
    } else if up == Vec3::Z {
        DVec3::NEG_Y
    } else {
        DVec3::Z
    };
    let up = up.as_dvec3();
    let side = up.cross(front);
    let mut candidates = Vec::new();
    for step in 0..AZIMUTHS {
        // 35° off the front first, then around.
        let angle = (35.0 + 360.0 * f64::from(step) / f64::from(AZIMUTHS)).to_radians();
        let flat = front * angle.cos() + side * angle.sin();
        let back = flat * elevation.cos() + up * elevation.sin();
        let mut camera = fit(center, half, back, up);
        if landscape {
            camera.eye = camera.target.lerp(camera.eye, NEARER);
        }
        let Some(look) = Look::new(tree, &camera) else { continue };
        // The front is what people expect first.
        let custom = 1.0 + 0.15 * angle.cos() as f32;
        candidates.push(Candidate { camera, score: look.outdoors() * custom, look });
    }
    candidates
}

/// The camera that looks against `back` and has the box just within its picture.
fn fit(center: DVec3, half: DVec3, back: DVec3, up: DVec3) -> Camera {
    let right = up.cross(back).normalize();
    let above = back.cross(right);
    let slope = (f64::from(FOV).to_radians() / 2.0).tan() * FILL;
    let distance = (0..8).fold(0.0_f64, |distance, k| {
        let sign = |bit: i32| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let corner = half * DVec3::new(sign(0), sign(1), sign(2));
        let off_axis = corner.dot(right).abs().max(corner.dot(above).abs());
        distance.max(corner.dot(back) + off_axis / slope)
    });
    let distance = if distance > 0.0 { distance } else { 1.0 };
    Camera { eye: (center + back * distance).as_vec3(), target: center.as_vec3(), up: up.as_vec3(), fov: FOV }
}

/// Bounds without the outermost `share` of the corners on each side of an axis, if at most `remaining` of its length
/// remains.
fn core_bounds(mesh: &TriangleMesh, tree: &KdTree, share: f64, remaining: f64) -> (DVec3, DVec3) {
    let bounds = tree.bounds();
    let (mut min, mut max) = (Vec3::from(bounds.min).as_dvec3(), Vec3::from(bounds.max).as_dvec3());
    let step = mesh.len().div_ceil(SAMPLED).max(1);
    for axis in 0..3 {
        let mut values: Vec<f32> = mesh
            .triangles()
            .iter()
            .step_by(step)
            .flat_map(|triangle| triangle.map(|v| mesh.vertices()[v as usize][axis]))
            .filter(|x| x.is_finite())
            .collect();
        let cut = (values.len() as f64 * share) as usize;
        if cut == 0 {
            continue;
        }
        let last = values.len() - 1 - cut;
        let (low, high) = (
            *values.select_nth_unstable_by(cut, f32::total_cmp).1,
            *values.select_nth_unstable_by(last, f32::total_cmp).1,
        );
        if f64::from(high) - f64::from(low) <= remaining * (max[axis] - min[axis]) {
            min[axis] = low.into();
            max[axis] = high.into();
        }
    }
    (min, max)
}
