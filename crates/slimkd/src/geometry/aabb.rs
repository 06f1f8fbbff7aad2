//! Axis-aligned boxes: the voxels of the tree and the bounds of triangles.

/// An axis-aligned box, closed on all sides. `min > max` on any axis means empty.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Aabb {
    /// Lower corner, scene units.
    pub min: [f32; 3],
    /// Upper corner, scene units.
    pub max: [f32; 3],
}

impl Aabb {
    /// The box that contains nothing: neutral for [`Aabb::include`].
    pub const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// True when no point lies inside.
    pub fn is_empty(&self) -> bool {
        !(0..3).all(|k| self.min[k] <= self.max[k])
    }

    /// Grows to contain `point`.
    pub fn include(&mut self, point: [f32; 3]) {
        for k in 0..3 {
            self.min[k] = self.min[k].min(point[k]);
            self.max[k] = self.max[k].max(point[k]);
        }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let mut out = *self;
        for k in 0..3 {
            out.min[k] = out.min[k].min(other.min[k]);
            out.max[k] = out.max[k].max(other.max[k]);
        }
        out
    }

    /// Edge lengths, zero where empty; f64 because the difference of two large f32 may overflow.
    pub fn extent(&self) -> [f64; 3] {
        std::array::from_fn(|k| (f64::from(self.max[k]) - f64::from(self.min[k])).max(0.0))
    }

    /// Surface area in square scene units; a flat box has the area of its two faces.
    ///
    /// ```
    /// let unit = slimkd::Aabb { min: [0.0; 3], max: [1.0; 3] };
    /// assert_eq!(unit.surface_area(), 6.0);
    /// ```
    pub fn surface_area(&self) -> f64 {
        let [x, y, z] = self.extent();
        2.0 * (x * y + y * z + z * x)
    }

    /// The centre; finite for every finite box.
    pub fn center(&self) -> [f32; 3] {
        std::array::from_fn(|k| 0.5 * self.min[k] + 0.5 * self.max[k])
    }

    /// The part inside `voxel`; a flat box on its face where they do not meet.
    pub(crate) fn cut_to(&self, voxel: &Self) -> Self {
        Self {
            min: std::array::from_fn(|k| self.min[k].clamp(voxel.min[k], voxel.max[k])),
            max: std::array::from_fn(|k| self.max[k].clamp(voxel.min[k], voxel.max[k])),
        }
    }

    /// Both halves of the box, cut at `position` on `axis`.
    pub(crate) fn split(&self, axis: usize, position: f32) -> (Self, Self) {
        let (mut left, mut right) = (*self, *self);
        left.max[axis] = position;
        right.min[axis] = position;
        (left, right)
    }
}
