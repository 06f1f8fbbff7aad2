//! Shapes with flat faces: few, large triangles.

use crate::procedural::builder::{Builder, Closure};
use crate::procedural::frame::Frame;
use glam::Vec3;

impl Builder {
    /// The parallelogram `origin + s·u + t·v`, facing u × v, of `nu` by `nv` cells.
    pub(crate) fn panel(&mut self, origin: Vec3, u: Vec3, v: Vec3, nu: u32, nv: u32) {
        let normal = u.cross(v).normalize_or(Vec3::Y);
        self.patch(nu, nv, Closure::OPEN, |s, t| (origin + u * s + v * t, normal));
    }

    /// A rectangle of two triangles; see [`Builder::panel`].
    pub(crate) fn quad(&mut self, origin: Vec3, u: Vec3, v: Vec3) {
        self.panel(origin, u, v, 1, 1);
    }

    /// A box of 12 triangles between two corners.
    pub(crate) fn cuboid(&mut self, min: Vec3, max: Vec3) {
        let size = max - min;
        let [x, y, z] = [Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z];
        for (origin, u, v) in
            [(min, y, x), (min, z, y), (min, x, z), (max, -x, -y), (max, -y, -z), (max, -z, -x)]
        {
            self.quad(origin, u, v);
        }
    }

    /// A box that stands on the ground of the frame: centre (x, z), base at `y`, sizes along the axes.
    pub(crate) fn block(&mut self, x: f32, y: f32, z: f32, size: Vec3) {
        let base = Vec3::new(x - 0.5 * size.x, y, z - 0.5 * size.z);
        self.cuboid(base, base + size);
    }

    /// The walls of a room seen from inside: no, or a hole of `hole` (x0, y0, x1, y1) in a `width` by `height` wall of
    /// the plane z = 0 that faces +z.
    pub(crate) fn wall(&mut self, width: f32, height: f32, hole: Option<[f32; 4]>) {
        let mut piece = |x0: f32, y0: f32, x1: f32, y1: f32| {
            if x1 > x0 && y1 > y0 {
                self.quad(Vec3::new(x0, y0, 0.0), Vec3::X * (x1 - x0), Vec3::Y * (y1 - y0));
            }
        };
        let Some([x0, y0, x1, y1]) = hole else { return piece(0.0, 0.0, width, height) };
        piece(0.0, 0.0, width, y0);
        piece(0.0, y1, width, height);
        piece(0.0, y0, x0, y1);
        piece(x1, y0, width, y1);
    }

    /// A straight bar of rectangular section from `a` to `b`: 12 triangles, long and skinny.
    pub(crate) fn beam(&mut self, a: Vec3, b: Vec3, width: f32, depth: f32) {
        let length = (b - a).length();
        self.within(Frame::upright(a, b - a), |b| {
            b.block(0.0, 0.0, 0.0, Vec3::new(width, length, depth));
        });
    }

    /// An I-section bar from `a` to `b`: three plates.
    pub(crate) fn girder(&mut self, a: Vec3, b: Vec3, size: f32) {
        let length = (b - a).length();
        let plate = 0.08 * size;
        self.within(Frame::upright(a, b - a), |b| {
            b.block(0.0, 0.0, 0.0, Vec3::new(plate, length, size - 2.0 * plate));
            for side in [-1.0, 1.0] {
                b.block(0.0, 0.0, side * 0.5 * (size - plate), Vec3::new(size, length, plate));
            }
        });
    }

    /// A box with rounded edges of `radius`, `n` cells along each quarter turn; its flat middle has few cells. A plain
    /// box for `n` of 0.
    pub(crate) fn pillow(&mut self, center: Vec3, half: Vec3, radius: f32, n: u32) {
        if n == 0 {
            return self.cuboid(center - half, center + half);
        }
        // A flat middle always remains, however thin: else its cells would collapse.
        let radius = radius.min(0.97 * half.min_element());
        let inner = half - Vec3::splat(radius);
        let middle = (n / 2).max(1);
        let cells = 2 * n + middle;
        // Along one direction of a face: where on the inner box, and how far the normal leans.
        let lean = |t: f32| {
            let k = t * cells as f32;
            let (first, last) = (n as f32, (n + middle) as f32);
            if k < first {
                (-1.0, k / first - 1.0)
            } else if k > last {
                (1.0, (k - last) / first)
            } else {
                (2.0 * (k - first) / middle as f32 - 1.0, 0.0)
            }
        };
        for axis in 0..3 {
            for side in [-1.0f32, 1.0] {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                self.patch(cells, cells, Closure::OPEN, |s, t| {
                    let ((core_u, lean_u), (core_v, lean_v)) = (lean(s), lean(t));
                    let (mut normal, mut core) = (Vec3::ZERO, Vec3::ZERO);
                    (normal[axis], normal[u], normal[v]) = (side, lean_u, lean_v);
                    (core[axis], core[u], core[v]) =
                        (side * inner[axis], core_u * inner[u], core_v * inner[v]);
                    let normal = normal.normalize();
                    (center + core + normal * radius, normal)
                });
            }
        }
    }
}
