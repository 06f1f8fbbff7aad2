//! One tile of the picture, a sample of every pixel after the other.
//!
//! Pixels go in blocks of 8 × 8 made of blocks of 4 × 4: those are the groups and packets that
//! [`slimkd::Batch::coherent`] traces.

use crate::camera::PinholeFrame;
use crate::sampling;
use crate::shade::{Path, Shader};
use crate::statistics::RenderStatistics;
use crate::waves::Waves;
use glam::{Vec2, Vec3};
use slimkd::Progress;

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

    /// Its pixels, in blocks of 8 × 8 made of blocks of 4 × 4, each in rows.
    fn pixels(self) -> impl Iterator<Item = (u32, u32)> {
        let place = |index: u32| {
            let within = |bit: u32| index >> bit & 1;
            let x = (index & 3) | within(4) << 2 | within(6) << 3;
            let y = (index >> 2 & 3) | within(5) << 2 | within(7) << 3;
            (x, y)
        };
        let inside = move |&(x, y): &(u32, u32)| x < self.width && y < self.height;
        (0..TILE * TILE).map(place).filter(inside).map(move |(x, y)| (self.x + x, self.y + y))
    }
}

/// The tile's pixels in rows and the rays that they took, or `None` when the render was cancelled.
pub(crate) fn trace_tile(
    tile: Tile,
    frame: &PinholeFrame,
    shader: &Shader<'_>,
    progress: &Progress,
) -> Option<(Vec<Vec3>, RenderStatistics)> {
    let pixels: Vec<(u32, u32)> = tile.pixels().collect();
    let size = Vec2::new(shader.settings.width as f32, shader.settings.height as f32);
    let samples = shader.settings.samples.max(1);
    let mut sums = vec![Vec3::ZERO; pixels.len()];
    let mut colours = vec![Vec3::ZERO; pixels.len()];
    let mut waves = Waves::default();
    let mut counts = RenderStatistics::default();
    for sample in 0..samples {
        if progress.is_cancelled() {
            return None;
        }
        colours.fill(Vec3::ZERO);
        let camera = pixels.iter().enumerate().map(|(pixel, &(x, y))| {
            let within = sampling::pixel_sample((x, y), sample, samples);
            let ray = frame.ray((Vec2::new(x as f32, y as f32) + within) / size);
            (ray, Path { pixel, depth: 0, weight: 1.0, seed: sampling::hash(x, y, 1) })
        });
        waves.follow(shader, sample, camera, &mut colours, &mut counts);
        for (sum, &colour) in sums.iter_mut().zip(&colours) {
            // A light of absurd strength must not leave holes in the picture.
            *sum += if colour.is_finite() { colour.max(Vec3::ZERO) } else { Vec3::ZERO };
        }
    }
    let mut rows = vec![Vec3::ZERO; pixels.len()];
    for (&(x, y), sum) in pixels.iter().zip(&sums) {
        rows[((y - tile.y) * tile.width + (x - tile.x)) as usize] = *sum / samples as f32;
    }
    Some((rows, counts))
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
