//! Light that arrives where rays hit: from the sky, dimmed by what stands nearby, and from each light along a shadow ray.
//!
//! A batch at a time. Shadow rays from neighbouring points to one light go together; occlusion rays go anywhere.

use crate::sampling;
use crate::shade::{Seen, Shader};
use crate::statistics::RenderStatistics;
use glam::Vec3;
use slimkd::{Hit, Ray, Tracer};

/// Transparent surfaces that a shadow ray may pass before it counts as blocked.
const MAX_TRANSPARENT: u32 = 32;

/// Buffers for one batch after the other.
#[derive(Default)]
pub(crate) struct Lighting {
    diffuse: Vec<Vec3>,
    /// What is seen of the sky, a hit each.
    open: Vec<f32>,
    rays: Vec<Ray>,
    /// The hit that each ray starts from.
    from: Vec<usize>,
    /// What a light adds where nothing stands before it, a ray each.
    radiance: Vec<Vec3>,
    /// The share of it that arrives.
    visible: Vec<f32>,
    blocked: Vec<bool>,
    hits: Vec<Option<Hit>>,
}

impl Lighting {
    /// Adds to each pixel of `colours` what its hits send towards the rays that found them.
    pub(crate) fn add(
        &mut self,
        shader: &Shader<'_>,
        sample: u32,
        seen: &[Seen<'_>],
        colours: &mut [Vec3],
        counts: &mut RenderStatistics,
    ) {
        self.diffuse.clear();
        self.diffuse.extend(seen.iter().map(|seen| shader.diffuse(seen)));
        self.look_around(shader, sample, seen, counts);
        for ((seen, &diffuse), &open) in seen.iter().zip(&self.diffuse).zip(&self.open) {
            let ambient = if diffuse == Vec3::ZERO {
                Vec3::ZERO
            } else {
                diffuse * shader.settings.sky.irradiance(seen.surface.shading.dot(shader.up)) * open
            };
            colours[seen.path.pixel] += seen.path.weight * (seen.material.emission + ambient);
        }
        for light in shader.lights {
            self.rays.clear();
            self.from.clear();
            self.radiance.clear();
            for (from, (seen, &diffuse)) in seen.iter().zip(&self.diffuse).enumerate() {
                if let Some((radiance, ray)) = shader.lit(light, seen, diffuse) {
                    self.rays.push(ray);
                    self.from.push(from);
                    self.radiance.push(radiance);
                }
            }
            self.shadows(shader, counts);
            for ((&from, &radiance), &visible) in self.from.iter().zip(&self.radiance).zip(&self.visible) {
                let path = &seen[from].path;
                colours[path.pixel] += path.weight * radiance * visible;
            }
        }
    }

    /// How much of the light arrives along each ray.
    fn shadows(&mut self, shader: &Shader<'_>, counts: &mut RenderStatistics) {
        if shader.transparent {
            return self.transparent_shadows(shader, counts);
        }
        counts.shadow += self.rays.len() as u64;
        self.blocked.clear();
        self.blocked.resize(self.rays.len(), false);
        shader.tree.batch().coherent().any(&self.rays, &mut self.blocked);
        self.visible.clear();
        self.visible.extend(self.blocked.iter().map(|&blocked| f32::from(!blocked)));
    }

    /// As [`Lighting::shadows`] where something may let light pass: what blocks must be known. Asking for any hit first
    /// would save nothing, since a free way costs the same.
    fn transparent_shadows(&mut self, shader: &Shader<'_>, counts: &mut RenderStatistics) {
        self.visible.clear();
        self.visible.resize(self.rays.len(), 1.0);
        let mut left: Vec<usize> = (0..self.rays.len()).collect();
        for _ in 0..MAX_TRANSPARENT {
            if left.is_empty() {
                return;
            }
            counts.shadow += left.len() as u64;
            self.hits.clear();
            self.hits.resize(left.len(), None);
            shader.tree.batch().coherent().closest(&self.rays, &mut self.hits);
            let (mut kept, mut going) = (Vec::new(), Vec::new());
            for ((&ray, mut way), hit) in left.iter().zip(std::mem::take(&mut self.rays)).zip(&self.hits) {
                let Some(hit) = hit else { continue };
                let material = shader.material(hit.triangle);
                let visible = &mut self.visible[ray];
                *visible *=
                    (1.0 - material.reflection.clamp(0.0, 1.0)) * material.transmission.clamp(0.0, 1.0);
                if *visible < shader.settings.min_contribution {
                    *visible = 0.0;
                    continue;
                }
                way.t_min = hit.t.next_up();
                kept.push(ray);
                going.push(way);
            }
            (left, self.rays) = (kept, going);
        }
        left.iter().for_each(|&ray| self.visible[ray] = 0.0);
    }

    /// Which share of the ambient light is not blocked nearby: 1 without occlusion rays and behind mirrors.
    fn look_around(
        &mut self,
        shader: &Shader<'_>,
        sample: u32,
        seen: &[Seen<'_>],
        counts: &mut RenderStatistics,
    ) {
        let (count, reach) = (shader.settings.occlusion, shader.occlusion_reach);
        self.open.clear();
        self.open.resize(seen.len(), 1.0);
        if count == 0 {
            return;
        }
        self.rays.clear();
        self.from.clear();
        let total = count * shader.settings.samples;
        for (from, (Seen { path, surface, .. }, &diffuse)) in seen.iter().zip(&self.diffuse).enumerate() {
            if path.depth > 0 || diffuse == Vec3::ZERO {
                continue;
            }
            self.open[from] = 0.0;
            // The pair turns with the sign of z, which a zero must not have: a GPU may keep it or not.
            let (tangent, bitangent) = (surface.shading + Vec3::ZERO).any_orthonormal_pair();
            for index in 0..count {
                let point = sampling::stratified(path.seed, sample * count + index, total);
                // Cosine-weighted directions (Malley's method).
                let (radius, angle) = (point.x.sqrt(), point.y * std::f32::consts::TAU);
                let height = (1.0 - point.x).max(0.0).sqrt();
                let (sin, cos) = angle.sin_cos();
                let towards = (tangent * cos + bitangent * sin) * radius + surface.shading * height;
                if towards.dot(surface.geometric) > 0.0 {
                    self.rays.push(Ray::new(surface.outer(), towards).with_range(0.0, reach));
                    self.from.push(from);
                }
            }
        }
        counts.occlusion += self.rays.len() as u64;
        self.hits.clear();
        self.hits.resize(self.rays.len(), None);
        shader.tree.batch().closest(&self.rays, &mut self.hits);
        for (&from, hit) in self.from.iter().zip(&self.hits) {
            // Blockers fade with distance, or else every room would be dark.
            self.open[from] += hit.map_or(1.0, |hit| hit.t / reach) / count as f32;
        }
    }
}
