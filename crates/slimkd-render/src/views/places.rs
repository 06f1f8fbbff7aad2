//! Places in free space, and how enclosed they are.

use crate::sampling::{hash, stratified, unit};
use glam::{DVec3, Vec3};
use slimkd::{KdTree, Ray, Tracer, TriangleMesh};
use std::collections::BTreeSet;

/// How many chords are tried.
pub(super) const COUNT: u32 = 640;
/// Rays in all directions from each place.
const DIRECTIONS: u32 = 64;
/// Eye height over free height indoors, least and most: no view from under the ceiling or from the carpet.
const EYE: (f32, f32) = (0.5, 0.68);

/// A point in free space and what surrounds it.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// Scene units.
    pub(super) position: Vec3,
    /// Median distance to what surrounds it, scene units.
    pub(super) reach: f32,
    /// For each direction of [`sphere`] the distance to the surface there.
    distances: Vec<Option<f32>>,
    /// For each direction whether the surface there shows its back, by winding.
    backs: Vec<bool>,
    /// Share of the hits that are on distinct triangles.
    variety: f32,
}

/// Midpoints of chords: from points on triangles (half by area, half by count, so that large walls and fine details
/// both have their say) in a random direction to the next surface.
pub(super) fn sample(mesh: &TriangleMesh, tree: &KdTree) -> Vec<Place> {
    let mut places = Vec::new();
    for (index, id) in triangles(mesh).into_iter().enumerate() {
        let seed = hash(index as u32, 7, 11);
        let Some((point, normal)) = point_on(mesh, id, seed) else { continue };
        let p = stratified(hash(seed, 3, 5), 0, 1);
        let (height, angle) = (1.0 - 2.0 * p.x, p.y * std::f32::consts::TAU);
        let ring = (1.0 - height * height).max(0.0).sqrt();
        let direction = Vec3::new(ring * angle.cos(), ring * angle.sin(), height);
        let offset = crate::offset::distance(&mesh.corners(id).map(Vec3::from));
        let origin = crate::offset::leave(point, normal, offset, direction);
        let Some(hit) = tree.closest(&Ray::new(origin, direction)) else { continue };
        places.extend(Place::new(mesh, tree, origin + direction * (hit.t * 0.5)));
    }
    places
}

/// Ids of [`COUNT`] triangles, by systematic sampling of a sum over all.
fn triangles(mesh: &TriangleMesh) -> Vec<u32> {
    let area = |id: u32| {
        let [a, b, c] = mesh.corners(id).map(|corner| DVec3::from(corner.map(f64::from)));
        let area = (b - a).cross(c - a).length();
        if area.is_finite() { area } else { 0.0 }
    };
    let count = mesh.len() as u32;
    let total: f64 = (0..count).map(area).sum();
    if total <= 0.0 || !total.is_finite() {
        return Vec::new();
    }
    let (mut chosen, mut sum) = (Vec::with_capacity(COUNT as usize), 0.0);
    for id in 0..count {
        sum += 0.5 * area(id) / total + 0.5 / f64::from(count);
        while chosen.len() < COUNT as usize && sum * f64::from(COUNT) > chosen.len() as f64 + 0.5 {
            chosen.push(id);
        }
    }
    chosen
}

/// A random point on a triangle, and its unit normal.
fn point_on(mesh: &TriangleMesh, id: u32, seed: u32) -> Option<(Vec3, Vec3)> {
    let [a, b, c] = mesh.corners(id).map(|corner| Vec3::from(corner).as_dvec3());
    let normal = (b - a).cross(c - a).try_normalize()?.as_vec3();
    let root = f64::from(unit(hash(seed, 1, 1))).sqrt();
    let v = f64::from(unit(hash(seed, 2, 2))) * root;
    let point = (a * (1.0 - root) + b * (root - v) + c * v).as_vec3();
    point.is_finite().then_some((point, normal))
}

/// Direction `index` of [`DIRECTIONS`], evenly spread (a Fibonacci spiral).
fn sphere(index: u32) -> Vec3 {
    let height = 1.0 - (2 * index + 1) as f32 / DIRECTIONS as f32;
    let ring = (1.0 - height * height).sqrt();
    let (sin, cos) = (index as f32 * 2.399_963_2).sin_cos();
    Vec3::new(ring * cos, ring * sin, height)
}

