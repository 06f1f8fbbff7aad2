//! What the builder of boxes splits: references to triangles, each with the box of the part that it stands for.

use crate::geometry::Aabb;

/// A box in two vectors of four lanes, so that growing it takes two instructions. The fourth lanes mean nothing.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
pub(super) struct Box4 {
    pub(super) min: [f32; 4],
    pub(super) max: [f32; 4],
}

impl Box4 {
    pub(super) const EMPTY: Self = Self { min: [f32::INFINITY; 4], max: [f32::NEG_INFINITY; 4] };

    #[inline(always)]
    pub(super) fn include(&mut self, other: &Self) {
        for k in 0..4 {
            self.min[k] = if other.min[k] < self.min[k] { other.min[k] } else { self.min[k] };
            self.max[k] = if other.max[k] > self.max[k] { other.max[k] } else { self.max[k] };
        }
    }

    #[inline(always)]
    pub(super) fn include_point(&mut self, point: [f32; 4]) {
        self.include(&Self { min: point, max: point });
    }

    pub(super) fn union(mut self, other: &Self) -> Self {
        self.include(other);
        self
    }

    /// Half the surface area; 0 where it is empty.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|k| (f64::from(self.max[k]) - f64::from(self.min[k])).max(0.0));
        x * y + y * z + z * x
    }

    pub(super) fn aabb(&self) -> Aabb {
        let three = |v: &[f32; 4]| [v[0], v[1], v[2]];
        Aabb { min: three(&self.min), max: three(&self.max) }
    }
}

/// A triangle, or a part of one. The id lies in the fourth lane of the upper corner: ids stay below 2³⁰, so it is never a NaN.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference(pub(super) Box4);

impl Reference {
    pub(super) fn new(bounds: &Aabb, id: u32) -> Self {
        let ([a, b, c], [d, e, f]) = (bounds.min, bounds.max);
        Self(Box4 { min: [a, b, c, 0.0], max: [d, e, f, f32::from_bits(id)] })
    }

    pub(super) fn id(&self) -> u32 {
        self.0.max[3].to_bits()
    }

    /// Twice the centre on an axis.
    #[inline(always)]
    pub(super) fn center(&self, axis: usize) -> f32 {
        self.0.min[axis] + self.0.max[axis]
    }
}
