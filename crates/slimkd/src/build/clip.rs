//! Perfect splits: the bounds of what a voxel holds of a triangle.
//!
//! Source: Wald & Havran 2006 §4.2; Sutherland & Hodgman 1974 for the clipping.
//!
//! Deviation: clipping runs in f64 and the bounds are rounded outwards to f32, then cut to the voxel. Rounding to
//! nearest lost 40 of a million bounce rays in a prototype.

use crate::geometry::Aabb;

/// A triangle cut by six planes has at most nine corners.
const MAX_CORNERS: usize = 9;

/// A convex polygon without heap.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [[f64; 3]; MAX_CORNERS + 1],
    len: usize,
}

impl Polygon {
    fn push(&mut self, corner: [f64; 3]) {
        // Rounding can never add corners beyond one a plane, but a wrong proof must not become a wrong index.
        if self.len < self.corners.len() {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    /// Keeps the part where `sign · (x[axis] − position) ≥ 0`.
    fn clip(&self, axis: usize, position: f64, sign: f64) -> Self {
        let mut out = Self { corners: [[0.0; 3]; MAX_CORNERS + 1], len: 0 };
        let Some(mut previous) = self.len.checked_sub(1).map(|last| self.corners[last]) else { return out };
        let mut before = sign * (previous[axis] - position);
        for &corner in &self.corners[..self.len] {
            let here = sign * (corner[axis] - position);
            if (before < 0.0 && here > 0.0) || (before > 0.0 && here < 0.0) {
                out.push(crossing(previous, corner, axis, position));
            }
            if here >= 0.0 {
                out.push(corner);
            }
            (previous, before) = (corner, here);
        }
        out
    }

    fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for corner in &self.corners[..self.len] {
            for k in 0..3 {
                min[k] = min[k].min(corner[k]);
                max[k] = max[k].max(corner[k]);
            }
        }
        (min, max)
    }
}

/// Where the edge crosses the plane. The same point whichever way the edge is walked, exact on the split axis and
/// on axes along which the edge does not move.
fn crossing(a: [f64; 3], b: [f64; 3], axis: usize, position: f64) -> [f64; 3] {
    let (a, b) = if a[axis] <= b[axis] { (a, b) } else { (b, a) };
    let s = (position - a[axis]) / (b[axis] - a[axis]);
    let mut out: [f64; 3] = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]));
    out[axis] = position;
    out
}

/// Bounds of the parts of a triangle in the two halves of `voxel`, split at `position` on `axis`. A part that is
/// empty is `None`; never both.
pub(crate) fn split_bounds(
    corners: &[[f32; 3]; 3],
    voxel: &Aabb,
    axis: usize,
    position: f32,
) -> (Option<Aabb>, Option<Aabb>) {
    let polygon = polygon_in(corners, voxel);
    let (left_voxel, right_voxel) = voxel.split(axis, position);
    let left = rounded_bounds(&polygon.clip(axis, position.into(), -1.0), &left_voxel);
    let right = rounded_bounds(&polygon.clip(axis, position.into(), 1.0), &right_voxel);
    if left.is_none() && right.is_none() {
        // Rounding ate the triangle: it touches the voxel at most in a corner. Never lose it.
        return (Some(left_voxel), Some(right_voxel));
    }
    (left, right)
}

/// Bounds of what a voxel holds of a triangle that is in it.
pub(crate) fn clipped_bounds(corners: &[[f32; 3]; 3], voxel: &Aabb) -> Aabb {
    // Where rounding eats the triangle, the whole voxel is a safe answer.
    rounded_bounds(&polygon_in(corners, voxel), voxel).unwrap_or(*voxel)
}

fn polygon_in(corners: &[[f32; 3]; 3], voxel: &Aabb) -> Polygon {
    let mut polygon = Polygon { corners: [[0.0; 3]; MAX_CORNERS + 1], len: 3 };
    for (to, from) in polygon.corners.iter_mut().zip(corners) {
        *to = from.map(f64::from);
    }
    let (min, max) = polygon.bounds();
    for k in 0..3 {
        let (low, high) = (f64::from(voxel.min[k]), f64::from(voxel.max[k]));
        if min[k] < low {
            polygon = polygon.clip(k, low, 1.0);
        }
        if max[k] > high {
            polygon = polygon.clip(k, high, -1.0);
        }
    }
    polygon
}

/// Bounds rounded outwards to f32 and cut to the voxel.
fn rounded_bounds(polygon: &Polygon, voxel: &Aabb) -> Option<Aabb> {
    if polygon.len == 0 {
        return None;
    }
    let (min, max) = polygon.bounds();
    Some(Aabb { min: min.map(round_down), max: max.map(round_up) }.cut_to(voxel))
}

fn round_down(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x { nearest.next_down() } else { nearest }
}

fn round_up(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) < x { nearest.next_up() } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const VOXEL: Aabb = Aabb { min: [0.0; 3], max: [1.0; 3] };

    #[test]
    fn a_diagonal_is_cut_tightly() {
        let corners = [[0.0, 0.0, 0.5], [1.0, 1.0, 0.5], [1.0, 0.0, 0.5]];
        let (left, right) = split_bounds(&corners, &VOXEL, 0, 0.25);
        assert_eq!(left.unwrap(), Aabb { min: [0.0, 0.0, 0.5], max: [0.25, 0.25, 0.5] });
        assert_eq!(right.unwrap(), Aabb { min: [0.25, 0.0, 0.5], max: [1.0, 1.0, 0.5] });
    }

    #[test]
    fn a_wall_at_an_unround_coordinate_stays_flat() {
        let corners = [[-3.7, 0.1, -9.1], [5.3, 0.1, 0.7], [0.3, 0.1, 8.8]];
        let (left, _) = split_bounds(&corners, &VOXEL, 2, 0.3);
        let left = left.unwrap();
        assert_eq!((left.min[1], left.max[1]), (0.1, 0.1));
    }

    proptest! {
        #[test]
        fn every_point_of_the_triangle_in_a_half_lies_in_its_bounds(
            corners in prop::array::uniform3(prop::array::uniform3(-2.0f32..3.0)),
            axis in 0usize..3, position in 0.01f32..0.99, s in 0.0f64..1.0, r in 0.0f64..1.0,
        ) {
            let (left, right) = split_bounds(&corners, &VOXEL, axis, position);
            let (s, r) = if s + r > 1.0 { (1.0 - s, 1.0 - r) } else { (s, r) };
            let point: [f64; 3] = std::array::from_fn(|k| {
                let [a, b, c] = corners.map(|p| f64::from(p[k]));
                a + s * (b - a) + r * (c - a)
            });
            let inside = |bounds: &Aabb, by: f64| (0..3).all(|k| {
                point[k] >= f64::from(bounds.min[k]) - by && point[k] <= f64::from(bounds.max[k]) + by
            });
            if inside(&VOXEL, 0.0) {
                let half = if point[axis] <= f64::from(position) { left } else { right };
                prop_assert!(half.is_some_and(|bounds| inside(&bounds, 1e-12)));
            }
        }
    }
}
