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

    /// Of equal bounds, the own ones stay: so it does not matter in which groups boxes are put together.
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

    #[inline(always)]
    pub(super) fn union(mut self, other: &Self) -> Self {
        self.include(other);
        self
    }

    /// What both hold; it may be empty.
    #[inline(always)]
    pub(super) fn cut_to(&self, other: &Self) -> Self {
        let mut both = *self;
        for k in 0..4 {
            both.min[k] = if other.min[k] > both.min[k] { other.min[k] } else { both.min[k] };
            both.max[k] = if other.max[k] < both.max[k] { other.max[k] } else { both.max[k] };
        }
        both
    }

    pub(super) fn is_empty(&self) -> bool {
        !(0..3).all(|k| self.min[k] <= self.max[k])
    }

    /// Half the surface area; 0 where nothing was included.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f64 {
        let mut extent = [0.0; 3];
        for k in 0..3 {
            let own = f64::from(self.max[k]) - f64::from(self.min[k]);
            extent[k] = if own > 0.0 { own } else { 0.0 };
        }
        let [x, y, z] = extent;
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

/// To fill room with.
impl Default for Reference {
    fn default() -> Self {
        Self(Box4::EMPTY)
    }
}

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

    /// Twice the centre.
    #[inline(always)]
    pub(super) fn centers(&self) -> [f32; 4] {
        let mut center = [0.0; 4];
        for k in 0..4 {
            center[k] = self.0.min[k] + self.0.max[k];
        }
        center
    }
}

/// Equal bins over a box, on all axes at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    low: [f32; 4],
    /// 0 on axes without extent, whose only bin is the first.
    scale: [f32; 4],
    width: [f32; 4],
    last: f32,
}

/// 2²³: a number below, added to it, lies in the lowest bits.
const SHIFT: f32 = 8_388_608.0;

impl Grid {
    pub(super) fn new(bounds: &Box4, bins: usize) -> Self {
        let mut grid = Self { low: bounds.min, scale: [0.0; 4], width: [0.0; 4], last: (bins - 1) as f32 };
        for k in 0..3 {
            let extent = bounds.max[k] - bounds.min[k];
            let (width, scale) = (extent / bins as f32, bins as f32 / extent);
            if extent > 0.0 && width > f32::MIN_POSITIVE && scale.is_finite() {
                (grid.scale[k], grid.width[k]) = (scale, width);
            }
        }
        grid
    }

    /// Whether an axis has more than one bin.
    pub(super) fn has(&self, axis: usize) -> bool {
        self.scale[axis] > 0.0
    }

    /// The bins of a point. They do not fall from a coordinate to a larger one.
    #[inline(always)]
    pub(super) fn bins(&self, point: &[f32; 4]) -> [u32; 4] {
        let mut bins = [0; 4];
        for k in 0..4 {
            // Half a bin less, as what follows rounds to the nearest. Written so that NaN is 0.
            let place = (point[k] - self.low[k]) * self.scale[k] - 0.5;
            let place = if place > 0.0 { place } else { 0.0 };
            let place = if place < self.last { place } else { self.last };
            bins[k] = (place + SHIFT).to_bits() & 0xff;
        }
        bins
    }

    /// The bin on one axis, the same as [`Grid::bins`] says.
    #[inline(always)]
    pub(super) fn bin(&self, axis: usize, x: f32) -> u32 {
        let place = (x - self.low[axis]) * self.scale[axis] - 0.5;
        let place = if place > 0.0 { place } else { 0.0 };
        let place = if place < self.last { place } else { self.last };
        (place + SHIFT).to_bits() & 0xff
    }

    /// The plane below a bin.
    #[inline(always)]
    pub(super) fn plane(&self, axis: usize, bin: usize) -> f32 {
        self.low[axis] + self.width[axis] * bin as f32
    }
}
