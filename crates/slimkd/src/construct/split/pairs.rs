//! The best plane of a small node: every plane against every triangle.
//!
//! Source: Wald & Havran 2006, equation 5 and its naive O(N²) evaluation: for a few dozens of triangles that is fastest, since
//! it has no branch and fills vector registers.

use super::sah::{AxisSah, VoxelSah};
use super::sweep::Split;
use crate::construct::grow::Fragment;
use crate::geometry::Aabb;

/// Most triangles of a small node.
pub(crate) const MOST: usize = 32;
const PLANES: usize = 2 * MOST;
/// Planes that are evaluated at a time: a register's worth or two.
const STEP: usize = 8;

/// The cheapest plane strictly inside the voxel, ties as in `sweep.rs`. At most [`MOST`] fragments.
pub(crate) fn best_split(fragments: &[Fragment], voxel: &Aabb, sah: &VoxelSah) -> Option<Split> {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the instruction set was just found to be there.
        return unsafe { best_split_avx2(fragments, voxel, sah) };
    }
    best_split_anywhere(fragments, voxel, sah)
}

/// The same code for wider registers; the same results, since nothing fuses multiplications and additions.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn best_split_avx2(fragments: &[Fragment], voxel: &Aabb, sah: &VoxelSah) -> Option<Split> {
    best_split_anywhere(fragments, voxel, sah)
}

#[inline(always)]
fn best_split_anywhere(fragments: &[Fragment], voxel: &Aabb, sah: &VoxelSah) -> Option<Split> {
    let n = fragments.len().min(MOST);
    let mut best: Option<Split> = None;
    let mut best_cost = f64::INFINITY;
    let (mut low, mut high, mut planes) = ([0.0f32; MOST], [0.0f32; MOST], [0.0f32; PLANES]);
    let (mut left, mut right, mut planars) = ([0i32; PLANES], [0i32; PLANES], [0i32; PLANES]);
    let (mut to_left, mut to_right) = ([0.0f64; PLANES], [0.0f64; PLANES]);
    for axis in 0..3 {
        let (least, most) = (voxel.min[axis], voxel.max[axis]);
        let (mut count, mut flat) = (0, false);
        for (i, fragment) in fragments[..n].iter().enumerate() {
            (low[i], high[i]) = (fragment.low[axis], fragment.high[axis]);
            flat |= low[i] == high[i];
            for plane in [low[i], high[i]] {
                planes[count & (PLANES - 1)] = plane;
                count += usize::from((least < plane) & (plane < most));
            }
        }
        let count = count.min(PLANES);
        for first in (0..count).step_by(STEP) {
            let planes: &[f32; STEP] = planes[first..].first_chunk().expect("a multiple of STEP");
            let (mut lefts, mut rights, mut flats) = ([0i32; STEP], [0i32; STEP], [0i32; STEP]);
            for (low, high) in low[..n].iter().zip(&high[..n]) {
                for k in 0..STEP {
                    lefts[k] += i32::from(*low < planes[k]);
                    rights[k] += i32::from(*high > planes[k]);
                }
            }
            if flat {
                for (low, high) in low[..n].iter().zip(&high[..n]) {
                    for k in 0..STEP {
                        flats[k] += i32::from((*low == planes[k]) & (*high == planes[k]));
                    }
                }
            }
            for k in 0..STEP {
                left[first + k] = lefts[k] + flats[k];
                right[first + k] = rights[k];
                planars[first + k] = flats[k];
            }
        }
        let sah = sah.on(axis);
        price(&mut to_left[..count], &planes[..count], &left[..count], &right[..count], sah);
        if flat {
            for at in 0..count {
                left[at] -= planars[at];
                right[at] += planars[at];
            }
            price(&mut to_right[..count], &planes[..count], &left[..count], &right[..count], sah);
            for at in 0..count {
                to_right[at] = if planars[at] == 0 { f64::INFINITY } else { to_right[at] };
            }
        } else {
            to_right[..count].fill(f64::INFINITY);
        }
        for at in 0..count {
            let planar_left = to_left[at] <= to_right[at];
            let cost = if planar_left { to_left[at] } else { to_right[at] };
            if cost <= best_cost {
                let position = planes[at] + 0.0;
                // Planes come in no order: of equal ones on an axis the lowest must win.
                let ties = |best: Split| axis > best.axis || position >= best.position;
                if cost < best_cost || !best.is_none_or(ties) {
                    best = Some(Split { cost, axis, position, planar_left });
                    best_cost = cost;
                }
            }
        }
    }
    best
}

#[inline(always)]
fn price(costs: &mut [f64], planes: &[f32], left: &[i32], right: &[i32], sah: AxisSah) {
    let n = costs.len();
    let (planes, left, right) = (&planes[..n], &left[..n], &right[..n]);
    for at in 0..n {
        costs[at] = sah.split(planes[at].into(), left[at], right[at]);
    }
}
