//! Inside and outside: points, grids of points, and distances with a sign.
//!
//! A point is inside where a ray from it crosses the surface an odd number of times (`crossings.rs` proves what that means), or where it
//! lies on the surface, exactly. So the answer has no rounding in it, and of a closed mesh it does not depend on the ray.

use super::Tracer;
use crate::geometry::{Aabb, ExactRay};
use crate::traverse::{Crossing, ExactQuery};
use std::ops::Range;

/// How much a ray that asks about inside and outside leaves its axis, so that it seldom runs within walls: two numbers of few bits, which keep
/// exact signs cheap.
const SLANT: [f64; 2] = [11.0 / 128.0, 5.0 / 128.0];

/// Whether a point in mesh coordinates is inside; `found` is room for crossings.
pub(super) fn contains(tracer: &dyn Tracer, point: [f64; 3], found: &mut Vec<Crossing>) -> bool {
    let Aabb { min, max } = tracer.bounds();
    // To the nearest side of the bounds: that crosses least.
    let (mut nearest, mut direction) = (f64::INFINITY, [0.0; 3]);
    for k in 0..3 {
        for (distance, sign) in [(point[k] - f64::from(min[k]), -1.0), (f64::from(max[k]) - point[k], 1.0)] {
            if distance.is_nan() || distance < 0.0 {
                return false;
            }
            if distance < nearest {
                nearest = distance;
                direction = [0.0; 3];
                (direction[k], direction[(k + 1) % 3], direction[(k + 2) % 3]) = (sign, SLANT[0], SLANT[1]);
            }
        }
    }
    let Some(ray) = ExactRay::new(point, direction, [0.0, f64::INFINITY]) else { return false };
    let mut query = ExactQuery::inside(ray, found);
    tracer.exact_with(&mut query);
    query.finish() || found.len() % 2 == 1
}

/// The distance to the nearest point of the surface, negative inside and 0 on it; NaN where there is none.
pub(super) fn signed_distance(tracer: &dyn Tracer, point: [f32; 3], found: &mut Vec<Crossing>) -> f32 {
    let Some(nearest) = tracer.nearest(point, f32::INFINITY) else { return f32::NAN };
    if nearest.distance > 0.0 && contains(tracer, point.map(f64::from), found) {
        -nearest.distance
    } else {
        nearest.distance
    }
}

/// Points at equal steps: what [`Batch::occupancy`](crate::Batch::occupancy) asks about.
///
/// ```
/// use slimkd::Grid;
/// let grid = Grid { first: [0.5, 0.5, 0.5], step: [1.0, 1.0, 2.0], size: [4, 3, 2] };
/// assert_eq!(grid.len(), 24);
/// assert_eq!(grid.point(23), [3.5, 2.5, 2.5]);
/// assert_eq!(grid.index([3, 2, 1]), 23);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Grid {
    /// The point 0, scene units.
    pub first: [f64; 3],
    /// From a point to the next one on each axis, scene units; at least 0, or no point is inside.
    pub step: [f64; 3],
    /// How many points there are on each axis.
    pub size: [usize; 3],
}

impl Grid {
    /// The centres of cells of one size that fill `bounds`, with one half of a cell to spare on each side at most.
    pub fn over(bounds: &Aabb, cell: f64) -> Self {
        let extent = bounds.extent();
        let size = extent.map(|length| ((length / cell).ceil() as usize).max(1));
        let first = std::array::from_fn(|k| {
            let middle = 0.5 * f64::from(bounds.min[k]) + 0.5 * f64::from(bounds.max[k]);
            middle - 0.5 * cell * (size[k] - 1) as f64
        });
        Self { first, step: [cell; 3], size }
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.size.iter().fold(1, |len, &size| len.saturating_mul(size))
    }

    /// True when there is no point.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The place of a point in an array of all: x runs fastest, z slowest.
    pub fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.size[1] + y) * self.size[0] + x
    }

    /// The point at a place, `first + step · place` rounded to f64.
    pub fn point(&self, index: usize) -> [f64; 3] {
        let [x, y, _] = self.size;
        let at = [index % x, index / x % y, index / x / y];
        std::array::from_fn(|k| self.coordinate(k, at[k]))
    }

    fn coordinate(&self, axis: usize, at: usize) -> f64 {
        self.first[axis] + self.step[axis] * at as f64
    }
}

/// Room for the work on a row of a grid.
#[derive(Default)]
pub(super) struct RowBuffer {
    found: Vec<Crossing>,
    touched: Vec<u32>,
}

impl RowBuffer {
    /// Which points of a row along x are inside, as [`contains`] says: one ray along the row crosses the surface, and a point is inside where an odd
    /// number of crossings lies behind it.
    pub(super) fn fill(&mut self, tracer: &dyn Tracer, grid: &Grid, row: usize, inside: &mut [bool]) {
        inside.fill(false);
        if inside.is_empty() || !grid.step.iter().all(|step| (0.0..f64::INFINITY).contains(step)) {
            return;
        }
        let [_, y, z] = grid.point(row * grid.size[0]);
        // From x = 0 in steps of 1, so that t is x; the range has no end, as a crossing before the first point concerns none.
        let range = [grid.first[0], f64::INFINITY];
        let Some(ray) = ExactRay::new([0.0, y, z], [1.0, 0.0, 0.0], range) else { return };
        let mut query = ExactQuery::line(ray, &mut self.found, &mut self.touched);
        tracer.exact_with(&mut query);
        query.finish();
        // 1. Each crossing turns over what is known of all points up to it: the mark at the last of these, and the sum from there.
        for &(id, sign) in &self.found {
            let Some(corners) = tracer.corners(id) else { continue };
            let before = |at: &usize| ray.order(&corners, sign, ray.scaled(grid.coordinate(0, *at))).is_ge();
            let behind = points_before(0..inside.len(), before);
            if behind > 0 {
                inside[behind - 1] ^= true;
            }
        }
        let mut odd = false;
        for inside in inside.iter_mut().rev() {
            odd ^= *inside;
            *inside = odd;
        }
        // 2. Points that lie on the surface.
        let ids = self.touched.iter().copied().chain(self.found.iter().map(|&(id, _)| id));
        for id in ids {
            let Some(corners) = tracer.corners(id) else { continue };
            let [low, high] =
                [f32::min, f32::max].map(|pick| corners.iter().map(|p| p[0]).reduce(pick).unwrap_or(0.0));
            let first = points_before(0..inside.len(), |at| grid.coordinate(0, *at) < low.into());
            for at in first..inside.len() {
                let x = grid.coordinate(0, at);
                if x > high.into() {
                    break;
                }
                let point = ExactRay::new([x, y, z], [1.0, 0.0, 0.0], [0.0, 0.0]);
                inside[at] |= point.is_some_and(|point| point.starts_on(&corners));
            }
        }
    }
}

/// How many of a row's points are before something, as the first ones are.
fn points_before(mut points: Range<usize>, before: impl Fn(&usize) -> bool) -> usize {
    while !points.is_empty() {
        let middle = points.start + points.len() / 2;
        if before(&middle) { points.start = middle + 1 } else { points.end = middle }
    }
    points.start
}
