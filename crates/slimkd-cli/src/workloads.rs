//! The rays that presets are measured with.
//!
//! Any beginning of a workload is a fair sample of the whole, so that a slow scene can be measured with fewer rays:
//! pictures are cut into tiles, tiles are visited in a scattered order that takes turns between the views, and inside a
//! tile neighbouring rays stay together, as in a renderer.

use crate::cameras::View;
use glam::{UVec2, Vec3};
use slimkd::{Aabb, Hit, KdTree, Ray, Tracer, TriangleMesh};
use slimkd_render::{CameraError, PinholeFrame, default_lights};
use slimkd_scene::{Camera, Light, Scene};

/// Edge of the picture that primary rays belong to, pixels.
const PICTURE: u32 = 1024;
/// Edge of a tile, pixels; both are powers of two.
const TILE: u32 = 32;
/// Rays of a tile.
const TILE_RAYS: usize = (TILE * TILE) as usize;
/// Secondary rays start this far above their surface, in diagonals of the scene.
const LIFT: f32 = 1e-5;
/// Shadow rays that tell whether a light does, about.
const LIGHT_SAMPLE: usize = 1024;
/// Seed of the bounces; random segments use the next one.
const SEED: u64 = 2013;

/// Rays of one kind.
pub(crate) struct Workload {
    /// The name in tables and JSON.
    pub(crate) name: &'static str,
    /// Whether any hit is asked for, instead of the closest.
    pub(crate) any: bool,
    /// The rays.
    pub(crate) rays: Vec<Ray>,
}

/// The first `count` camera rays; fewer when the views' pictures have fewer pixels.
pub(crate) fn primary(views: &[View], count: usize) -> Result<Vec<Ray>, CameraError> {
    let frames: Vec<_> =
        views.iter().map(|view| PinholeFrame::new(&view.camera, 1.0)).collect::<Result<_, _>>()?;
    let tiles_across = PICTURE / TILE;
    let tiles = (tiles_across * tiles_across) as usize * frames.len();
    let mut rays = Vec::with_capacity(count.min(tiles * TILE_RAYS));
    for tile in 0..tiles {
        let frame = &frames[tile % frames.len()];
        // Reversed bits scatter evenly, and their de-interleaving does so in both directions.
        let place = ((tile / frames.len()) as u32).reverse_bits() >> (32 - 2 * tiles_across.trailing_zeros());
        let (tile_x, tile_y) = deinterleave(place);
        for pixel in 0..TILE * TILE {
            if rays.len() == count {
                return Ok(rays);
            }
            let (x, y) = deinterleave(pixel);
            let pixel = UVec2::new(tile_x * TILE + x, tile_y * TILE + y).as_vec2();
            rays.push(frame.ray((pixel + 0.5) / PICTURE as f32));
        }
    }
    Ok(rays)
}

/// All workloads over these primary rays; `tree` tells where they end.
pub(crate) fn all(
    scene: &Scene,
    tree: &KdTree,
    views: &[View],
    primary: Vec<Ray>,
    hits: &[Option<Hit>],
) -> Vec<Workload> {
    let bounds = tree.bounds();
    let up = scene.up.unwrap_or_default().vector();
    let view_of = |index: usize| index / TILE_RAYS % views.len();
    let starts: Vec<(usize, Start)> = primary
        .iter()
        .zip(hits)
        .enumerate()
        .filter_map(|(index, (ray, hit))| {
            Some((view_of(index), Start::new(&scene.mesh, ray, &(*hit)?, &bounds)?))
        })
        .collect();
    let lights: Vec<_> = views
        .iter()
        .enumerate()
        .map(|(number, view)| {
            let seen: Vec<&Start> =
                starts.iter().filter(|(of, _)| *of == number).map(|(_, start)| start).collect();
            light(scene, tree, &view.camera, up, &seen)
        })
        .collect();
    let mut random = fastrand::Rng::with_seed(SEED);
    let (mut shadow, mut bounce) = (Vec::new(), Vec::new());
    for (view, start) in &starts {
        shadow.extend(lights[*view].map(|light| start.towards(&light)));
        bounce.push(Ray::new(start.point, start.normal + sphere(&mut random)));
    }
    let segments = segments(&bounds, primary.len());
    vec![
        Workload { name: "primary", any: false, rays: primary },
        Workload { name: "shadow", any: true, rays: shadow },
        Workload { name: "bounce", any: false, rays: bounce },
        Workload { name: "random", any: false, rays: segments },
    ]
}

/// The even bits and the odd bits.
fn deinterleave(bits: u32) -> (u32, u32) {
    let even = |bits: u32| (0..16).fold(0, |out, k| out | (bits >> (2 * k) & 1) << k);
    (even(bits), even(bits >> 1))
}

/// The light that a view's shadow rays go to. The scene's in their order, then those that a picture would get but for its headlight,
/// the lamp indoors before the sun: the first that some of these points see and others do not, else the first of all. A rate
/// over rays that are all blocked, or all free, would be one of half the work.
fn light(scene: &Scene, tree: &KdTree, camera: &Camera, up: Vec3, from: &[&Start]) -> Option<Light> {
    let found = default_lights(tree, camera, up);
    let lights: Vec<Light> = scene.lights.iter().copied().chain(found.into_iter().skip(1).rev()).collect();
    let step = from.len().div_ceil(LIGHT_SAMPLE).max(1);
    let is_mixed = |light: &&Light| {
        let mut blocked = from.iter().step_by(step).map(|start| tree.any(&start.towards(light)));
        blocked.next().is_some_and(|first| blocked.any(|other| other != first))
    };
    lights.iter().find(is_mixed).or(lights.first()).copied()
}

