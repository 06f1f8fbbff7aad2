//! One tile of the picture: primary rays as one coherent batch, then a batch of shadow rays a light, then each hit shaded
//! on its own.
//!
//! A batch is one sample of every pixel, in blocks of 8 × 8 made of blocks of 4 × 4: those are the groups and packets that
//! [`slimkd::KdTree::closest_hits_coherent`] traces. Mirrored and refracted rays go one by one.

use crate::camera::PinholeFrame;
use crate::progress::{RenderProgress, RenderStatistics};
use crate::sampling;
use crate::shade::{Path, Shader};
use crate::surface::Surface;
use glam::{Vec2, Vec3};
use slimkd::{Hit, Ray};

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
    let mut shadows = Shadows::default();
    let mut counts = RenderStatistics::default();
    for sample in 0..samples {
        if progress.is_cancelled() {
            return None;
        }
        primary_rays(&pixels, sample, frame, shader, &mut rays);
        shader.tree.closest_hits_coherent(&rays, &mut hits);
        counts.primary += rays.len() as u64;
        let surface =
            |(ray, hit): (&Ray, &Option<Hit>)| hit.and_then(|hit| Some((hit, shader.surface(ray, &hit)?)));
        let seen: Vec<Option<(Hit, Surface)>> = rays.iter().zip(&hits).map(surface).collect();
        shadows.trace(shader, &rays, &seen, &mut counts);
        for (index, &(x, y)) in pixels.iter().enumerate() {
            let path = Path { depth: 0, weight: 1.0, seed: sampling::hash(x, y, 1), sample };
            let direction = rays[index].direction.into();
            let colour = match &seen[index] {
                Some((hit, surface)) => {
                    shader.shade(direction, hit, surface, path, shadows.of(index), &mut counts)
                }
                None => shader.sky(direction),
            };
            // A light of absurd strength must not leave holes in the picture.
            sums[index] += if colour.is_finite() { colour.max(Vec3::ZERO) } else { Vec3::ZERO };
        }
    }
    progress.count(&counts);
    let mut rows = vec![Vec3::ZERO; pixels.len()];
    for (&(x, y), sum) in pixels.iter().zip(&sums) {
        rows[((y - tile.y) * tile.width + (x - tile.x)) as usize] = *sum / samples as f32;
    }
    Some(rows)
}

/// Shadow rays of the first hits, a coherent batch a light.
#[derive(Default)]
struct Shadows {
    rays: Vec<Ray>,
    /// The pixel of each ray.
    pixels: Vec<usize>,
    hits: Vec<bool>,
    /// One a light, pixel by pixel; empty when shadow rays are left to the shader.
    blocked: Vec<bool>,
    lights: usize,
}

impl Shadows {
    fn trace(
        &mut self,
        shader: &Shader<'_>,
        rays: &[Ray],
        seen: &[Option<(Hit, Surface)>],
        counts: &mut RenderStatistics,
    ) {
        if shader.transparent {
            return; // what blocks must be known then, not only whether something does
        }
        self.lights = shader.lights.len();
        self.blocked.clear();
        self.blocked.resize(seen.len() * self.lights, false);
        for light in 0..self.lights {
            self.rays.clear();
            self.pixels.clear();
            for (pixel, (ray, seen)) in rays.iter().zip(seen).enumerate() {
                let Some((hit, surface)) = seen else { continue };
                if let Some(ray) = shader.shadow_ray(light, ray.direction.into(), hit, surface) {
                    self.rays.push(ray);
                    self.pixels.push(pixel);
                }
            }
            self.hits.clear();
            self.hits.resize(self.rays.len(), false);
            shader.tree.any_hits_coherent(&self.rays, &mut self.hits);
            counts.shadow += self.rays.len() as u64;
            for (&pixel, &hit) in self.pixels.iter().zip(&self.hits) {
                self.blocked[pixel * self.lights + light] = hit;
            }
        }
    }

    /// Which lights are blocked for a pixel, where that was traced.
    fn of(&self, pixel: usize) -> Option<&[bool]> {
        let lights = pixel * self.lights..(pixel + 1) * self.lights;
        (self.lights > 0).then(|| &self.blocked[lights])
    }
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
