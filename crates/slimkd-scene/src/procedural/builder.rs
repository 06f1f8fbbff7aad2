//! Counts or emits triangles, by the same program.
//!
//! A scene is a function that draws on a [`Builder`]. Run on a counting builder it costs next to nothing, so the
//! detail that meets a target is found by bisection; then it runs once more on an emitting one whose buffers have
//! exactly the right size.

use super::frame::Frame;
use super::math::Rng;
use crate::{Attribute, Material, Scene};
use glam::Vec3;
use slimkd::TriangleMesh;

/// Position and normal of a surface point.
pub(crate) type Point = (Vec3, Vec3);

/// How a patch closes upon itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Closure {
    /// u = 1 is u = 0.
    pub(crate) ring: bool,
    /// v = 0 is a single point.
    pub(crate) first_pole: bool,
    /// v = 1 is a single point.
    pub(crate) last_pole: bool,
}

impl Closure {
    pub(crate) const OPEN: Self = Self { ring: false, first_pole: false, last_pole: false };
    pub(crate) const RING: Self = Self { ring: true, first_pole: false, last_pole: false };
    pub(crate) const BALL: Self = Self { ring: true, first_pole: true, last_pole: true };
}

/// A material's number.
pub(crate) type Paint = u32;

/// See the module's head.
pub(crate) struct Builder {
    /// Tessellation, 1 at about a million triangles: segments of a curve grow with it.
    pub(crate) detail: f32,
    /// Random numbers of the scene: a counting and an emitting run draw the same.
    pub(crate) rng: Rng,
    emitting: bool,
    triangle_count: usize,
    vertex_count: usize,
    rounding: u32,
    frame: Frame,
    paint: Paint,
    materials: Vec<Material>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    material_ids: Vec<u32>,
}

impl Builder {
    /// One that only counts.
    pub(crate) fn counting(detail: f32, seed: u64) -> Self {
        Self {
            detail,
            rng: Rng::new(seed),
            emitting: false,
            triangle_count: 0,
            vertex_count: 0,
            rounding: 0,
            frame: Frame::IDENTITY,
            paint: 0,
            materials: Vec::new(),
            positions: Vec::new(),
            normals: Vec::new(),
            triangles: Vec::new(),
            material_ids: Vec::new(),
        }
    }

    /// One that emits, with room for what `counted` has counted.
    pub(crate) fn emitting(detail: f32, seed: u64, counted: &Self) -> Self {
        let (triangles, vertices) = (counted.triangle_count, counted.vertex_count);
        Self {
            emitting: true,
            positions: Vec::with_capacity(vertices),
            normals: Vec::with_capacity(vertices),
            triangles: Vec::with_capacity(triangles),
            material_ids: Vec::with_capacity(triangles),
            ..Self::counting(detail, seed)
        }
    }

    pub(crate) fn triangle_count(&self) -> usize {
        self.triangle_count
    }

    /// The scene; `None` where the mesh is too large for 32-bit ids.
    pub(crate) fn finish(self, name: &str) -> Option<Scene> {
        let mesh = TriangleMesh::new(self.positions, self.triangles).ok()?;
        Some(Scene {
            name: name.to_owned(),
            mesh: mesh.into(),
            materials: self.materials,
            material_ids: self.material_ids,
            normals: Some(Attribute { values: self.normals, indices: None }),
            ..Scene::default()
        })
    }

    /// A new material.
    pub(crate) fn material(&mut self, material: Material) -> Paint {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }

    /// What follows is made of `paint`.
    pub(crate) fn paint(&mut self, paint: Paint) -> &mut Self {
        self.paint = paint;
        self
    }

    /// Segments of something that has `base` of them at detail 1, at least `min`. Rounding is dithered from call to
    /// call: all curves of a scene at once would otherwise jump to the next whole number at the same detail.
    pub(crate) fn segments(&mut self, base: f32, min: u32) -> u32 {
        self.rounding = self.rounding.wrapping_add(1);
        let dither = self.rounding.wrapping_mul(0x9E37_79B9) as f32 / 4_294_967_296.0;
        ((base * self.detail + dither) as u32).clamp(min, 1 << 14)
    }

