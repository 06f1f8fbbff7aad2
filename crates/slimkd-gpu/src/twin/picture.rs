//! `shaders/frame.wgsl` in Rust.

use super::Twin;
use super::shade::{hash, rgb, stratified};
use super::surface::Surface;
use crate::frame::Frame;
use glam::{DVec3, Vec2, Vec3, Vec4};
use slimkd::Ray;
use slimkd_render::{dielectric_reflectance, refract};

/// Transparent surfaces that a shadow ray may pass.
const MAX_TRANSPARENT: u32 = 32;

/// A picture, rendered by the CPU as a GPU would.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'i> {
    pub(super) twin: Twin<'i>,
    pub(super) frame: &'i Frame,
    lights: &'i [[f32; 8]],
}

/// A mirrored or refracted ray that waits.
#[derive(Clone, Copy)]
struct Waiting {
    origin: Vec3,
    weight: f32,
    direction: Vec3,
    depth: u32,
}

/// What a ray is for.
#[derive(Clone, Copy, PartialEq)]
enum Purpose {
    Path,
    Shadow,
    Occlusion,
}

impl<'i> Picture<'i> {
    /// Over an image to which [`Frame::append`] has added the scene; frame and lights as [`Frame::of_picture`] gives them.
    pub fn new(twin: Twin<'i>, frame: &'i Frame, lights: &'i [[f32; 8]]) -> Self {
        Self { twin, frame, lights }
    }

    /// A pixel's colour, linear RGB.
    pub fn pixel(&self, x: u32, y: u32) -> [f32; 3] {
        let mut sum = Vec3::ZERO;
        for sample in 0..self.frame.samples {
            let colour = self.radiance(x, y, sample);
            if colour.is_finite() {
                sum += colour.max(Vec3::ZERO);
            }
        }
        (sum / self.frame.samples as f32).to_array()
    }

    fn primary(&self, x: u32, y: u32, sample: u32) -> Vec3 {
        let frame = self.frame;
        let within = match frame.samples {
            0 | 1 => Vec2::splat(0.5),
            samples => stratified(hash(x, y, 0), sample, samples),
        };
        let point =
            (Vec2::new(x as f32, y as f32) + within) / Vec2::new(frame.width as f32, frame.height as f32);
        let axis = |high, rest| -> DVec3 { rgb(high).as_dvec3() + rgb(rest).as_dvec3() };
        let across = axis(frame.right, frame.right_rest) * (2.0 * f64::from(point.x) - 1.0);
        let upwards = axis(frame.above, frame.above_rest) * (1.0 - 2.0 * f64::from(point.y));
        (axis(frame.forward, frame.forward_rest) + across + upwards).normalize().as_vec3()
    }

    fn follow(surface: &Surface, towards: Vec3, share: f32, path: Waiting, waiting: &mut Vec<Waiting>) {
        let direction = towards.normalize_or_zero();
        let origin = surface.start(direction);
        waiting.push(Waiting { origin, weight: path.weight * share, direction, depth: path.depth + 1 });
    }

    /// The rays that go on from a surface.
    fn branch(&self, material: u32, surface: &Surface, path: Waiting, waiting: &mut Vec<Waiting>) {
        if path.depth >= self.frame.max_depth {
            return;
        }
        let least = self.frame.horizon[3];
        let transmission = self.float(material + 13);
        let mut reflection = self.float(material + 12);
        let mut through = None;
        if transmission > 0.0 {
            let ior = self.float(material + 11);
            let eta = if surface.outside { ior } else { 1.0 / ior };
            match refract(path.direction, surface.shading, eta) {
                None => reflection += transmission,
                Some(towards) => {
                    let fresnel = dielectric_reflectance(-path.direction.dot(surface.shading), eta);
                    reflection += transmission * fresnel;
                    let straight_on = towards.dot(surface.geometric) >= 0.0;
                    let towards = if straight_on { path.direction } else { towards };
                    through = Some((towards, transmission * (1.0 - fresnel)));
                }
            }
        }
        if reflection > 0.0 && path.weight * reflection >= least {
            let mut towards = path.direction.reflect(surface.shading);
            if towards.dot(surface.geometric) <= 0.0 {
                towards = path.direction.reflect(surface.geometric);
            }
            Self::follow(surface, towards, reflection, path, waiting);
        }
        if let Some((towards, share)) = through
            && path.weight * share >= least
        {
            Self::follow(surface, towards, share, path, waiting);
        }
    }

