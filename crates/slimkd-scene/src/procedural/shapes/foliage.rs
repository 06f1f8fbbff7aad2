//! Plants: leaf cards, blades of grass, trees.

use crate::procedural::builder::Builder;
use crate::procedural::math::Rng;
use glam::Vec3;

/// Where a leaf grows from, where to, and how wide it is.
pub(crate) struct Leaf {
    pub(crate) base: Vec3,
    pub(crate) way: Vec3,
    pub(crate) width: f32,
    pub(crate) droop: f32,
}

impl Leaf {
    /// A leaf of about `size` metres at `base`, lying in any direction but mostly flat.
    pub(crate) fn scattered(rng: &mut Rng, base: Vec3, size: f32, droop: f32) -> Self {
        let mut way = rng.direction();
        way.y *= 0.5;
        let length = size * rng.range(0.7, 1.15);
        Self {
            base,
            way: way.normalize_or(Vec3::X) * length,
            width: 0.55 * length,
            droop: droop * rng.unit(),
        }
    }
}

impl Builder {
    /// `count` leaves of four triangles, folded along the midrib and drooping at the tip.
    pub(crate) fn leaves(&mut self, count: usize, mut leaf: impl FnMut(&mut Rng) -> Leaf) {
        const TRIANGLES: [[u32; 3]; 4] = [[0, 1, 2], [0, 2, 3], [1, 4, 2], [2, 4, 3]];
        self.pieces(count, TRIANGLES, |rng, _| {
            let Leaf { base, way, width, droop } = leaf(rng);
            let length = way.length();
            let along = way.normalize_or(Vec3::Y);
            let side =
                along.cross(Vec3::Y + rng.direction() * 0.4).normalize_or(along.any_orthonormal_vector());
            let up = side.cross(along);
            let middle = base + way * 0.55;
            let fold = up * (0.12 * width);
            let tip = base + way - Vec3::Y * (droop * length);
            [
                (base, up),
                (middle - side * (0.5 * width) + fold, up - side * 0.3),
                (middle, up),
                (middle + side * (0.5 * width) + fold, up + side * 0.3),
                (tip, up),
            ]
        });
    }

    /// `count` blades, one triangle each: grass, or the pile of a carpet.
    pub(crate) fn blades(
        &mut self,
        count: usize,
        width: f32,
        mut blade: impl FnMut(&mut Rng) -> (Vec3, Vec3),
    ) {
        self.pieces(count, [[0, 1, 2]], |rng, _| {
            let (root, way) = blade(rng);
            let side = way.cross(rng.direction()).normalize_or(way.any_orthonormal_vector());
            let normal = side.cross(way).normalize_or(Vec3::Y);
            let normal = (normal * if normal.y < 0.0 { -1.0 } else { 1.0 } + Vec3::Y).normalize_or(Vec3::Y);
            [
                (root - side * (0.5 * width), normal),
                (root + side * (0.5 * width), normal),
                (root + way, normal),
            ]
        });
    }
}
