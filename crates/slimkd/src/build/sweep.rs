//! The best split plane of a node, by one pass over each sorted event list.
//!
//! Source: Wald & Havran 2006, algorithm 5. Only planes strictly inside the voxel count; the triangles in a plane go to
//! whichever side is cheaper. Equal costs fall to the lower axis, then the lower position, then "planars left", so the
//! tree does not depend on who computes it.

use super::event::{Event, Kind};
use super::sah::VoxelSah;
use crate::geometry::Aabb;

/// A chosen split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Split {
    pub(crate) cost: f64,
    pub(crate) axis: usize,
    pub(crate) position: f32,
    /// Whether triangles that lie in the plane go left.
    pub(crate) planar_left: bool,
}

/// The cheapest plane on one axis for `count` triangles, or `None` when no event lies strictly inside.
pub(crate) fn best_on_axis(
    events: &[Event],
    axis: usize,
    voxel: &Aabb,
    sah: &VoxelSah,
    count: u32,
) -> Option<Split> {
    let (low, high) = (voxel.min[axis], voxel.max[axis]);
    let (mut left, mut right) = (0u32, count);
    let mut best: Option<Split> = None;
    let mut best_cost = f64::INFINITY;
    let mut i = 0;
    while i < events.len() {
        let key = events[i].key();
        let (mut ends, mut planars, mut starts) = (0u32, 0u32, 0u32);
        while i < events.len() && events[i].key() == key {
            match events[i].kind() {
                Kind::End => ends += 1,
                Kind::Planar => planars += 1,
                Kind::Start => starts += 1,
            }
            i += 1;
        }
        right -= planars + ends;
        let position = events[i - 1].position();
        if low < position && position < high {
            let to_left = sah.split(axis, position.into(), left + planars, right);
            if to_left < best_cost {
                best_cost = to_left;
                best = Some(Split { cost: to_left, axis, position, planar_left: true });
            }
            if planars > 0 {
                let to_right = sah.split(axis, position.into(), left, right + planars);
                if to_right < best_cost {
                    best_cost = to_right;
                    best = Some(Split { cost: to_right, axis, position, planar_left: false });
                }
            }
        }
        left += starts + planars;
    }
    best
}

/// The cheapest of the axes' best planes.
pub(crate) fn cheapest(candidates: [Option<Split>; 3]) -> Option<Split> {
    candidates.into_iter().flatten().reduce(|best, next| if next.cost < best.cost { next } else { best })
}