/// Where a secondary ray starts.
struct Start {
    point: Vec3,
    /// On the side that the primary ray came from.
    normal: Vec3,
}

impl Start {
    fn new(mesh: &TriangleMesh, ray: &Ray, hit: &Hit, bounds: &Aabb) -> Option<Self> {
        let [a, b, c] = mesh.corners(hit.triangle).map(|corner| Vec3::from(corner).as_dvec3());
        let normal = (b - a).cross(c - a).try_normalize()?.as_vec3();
        let normal = if normal.dot(ray.direction.into()) > 0.0 { -normal } else { normal };
        let (min, max) = (Vec3::from(bounds.min), Vec3::from(bounds.max));
        // Far from the origin, rounding is larger than the share of the diagonal.
        let lift =
            (LIFT * (max - min).length()).max(4.0 * f32::EPSILON * max.abs().max(min.abs()).max_element());
        Some(Self { point: Vec3::from(ray.at(hit.t)) + normal * lift, normal })
    }

    fn towards(&self, light: &Light) -> Ray {
        match *light {
            Light::Point { position, .. } => Ray::new(self.point, position - self.point).with_range(0.0, 1.0),
            Light::Directional { direction, .. } => Ray::new(self.point, -direction),
        }
    }
}

/// A point of the unit sphere; added to a normal, it makes directions cosine-distributed.
fn sphere(random: &mut fastrand::Rng) -> Vec3 {
    let z = 2.0 * random.f32() - 1.0;
    let (sin, cos) = (std::f32::consts::TAU * random.f32()).sin_cos();
    let radius = (1.0 - z * z).max(0.0).sqrt();
    // Just inside the sphere, so that the opposite of the normal does not leave a direction of length 0.
    Vec3::new(radius * cos, radius * sin, z) * 0.999
}

/// Segments between random points on the faces of `bounds`: they cross all of the scene.
fn segments(bounds: &Aabb, count: usize) -> Vec<Ray> {
    let mut random = fastrand::Rng::with_seed(SEED + 1);
    let extent = bounds.extent();
    let area = |axis: usize| extent[(axis + 1) % 3] * extent[(axis + 2) % 3];
    let total = area(0) + area(1) + area(2);
    let mut point = || {
        let mut choice = random.f64() * total;
        let axis = (0..2)
            .find(|&axis| {
                choice -= area(axis);
                choice < 0.0
            })
            .unwrap_or(2);
        let mut point = Vec3::from_array(std::array::from_fn(|k| {
            (f64::from(bounds.min[k]) + random.f64() * extent[k]) as f32
        }));
        point[axis] = if random.bool() { bounds.max[axis] } else { bounds.min[axis] };
        point
    };
    let ends: Vec<_> = (0..count).map(|_| (point(), point())).collect();
    ends.into_iter().map(|(from, to)| Ray::new(from, to - from).with_range(0.0, 1.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(number: usize) -> View {
        let camera = Camera { eye: Vec3::splat(number as f32), target: Vec3::ZERO, up: Vec3::Y, fov: 60.0 };
        View { number, camera }
    }

    #[test]
    fn every_pixel_once() {
        let rays = primary(&[view(1)], usize::MAX).unwrap();
        assert_eq!(rays.len(), 1024 * 1024);
        let mut directions: Vec<_> = rays.iter().map(|ray| ray.direction.map(f32::to_bits)).collect();
        directions.sort_unstable();
        directions.dedup();
        assert_eq!(directions.len(), rays.len());
    }

    #[test]
    fn a_beginning_is_a_fair_sample() {
        let views = [view(1), view(2), view(3)];
        let rays = primary(&views, 3 * 64 * TILE_RAYS).unwrap();
        for view in &views {
            let mine: Vec<_> = rays.iter().filter(|ray| ray.origin == view.camera.eye.to_array()).collect();
            assert_eq!(mine.len(), 64 * TILE_RAYS);
            let forward = view.camera.target - view.camera.eye;
            let rightwards = forward.cross(view.camera.up);
            let upwards = rightwards.cross(forward);
            let right = |ray: &Ray| Vec3::from(ray.direction).dot(rightwards) > 0.0;
            let above = |ray: &Ray| Vec3::from(ray.direction).dot(upwards) > 0.0;
            for (side, height) in [(false, false), (false, true), (true, false), (true, true)] {
                let quarter = mine.iter().filter(|ray| right(ray) == side && above(ray) == height).count();
                assert_eq!(quarter, 16 * TILE_RAYS);
            }
        }
    }

    #[test]
    fn segments_join_two_faces_of_the_box() {
        let bounds = Aabb { min: [-1.0, 0.0, 10.0], max: [1.0, 5.0, 10.5] };
        for ray in segments(&bounds, 1000) {
            for t in [0.0, 1.0] {
                let point = ray.at(t);
                let near = |a: f32, b: f32| (a - b).abs() < 1e-4;
                assert!(
                    (0..3).any(|k| near(point[k], bounds.min[k]) || near(point[k], bounds.max[k])),
                    "{point:?}"
                );
            }
        }
    }
}
