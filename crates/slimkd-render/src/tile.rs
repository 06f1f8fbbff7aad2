//! One tile of the picture: primary rays in batches, then each hit shaded on its own.
//!
//! Batches are one sample of every pixel of the tile, so they are coherent and [`KdTree::closest_hits`] may trace them
//! as packets.

use crate::camera::PinholeFrame;
use crate::progress::{RenderProgress, RenderStatistics};
use crate::sampling;
use crate::shade::{Path, Shader};
use glam::{Vec2, Vec3};
use slimkd::{Hit, KdTree, Ray};

/// Edge of a tile, pixels: large enough to amortise a batch, small enough to balance threads.
pub(crate) const TILE: u32 = 16;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tile {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl Tile {
    /// Tile number `index` of a picture of that size, in rows from the top.
    pub(crate) fn of_picture(index: usize, width: u32, height: u32) -> Self {
        let columns = width.div_ceil(TILE) as usize;
        let (x, y) = ((index % columns) as u32 * TILE, (index / columns) as u32 * TILE);
        Self { x, y, width: TILE.min(width - x), height: TILE.min(height - y) }
    }

    /// How many tiles cover a picture of that size.
    pub(crate) fn count(width: u32, height: u32) -> usize {
        width.div_ceil(TILE) as usize * height.div_ceil(TILE) as usize
    }

    /// Its pixels, in rows.
    fn pixels(self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.height).flat_map(move |y| (0..self.width).map(move |x| (self.x + x, self.y + y)))
    }
}

/// The tile's pixels in rows, or `None` when the render was cancelled.
pub(crate) fn trace_tile(
    tile: Tile,
    frame: &PinholeFrame,
    shader: &Shader<'_>,
    progress: &RenderProgress,
) -> Option<Vec<Vec3>> {
    let pixels: Vec<(u32, u32)> = tile.pixels().collect();
    let samples = shader.settings.samples.max(1);
    let mut sums = vec![Vec3::ZERO; pixels.len()];
    let mut rays = Vec::with_capacity(pixels.len());
    let mut hits = vec![None; pixels.len()];
    let mut counts = RenderStatistics::default();
    for sample in 0..samples {
        if progress.is_cancelled() {
            return None;
        }
        primary_rays(&pixels, sample, frame, shader, &mut rays);
        trace_primary(shader.tree, &rays, &mut hits);
        counts.primary += rays.len() as u64;
        for (index, &(x, y)) in pixels.iter().enumerate() {
            let path = Path { depth: 0, weight: 1.0, seed: sampling::hash(x, y, 1), sample };
            let colour = shader.radiance(&rays[index], hits[index].as_ref(), path, &mut counts);
            // A light of absurd strength must not leave holes in the picture.
            sums[index] += if colour.is_finite() { colour.max(Vec3::ZERO) } else { Vec3::ZERO };
        }
    }
    progress.count(&counts);
    sums.iter_mut().for_each(|sum| *sum /= samples as f32);
    Some(sums)
}

/// The rays of one sample of every pixel.
fn primary_rays(
    pixels: &[(u32, u32)],
    sample: u32,
    frame: &PinholeFrame,
    shader: &Shader<'_>,
    rays: &mut Vec<Ray>,
) {
    let size = Vec2::new(shader.settings.width as f32, shader.settings.height as f32);
    rays.clear();
    rays.extend(pixels.iter().map(|&(x, y)| {
        let within = sampling::pixel_sample((x, y), sample, shader.settings.samples);
        frame.ray((Vec2::new(x as f32, y as f32) + within) / size)
    }));
}

/// The one place where primary rays meet the tree.
fn trace_primary(tree: &KdTree, rays: &[Ray], hits: &mut [Option<Hit>]) {
    tree.closest_hits(rays, hits);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_each_pixel_once() {
        for (width, height) in [(1, 1), (16, 16), (17, 33), (100, 5)] {
            let mut seen = vec![0; (width * height) as usize];
            for index in 0..Tile::count(width, height) {
                for (x, y) in Tile::of_picture(index, width, height).pixels() {
                    seen[(y * width + x) as usize] += 1;
                }
            }
            assert!(seen.iter().all(|&count| count == 1), "{width}x{height}");
        }
    }
}
