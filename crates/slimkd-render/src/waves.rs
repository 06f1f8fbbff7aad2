//! From camera rays to colours: all rays of a depth of the recursion together, then those that they send on.
//!
//! Mirrored and refracted rays of neighbouring pixels mostly stay neighbours, so each kind is a run of its own in the batch
//! that [`slimkd::Batch::coherent`] gets; what scatters goes on as a stream there.

use crate::lighting::Lighting;
use crate::shade::{Path, Shader};
use crate::statistics::RenderStatistics;
use glam::Vec3;
use slimkd::{Hit, Ray, Tracer};

/// Rays traced at once, at most. What is left waits on a stack, so that memory grows with the recursion's depth, not with
/// the number of rays.
const PIECE: usize = 1024;

/// Buffers for one sample of a tile after the other.
#[derive(Default)]
pub(crate) struct Waves {
    waiting: Vec<(Ray, Path)>,
    reflected: Vec<(Ray, Path)>,
    rays: Vec<Ray>,
    paths: Vec<Path>,
    hits: Vec<Option<Hit>>,
    lighting: Lighting,
}

impl Waves {
    /// Follows camera rays and adds what they see to `colours`; sample number `sample` of each pixel.
    pub(crate) fn follow(
        &mut self,
        shader: &Shader<'_>,
        sample: u32,
        camera: impl Iterator<Item = (Ray, Path)>,
        colours: &mut [Vec3],
        counts: &mut RenderStatistics,
    ) {
        self.waiting.extend(camera);
        counts.primary += self.waiting.len() as u64;
        while !self.waiting.is_empty() {
            let (rays, paths) = (&mut self.rays, &mut self.paths);
            rays.clear();
            paths.clear();
            let piece = self.waiting.len().saturating_sub(PIECE);
            for (ray, path) in self.waiting.drain(piece..) {
                rays.push(ray);
                paths.push(path);
            }
            self.hits.clear();
            self.hits.resize(rays.len(), None);
            shader.tree.batch().coherent().closest(&*rays, &mut self.hits);
            let mut seen = Vec::with_capacity(rays.len());
            for ((ray, &path), hit) in rays.iter().zip(&*paths).zip(&self.hits) {
                match hit.and_then(|hit| shader.seen(ray, path, &hit)) {
                    Some(found) => seen.push(found),
                    None => colours[path.pixel] += path.weight * shader.sky(ray.direction.into()),
                }
            }
            self.lighting.add(shader, sample, &seen, colours, counts);
            for seen in &seen {
                let (refracted, reflected) = shader.onward(seen);
                counts.refraction += u64::from(refracted.is_some());
                counts.reflection += u64::from(reflected.is_some());
                self.waiting.extend(refracted);
                self.reflected.extend(reflected);
            }
            self.waiting.append(&mut self.reflected);
        }
    }
}