    /// What arrives at a pixel's sample.
    fn radiance(&self, x: u32, y: u32, sample: u32) -> Vec3 {
        let frame = self.frame;
        let (seed, up) = (hash(x, y, 1), rgb(frame.up));
        let reach = Vec4::from(frame.up).w;
        let mut total = Vec3::ZERO;
        let eye = rgb(frame.eye);
        let mut path = Waiting { origin: eye, weight: 1.0, direction: self.primary(x, y, sample), depth: 0 };
        let mut waiting = Vec::new();
        let mut ray = Ray::new(path.origin, path.direction);
        let mut purpose = Purpose::Path;
        let mut here: Option<Surface> = None;
        let (mut material, mut diffuse, mut colour) = (0, Vec3::ZERO, Vec3::ZERO);
        let (mut occlusions, mut turn, mut open, mut ambient_waits) = (0, 0, 0.0, false);
        let (mut light, mut seen, mut visible, mut passed) = (0, Vec3::ZERO, 1.0, 0);
        loop {
            let hit = self.twin.trace(&ray, purpose == Purpose::Shadow && frame.transparent == 0);
            let mut again = false;
            match (purpose, hit) {
                (Purpose::Path, hit) => {
                    here = hit.and_then(|hit| Surface::new(self, &hit, path.direction));
                    if let (Some(surface), Some(hit)) = (&here, hit) {
                        material = self.material(hit.triangle);
                        diffuse = self.diffuse(material, surface);
                        colour = self.colour(material + 8);
                        ambient_waits = diffuse != Vec3::ZERO;
                        occlusions = if ambient_waits && path.depth == 0 { frame.occlusion } else { 0 };
                        (turn, open, light) = (0, 0.0, 0);
                        self.branch(material, surface, path, &mut waiting);
                    } else {
                        total += path.weight * self.sky_radiance(path.direction.dot(up));
                    }
                }
                (Purpose::Occlusion, hit) => open += hit.map_or(1.0, |hit| hit.t / reach),
                (Purpose::Shadow, None) => {
                    colour += seen * visible;
                    light += 1;
                }
                (Purpose::Shadow, Some(_)) if frame.transparent == 0 => light += 1,
                (Purpose::Shadow, Some(hit)) => {
                    visible *= self.float(self.material(hit.triangle) + 13);
                    passed += 1;
                    if visible < frame.horizon[3] || passed == MAX_TRANSPARENT {
                        light += 1;
                    } else {
                        ray.t_min = hit.t.next_up().max(f32::MIN_POSITIVE);
                        again = true;
                    }
                }
            }
            if again {
                continue;
            }
            if let Some(surface) = &here {
                let mut next = None;
                while turn < occlusions && next.is_none() {
                    let towards = self.occlusion_direction(surface, seed, sample * frame.occlusion + turn);
                    turn += 1;
                    if towards.dot(surface.geometric) > 0.0 {
                        let ray = Ray::new(surface.lifted(), towards).with_range(0.0, reach);
                        next = Some((Purpose::Occlusion, ray));
                    }
                }
                if next.is_none() && std::mem::take(&mut ambient_waits) {
                    let openness = if occlusions == 0 { 1.0 } else { open / occlusions as f32 };
                    colour += diffuse * self.sky_irradiance(surface.shading.dot(up)) * openness;
                }
                while light < self.lights.len() && next.is_none() {
                    let lamp = &self.lights[light];
                    match self.lit(lamp, material, surface, path.direction, diffuse, path.weight) {
                        None => light += 1,
                        Some((adds, ray)) => {
                            (seen, visible, passed) = (adds, 1.0, 0);
                            next = Some((Purpose::Shadow, ray));
                        }
                    }
                }
                if let Some(next) = next {
                    (purpose, ray) = next;
                    continue;
                }
                total += path.weight * colour;
            }
            let Some(next) = waiting.pop() else { return total };
            path = next;
            (purpose, ray) = (Purpose::Path, Ray::new(path.origin, path.direction));
        }
    }
}