impl Place {
    /// Looks around; `None` where nothing is seen.
    fn new(mesh: &TriangleMesh, tree: &KdTree, position: Vec3) -> Option<Self> {
        let mut backs = Vec::with_capacity(DIRECTIONS as usize);
        let mut triangles = BTreeSet::new();
        let mut distances = Vec::with_capacity(DIRECTIONS as usize);
        for index in 0..DIRECTIONS {
            let direction = sphere(index);
            let hit = tree.closest(&Ray::new(position, direction));
            backs.push(hit.is_some_and(|hit| {
                triangles.insert(hit.triangle);
                let [a, b, c] = mesh.corners(hit.triangle).map(Vec3::from);
                (b - a).cross(c - a).dot(direction) > 0.0
            }));
            distances.push(hit.map(|hit| hit.t));
        }
        let mut near: Vec<f32> = distances.iter().copied().flatten().collect();
        near.sort_by(f32::total_cmp);
        let reach = *near.get(near.len() / 2)?;
        Some(Self { position, reach, backs, variety: triangles.len() as f32 / near.len() as f32, distances })
    }

    /// Share of the directions within 45° of `up` (or against it) that hit something.
    fn covered(&self, up: Vec3) -> f32 {
        let cone = |index: &u32| sphere(*index).dot(up) > std::f32::consts::FRAC_1_SQRT_2;
        let (mut all, mut hit) = (0, 0);
        for index in (0..DIRECTIONS).filter(cone) {
            all += 1;
            hit += u32::from(self.distances[index as usize].is_some());
        }
        hit as f32 / all.max(1) as f32
    }

    /// Share of all directions that hit something.
    fn enclosed(&self) -> f32 {
        self.distances.iter().flatten().count() as f32 / DIRECTIONS as f32
    }

    /// True inside a solid object, whose surface shows its back all around. What lies below does not count: houses of
    /// a city model stand on a ground that shows its front.
    fn is_solid(&self, up: Vec3) -> bool {
        let (mut hits, mut backs) = (0, 0);
        for index in (0..DIRECTIONS).filter(|&index| sphere(index).dot(up) > -0.1) {
            hits += u32::from(self.distances[index as usize].is_some());
            backs += u32::from(self.backs[index as usize]);
        }
        backs as f32 > 0.85 * hits as f32
    }

    /// A place with walls, a floor and a ceiling.
    pub(super) fn is_room(&self, up: Vec3) -> bool {
        !self.is_solid(up) && self.enclosed() > 0.8 && self.covered(up) > 0.6
    }

    /// How worthwhile it is to look around from here; 0 and less: not.
    pub(super) fn promise(&self, up: Vec3) -> f32 {
        if self.is_solid(up) || self.covered(-up) < 0.5 {
            return 0.0;
        }
        // Wide places rather than cupboards and shafts: the distances along the horizon count.
        let mut level: Vec<f32> = (0..DIRECTIONS)
            .filter(|&index| sphere(index).dot(up).abs() < 0.4)
            .filter_map(|index| self.distances[index as usize])
            .collect();
        level.sort_by(f32::total_cmp);
        let (Some(&near), Some(&median)) = (level.first(), level.get(level.len() / 2)) else { return 0.0 };
        let free = (near / median).min(0.3) / 0.3;
        (self.enclosed() - 0.5).max(0.0) * (0.1 + self.variety) * median.powf(0.3) * (0.3 + 0.7 * free)
    }
}

/// `position` moved up or down to where a person would hold a camera, between floor and ceiling.
pub(super) fn at_eye_height(tree: &KdTree, position: Vec3, up: Vec3) -> Vec3 {
    let distance = |direction| tree.closest(&Ray::new(position, direction)).map(|hit| hit.t);
    match (distance(-up), distance(up)) {
        (Some(floor), Some(ceiling)) => {
            let free = floor + ceiling;
            position + up * (floor.clamp(EYE.0 * free, EYE.1 * free) - floor)
        }
        _ => position,
    }
}
