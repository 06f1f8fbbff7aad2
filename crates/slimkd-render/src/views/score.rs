//! How good a view is, by a coarse grid of rays.

use crate::camera::PinholeFrame;
use glam::{Vec2, Vec3};
use slimkd::{KdTree, Tracer};
use slimkd_scene::Camera;
use std::collections::BTreeMap;

/// Edge of the grid of rays.
const GRID: u32 = 16;
/// Octaves from the median that count as far.
const FAR: f32 = 3.0;
/// Rays of a grid.
const RAYS: f32 = (GRID * GRID) as f32;

/// What a camera sees.
#[derive(Clone, Debug)]
pub(super) struct Look {
    /// Median distance, scene units.
    pub(super) median: f32,
    /// Distances of all hits, sorted.
    distances: Vec<f32>,
    /// The picture of distances: octaves from the median, [`FAR`] where nothing is hit.
    octaves: Vec<f32>,
    /// Share of the rays that hit.
    coverage: f32,
    /// Entropy of the normals, 0 to 1.
    normals: f32,
    /// Entropy of the distances' octaves, 0 to 1.
    depths: f32,
    /// Distinct triangles, logarithmic, 0 to 1.
    triangles: f32,
    /// Share of the hits on the plane that is seen most.
    dominance: f32,
    /// Share of the hits on triangles' backs.
    backs: f32,
}

impl Look {
    /// Traces the grid; `None` when the camera is impossible or sees nothing.
    pub(super) fn new(tree: &KdTree, camera: &Camera) -> Option<Self> {
        let frame = PinholeFrame::new(camera, 1.0).ok()?;
        let (mut distances, mut hits) = (Vec::new(), Vec::new());
        let mut octaves = vec![f32::INFINITY; (GRID * GRID) as usize];
        for index in 0..GRID * GRID {
            let cell = Vec2::new((index % GRID) as f32, (index / GRID) as f32);
            let ray = frame.ray((cell + 0.5) / GRID as f32);
            let Some(hit) = tree.closest(&ray) else { continue };
            let [a, b, c] = tree.mesh().corners(hit.triangle).map(|corner| Vec3::from(corner).as_dvec3());
            let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
            let back = normal.dot(ray.direction.into()) > 0.0;
            let normal = if back { -normal } else { normal };
            distances.push(hit.t);
            octaves[index as usize] = hit.t;
            hits.push((hit, normal, Vec3::from(ray.at(hit.t)) - camera.eye, back));
        }
        distances.sort_by(f32::total_cmp);
        let median = *distances.get(distances.len() / 2)?;
        octaves.iter_mut().for_each(|t| *t = (*t / median).log2().clamp(-FAR, FAR));
        let count = hits.len() as f32;

        let (mut normals, mut depths) = (BTreeMap::new(), BTreeMap::new());
        let (mut triangles, mut planes) = (BTreeMap::new(), BTreeMap::new());
        for (hit, normal, point, _) in &hits {
            let bin = (*normal * 2.0).round().as_ivec3().to_array();
            *normals.entry(bin).or_insert(0) += 1;
            *depths.entry((2.0 * (hit.t / median).log2()).floor() as i32).or_insert(0) += 1;
            *triangles.entry(hit.triangle).or_insert(0) += 1;
            let plane = (normal.dot(*point) / median * 25.0).round() as i32;
            *planes.entry((bin, plane)).or_insert(0) += 1;
        }
        let most = planes.values().copied().max().unwrap_or(0) as f32;
        Some(Self {
            median,
            coverage: count / RAYS,
            normals: entropy(normals.values()) / 3.0,
            depths: entropy(depths.values()) / 3.0,
            triangles: (triangles.len() as f32).ln() / RAYS.ln(),
            dominance: most / count,
            backs: hits.iter().filter(|hit| hit.3).count() as f32 / count,
            distances,
            octaves,
        })
    }

    /// Variety of what is seen.
    fn variety(&self) -> f32 {
        self.normals.min(1.0) + self.depths.min(1.0) + self.triangles
    }

    /// 1 for the same picture of distances, 0 for pictures that differ by an octave all over.
    pub(super) fn likeness(&self, other: &Self) -> f32 {
        let apart: f32 = self.octaves.iter().zip(&other.octaves).map(|(a, b)| (a - b).abs().min(1.0)).sum();
        1.0 - apart / RAYS
    }

    /// Share of the hits nearer than that.
    fn nearer(&self, distance: f32) -> f32 {
        self.distances.partition_point(|&d| d < distance) as f32 / self.distances.len() as f32
    }

    /// Score of a view within a place whose surroundings lie at about `reach`.
    pub(super) fn indoors(&self, reach: f32) -> f32 {
        let coverage = ((self.coverage - 0.4) / 0.5).clamp(0.0, 1.0);
        let room = (1.0 - 4.0 * self.nearer((0.3 * reach).max(0.2 * self.median))).max(0.0);
        // Down the hall rather than at the next wall.
        let depth = (self.median / reach).clamp(0.3, 3.0).sqrt();
        let hull = if self.backs > 0.92 { 0.2 } else { 1.0 };
        self.variety() * coverage * room * (1.0 - self.dominance) * depth * hull * self.median.powf(0.2)
    }

    /// Score of a view of the whole from outside.
    pub(super) fn outdoors(&self) -> f32 {
        let coverage = (self.coverage / 0.3).min(1.0);
        self.variety() * coverage * (1.0 - 0.7 * self.dominance)
    }
}

/// Shannon entropy of counts, bits.
fn entropy<'a>(counts: impl Iterator<Item = &'a i32> + Clone) -> f32 {
    let total = counts.clone().sum::<i32>() as f32;
    counts.map(|&count| count as f32 / total).map(|share| -share * share.log2()).sum()
}