    /// A number of objects that is `base` at detail 1 and grows with the surface density, detail squared.
    pub(crate) fn count(&mut self, base: f32, min: u32, max: u32) -> u32 {
        self.rounding = self.rounding.wrapping_add(1);
        ((base * self.detail * self.detail) as u32).clamp(min, max)
    }

    /// Whether objects that matter from this detail on are there.
    pub(crate) fn has(&self, detail: f32) -> bool {
        self.detail >= detail
    }

    /// Draws inside a frame.
    pub(crate) fn within(&mut self, frame: Frame, draw: impl FnOnce(&mut Self)) {
        let outer = self.frame;
        self.frame = outer.then(&frame);
        draw(self);
        self.frame = outer;
    }

    /// A grid of `nu` by `nv` cells over the unit square, two triangles a cell, vertices shared.
    pub(crate) fn patch(&mut self, nu: u32, nv: u32, closure: Closure, surface: impl Fn(f32, f32) -> Point) {
        let (columns, rows) = (nu as usize + usize::from(!closure.ring), nv as usize + 1);
        let poles = usize::from(closure.first_pole) + usize::from(closure.last_pole);
        self.vertex_count += columns * (rows - poles) + poles;
        self.triangle_count += nu as usize * (2 * nv as usize - poles);
        if !self.emitting {
            return;
        }
        let first = self.positions.len() as u32;
        for j in 0..=nv {
            let pole = (j == 0 && closure.first_pole) || (j == nv && closure.last_pole);
            let v = j as f32 / nv as f32;
            for i in 0..if pole { 1 } else { columns as u32 } {
                let (position, normal) = surface(i as f32 / nu as f32, v);
                self.vertex(position, normal);
            }
        }
        let columns = columns as u32;
        let index = |i: u32, j: u32| {
            let i = if closure.ring && i == nu { 0 } else { i };
            match j {
                0 if closure.first_pole => first,
                _ if j == nv && closure.last_pole => {
                    first + u32::from(closure.first_pole) + columns * (j - u32::from(closure.first_pole))
                }
                _ if closure.first_pole => first + 1 + columns * (j - 1) + i,
                _ => first + columns * j + i,
            }
        };
        for j in 0..nv {
            for i in 0..nu {
                let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
                if a != b {
                    self.triangle([a, b, if c == d { d } else { c }]);
                }
                if c != d {
                    self.triangle([a, c, d]);
                }
            }
        }
    }

    /// `count` single pieces of the same `vertices` and `triangles`; `piece` gets its own random numbers and writes
    /// positions and normals.
    pub(crate) fn pieces<const V: usize, const T: usize>(
        &mut self,
        count: usize,
        triangles: [[u32; 3]; T],
        mut piece: impl FnMut(&mut Rng, usize) -> [Point; V],
    ) {
        let mut rng = self.rng.fork();
        self.vertex_count += count * V;
        self.triangle_count += count * T;
        if !self.emitting {
            return;
        }
        for k in 0..count {
            let first = self.positions.len() as u32;
            for (position, normal) in piece(&mut rng, k) {
                self.vertex(position, normal);
            }
            for corners in triangles {
                self.triangle(corners.map(|corner| first + corner));
            }
        }
    }

    fn vertex(&mut self, position: Vec3, normal: Vec3) {
        self.positions.push(self.frame.point(position).into());
        self.normals.push(self.frame.normal(normal).into());
    }

    /// Turns the triangle so that its winding agrees with its normals.
    fn triangle(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|corner| Vec3::from(self.positions[corner as usize]));
        let normal: Vec3 = corners.iter().map(|&corner| Vec3::from(self.normals[corner as usize])).sum();
        let [i, j, k] = corners;
        let outwards = (b - a).cross(c - a).dot(normal) >= 0.0;
        self.triangles.push(if outwards { [i, j, k] } else { [i, k, j] });
        self.material_ids.push(self.paint);
    }
}
