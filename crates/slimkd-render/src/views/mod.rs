//! Views of a scene that names none: from inside where there is an inside, else from around it.
//!
//! 1. Guess which way is up ([`guess_up`]).
//! 2. Choose places in free space: midpoints of chords between surfaces (`places`), and find out by rays in all
//!    directions how enclosed each is, and whether it lies in a room or in the solid of an object.
//! 3. If enough places are rooms, look around from the best ones; else look from outside (`outside`).
//! 4. Score each candidate by what a coarse grid of rays sees (`score`), and take the best that differ from each other.
//!
//! Deterministic, and at most about 150,000 rays whatever the scene's size; reading the triangles is what takes time.

mod outside;
mod places;
mod score;
mod up;

pub use up::guess_up;

use glam::Vec3;
use score::Look;
use slimkd::{KdTree, Tracer};
use slimkd_scene::{Camera, Scene};

/// Share of the chords' midpoints that must lie in rooms for the scene to count as a building. Measured: buildings and
/// their installations 0.38 to 0.56, cities with hollow houses or a terrain to look under 0.15 to 0.23, a scan 0.
const BUILDING: f32 = 0.3;
/// Places to look around from.
const STANDPOINTS: usize = 28;
/// How many views a scene has, as in the paper; [`of_scene`] looks for at least as many.
pub const VIEWS: usize = 3;
/// Headings per standpoint.
const HEADINGS: u32 = 10;
/// Vertical field of view indoors, degrees.
const INDOOR_FOV: f32 = 62.0;

/// A camera and how good it is.
#[derive(Clone, Debug)]
struct Candidate {
    camera: Camera,
    score: f32,
    /// What it sees.
    look: Look,
}

/// The first `count` views of a scene: those that the file names, then good ones.
pub fn of_scene(scene: &Scene, tree: &KdTree, count: usize) -> Vec<Camera> {
    let mut cameras: Vec<_> = scene.cameras.iter().copied().take(count).collect();
    if cameras.len() < count {
        // All at once: which views are found may depend on how many are looked for.
        cameras.extend(find(scene, tree, VIEWS.max(count)));
        cameras.truncate(count);
    }
    cameras
}

/// Up to `count` good views, the best first; none when the tree holds nothing that can be hit.
pub fn find(scene: &Scene, tree: &KdTree, count: usize) -> Vec<Camera> {
    let bounds = tree.bounds();
    if bounds.is_empty() || count == 0 {
        return Vec::new();
    }
    let mesh = tree.mesh();
    let up = scene.up.unwrap_or_else(|| guess_up(mesh)).vector();
    let chords = places::sample(mesh, tree);
    let rooms = chords.iter().filter(|place| place.is_room(up)).count();
    let indoors = rooms as f32 >= BUILDING * places::COUNT as f32;

    let mut candidates = Vec::new();
    if indoors {
        candidates = look_around(tree, chords, up);
    }
    if candidates.len() < count {
        candidates.extend(outside::around(mesh, tree, up));
    }
    choose(candidates, count)
}

/// Views from the most promising places.
fn look_around(tree: &KdTree, mut chords: Vec<places::Place>, up: Vec3) -> Vec<Candidate> {
    chords.sort_by(|a, b| b.promise(up).total_cmp(&a.promise(up)));
    let mut stands: Vec<places::Place> = Vec::new();
    for place in chords {
        // Not all in the same room.
        let apart = |other: &places::Place| {
            other.position.distance(place.position) > 0.5 * other.reach.min(place.reach)
        };
        if stands.len() < STANDPOINTS && place.promise(up) > 0.0 && stands.iter().all(apart) {
            stands.push(place);
        }
    }
    let side = up.any_orthonormal_vector();
    let mut candidates = Vec::new();
    for place in &stands {
        let eye = places::at_eye_height(tree, place.position, up);
        for heading in 0..HEADINGS {
            let angle = heading as f32 / HEADINGS as f32 * std::f32::consts::TAU;
            let flat = side * angle.cos() + up.cross(side) * angle.sin();
            // Slightly downwards, as one holds a camera.
            let forward = flat - up * 0.06;
            let camera = Camera { eye, target: eye + forward * place.reach, up, fov: INDOOR_FOV };
            let Some(look) = Look::new(tree, &camera) else { continue };
            candidates.push(Candidate { camera, score: look.indoors(place.reach), look });
        }
    }
    candidates.retain(|candidate| candidate.score > 0.0);
    candidates
}

/// The best ones that differ in place or direction.
fn choose(mut candidates: Vec<Candidate>, count: usize) -> Vec<Camera> {
    let mut chosen: Vec<Candidate> = Vec::new();
    while chosen.len() < count && !candidates.is_empty() {
        let value = |candidate: &Candidate| {
            chosen.iter().fold(candidate.score, |score, other| score * (1.0 - similarity(candidate, other)))
        };
        // The first of equals, so that the order of candidates decides and not chance.
        let mut best = 0;
        for index in 1..candidates.len() {
            if value(&candidates[index]) > value(&candidates[best]) {
                best = index;
            }
        }
        let candidate = candidates.swap_remove(best);
        chosen.push(candidate);
    }
    chosen.into_iter().map(|candidate| candidate.camera).collect()
}

/// 1 for the same picture, 0 for pictures that have nothing in common.
fn similarity(a: &Candidate, b: &Candidate) -> f32 {
    let direction = |c: &Candidate| (c.camera.target - c.camera.eye).normalize_or_zero();
    let facing = direction(a).dot(direction(b)).max(0.0);
    let distance =
        a.camera.eye.distance(b.camera.eye) / a.look.median.max(b.look.median).max(f32::MIN_POSITIVE);
    let near = 1.0 / (1.0 + distance * distance);
    // Symmetric buildings show the same picture from two places.
    let alike = 0.8 * a.look.likeness(&b.look);
    (0.3 * near + 0.45 * near * facing + 0.25 * facing).max(alike).min(0.999)
}
