//! The surface area heuristic: what a split or a leaf is expected to cost a random ray.
//!
//! Source: MacDonald & Booth 1990; Wald & Havran 2006, equations 2–6.

use crate::geometry::Aabb;
use crate::options::SahConstants;

/// SAH of one voxel: costs are per ray that meets the voxel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VoxelSah {
    traversal: f64,
    intersection: f64,
    bonus: f64,
    min: [f64; 3],
    max: [f64; 3],
    /// Per axis, the chance to meet a side of thickness x is `base + slope · x`.
    base: [f64; 3],
    slope: [f64; 3],
}

impl VoxelSah {
    pub(crate) fn new(constants: &SahConstants, voxel: &Aabb) -> Self {
        let [x, y, z] = voxel.extent();
        let area = x * y + y * z + z * x;
        // A voxel without area (all in one line) is met by nobody: any split is as good as any other.
        let scale = if area > 0.0 { 1.0 / area } else { 0.0 };
        Self {
            traversal: constants.traversal.into(),
            intersection: constants.intersection.into(),
            bonus: constants.empty_bonus.into(),
            min: voxel.min.map(f64::from),
            max: voxel.max.map(f64::from),
            base: [y * z * scale, z * x * scale, x * y * scale],
            slope: [(y + z) * scale, (z + x) * scale, (x + y) * scale],
        }
    }

    /// Cost of a leaf of `count` triangles.
    #[inline(always)]
    pub(crate) fn leaf(&self, count: usize) -> f64 {
        self.intersection * count as f64
    }

    /// Cost of a split at `position` with `left` and `right` triangles in the children.
    #[inline(always)]
    pub(crate) fn split(&self, axis: usize, position: f64, left: i32, right: i32) -> f64 {
        self.on(axis).split(position, left, right)
    }

    /// The same for one axis.
    #[inline(always)]
    pub(crate) fn on(&self, axis: usize) -> AxisSah {
        AxisSah {
            traversal: self.traversal,
            intersection: self.intersection,
            bonus: self.bonus,
            min: self.min[axis],
            max: self.max[axis],
            base: self.base[axis],
            slope: self.slope[axis],
        }
    }
}

/// SAH of a voxel's splits on one axis; small enough to stay in registers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxisSah {
    traversal: f64,
    intersection: f64,
    bonus: f64,
    min: f64,
    max: f64,
    base: f64,
    slope: f64,
}

impl AxisSah {
    /// Cost of a split at `position` with `left` and `right` triangles in the children.
    #[inline(always)]
    pub(crate) fn split(&self, position: f64, left: i32, right: i32) -> f64 {
        let cost = self.at(position, position, left, right);
        cost * if (left == 0) | (right == 0) { self.bonus } else { 1.0 }
    }

    /// No split in `range` with at least these triangles in the children is cheaper, rounding included.
    #[inline(always)]
    pub(crate) fn least(&self, range: (f64, f64), left: i32, right: i32) -> f64 {
        let cost = self.at(range.0, range.1, left, right);
        cost * if (left == 0) | (right == 0) { self.bonus.min(1.0) } else { 1.0 }
    }

    /// No split in `range` with at most these triangles in the children is dearer, rounding included.
    #[inline(always)]
    pub(crate) fn most(&self, range: (f64, f64), left: i32, right: i32) -> f64 {
        self.at(range.1, range.0, left, right) * self.bonus.max(1.0)
    }

    /// Cost of a left child up to one position and a right child from another.
    #[inline(always)]
    fn at(&self, left_to: f64, right_from: f64, left: i32, right: i32) -> f64 {
        let p_left = self.base + self.slope * (left_to - self.min);
        let p_right = self.base + self.slope * (self.max - right_from);
        let tests = p_left * f64::from(left) + p_right * f64::from(right);
        self.traversal + self.intersection * tests
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_a_cube_costs_what_the_areas_say() {
        let constants = SahConstants { traversal: 1.0, intersection: 2.0, empty_bonus: 0.5 };
        let sah = VoxelSah::new(&constants, &Aabb { min: [0.0; 3], max: [1.0; 3] });
        let half = 4.0 / 6.0; // a half cube has 4 of 6 unit faces
        assert!((sah.split(0, 0.5, 3, 5) - (1.0 + 2.0 * 8.0 * half)).abs() < 1e-12);
        assert!((sah.split(1, 0.5, 0, 5) - 0.5 * (1.0 + 2.0 * 5.0 * half)).abs() < 1e-12);
        assert_eq!(sah.leaf(4), 8.0);
    }
}
