//! The surface area heuristic: what a split or a leaf is expected to cost a random ray.
//!
//! Source: MacDonald & Booth 1990; Wald & Havran 2006, equations 2–6.

use super::SahConstants;
use crate::geometry::Aabb;

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
    pub(crate) fn split(&self, axis: usize, position: f64, left: u32, right: u32) -> f64 {
        let p_left = self.base[axis] + self.slope[axis] * (position - self.min[axis]);
        let p_right = self.base[axis] + self.slope[axis] * (self.max[axis] - position);
        let tests = p_left * f64::from(left) + p_right * f64::from(right);
        let cost = self.traversal + self.intersection * tests;
        if left == 0 || right == 0 { cost * self.bonus } else { cost }
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
