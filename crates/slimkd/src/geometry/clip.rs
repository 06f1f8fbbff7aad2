//! Perfect splits: the bounds of what a voxel holds of a triangle.
//!
//! Source: Wald & Havran 2006 §4.2; Sutherland & Hodgman 1974 for the clipping.
//!
//! Deviation: clipping runs in f64 and the bounds are rounded outwards to f32, then cut to the voxel. Rounding to
//! nearest lost 40 of a million bounce rays in a prototype.

use crate::geometry::Aabb;

/// A triangle cut by six planes has at most nine corners; one more is written and not counted.
const MOST_CORNERS: usize = 10;

/// A convex polygon without heap.
#[derive(Clone, Copy)]
pub(crate) struct Polygon {
    corners: [[f64; 3]; MOST_CORNERS],
    len: usize,
}

/// Room for clipping, to be reused: clearing it for every triangle would cost as much as the clipping.
pub(crate) struct Clipper {
    polygon: Polygon,
    other: Polygon,
}

impl Default for Clipper {
    fn default() -> Self {
        let polygon = Polygon { corners: [[0.0; 3]; MOST_CORNERS], len: 0 };
        Self { polygon, other: polygon }
    }
}

impl Polygon {
    /// A whole triangle.
    pub(crate) fn new(triangle: &[[f32; 3]; 3]) -> Self {
        let mut corners = [[0.0; 3]; MOST_CORNERS];
        for (to, from) in corners.iter_mut().zip(triangle) {
            *to = from.map(f64::from);
        }
        Self { corners, len: 3 }
    }

    #[inline(always)]
    fn push(&mut self, corner: [f64; 3]) {
        // Rounding can never add corners beyond one a plane, but a wrong proof must not become a wrong index.
        if self.len < MOST_CORNERS {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    /// Itself where it has at most four corners, else triangles that it consists of.
    pub(crate) fn fan(self) -> impl Iterator<Item = Self> {
        let small = self.len <= 4;
        let whole = small.then_some(self);
        let triangles = if small { 1..1 } else { 1..self.len - 1 };
        whole.into_iter().chain(triangles.map(move |k| {
            let mut corners = [[0.0; 3]; MOST_CORNERS];
            (corners[0], corners[1], corners[2]) = (self.corners[0], self.corners[k], self.corners[k + 1]);
            Self { corners, len: 3 }
        }))
    }

    pub(crate) fn corners(&self) -> &[[f64; 3]] {
        &self.corners[..self.len.min(MOST_CORNERS)]
    }

    /// Into `out`, the part where `sign · (x[axis] − position) ≥ 0`.
    pub(crate) fn clip(&self, axis: usize, position: f64, sign: f64, out: &mut Self) {
        out.len = 0;
        let Some(&(mut previous)) = self.corners().last() else { return };
        let mut before = sign * (previous[axis] - position);
        for &corner in self.corners() {
            let here = sign * (corner[axis] - position);
            if crosses(before, here) {
                out.push(crossing(previous, corner, axis, position));
            }
            if here >= 0.0 {
                out.push(corner);
            }
            (previous, before) = (corner, here);
        }
    }
}

/// Bounds that grow, f64.
#[derive(Clone, Copy)]
struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
}

impl Bounds {
    const EMPTY: Self = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    #[inline(always)]
    fn include(&mut self, corner: &[f64; 3]) {
        for k in 0..3 {
            // Not f64::min, whose care for NaN costs two more instructions.
            self.min[k] = if corner[k] < self.min[k] { corner[k] } else { self.min[k] };
            self.max[k] = if corner[k] > self.max[k] { corner[k] } else { self.max[k] };
        }
    }

    /// Rounded outwards to f32 and cut to the voxel; `None` when nothing was included.
    fn rounded(&self, voxel: &Aabb) -> Option<Aabb> {
        if self.min[0] > self.max[0] {
            return None;
        }
        Some(Aabb { min: self.min.map(round_down), max: self.max.map(round_up) }.cut_to(voxel))
    }
}

/// Where the edge crosses the plane. The same point whichever way the edge is walked, exact on the split axis and
/// on axes along which the edge does not move.
#[inline(always)]
fn crossing(a: [f64; 3], b: [f64; 3], axis: usize, position: f64) -> [f64; 3] {
    let (a, b) = if a[axis] <= b[axis] { (a, b) } else { (b, a) };
    let s = (position - a[axis]) / (b[axis] - a[axis]);
    let mut out = [0.0; 3];
    for k in 0..3 {
        out[k] = a[k] + s * (b[k] - a[k]);
    }
    out[axis] = position;
    out
}

/// Whether an edge between corners at these signed distances crosses the plane.
#[inline(always)]
fn crosses(before: f64, here: f64) -> bool {
    (before < 0.0 && here > 0.0) || (before > 0.0 && here < 0.0)
}

impl Clipper {
    /// Bounds of the parts of a triangle in the two halves of `voxel`, split at `position` on `axis`. A part that is
    /// empty is `None`; never both.
    pub(crate) fn split_bounds(
        &mut self,
        corners: &[[f32; 3]; 3],
        voxel: &Aabb,
        axis: usize,
        position: f32,
    ) -> (Option<Aabb>, Option<Aabb>) {
        self.load(corners, voxel);
        let (mut left, mut right) = (Bounds::EMPTY, Bounds::EMPTY);
        if let Some(&(mut previous)) = self.polygon.corners().last() {
            let plane = f64::from(position);
            let mut before = previous[axis] - plane;
            for &corner in self.polygon.corners() {
                let here = corner[axis] - plane;
                if crosses(before, here) {
                    let point = crossing(previous, corner, axis, plane);
                    left.include(&point);
                    right.include(&point);
                }
                if here <= 0.0 {
                    left.include(&corner);
                }
                if here >= 0.0 {
                    right.include(&corner);
                }
                (previous, before) = (corner, here);
            }
        }
        let (left_voxel, right_voxel) = voxel.split(axis, position);
        match (left.rounded(&left_voxel), right.rounded(&right_voxel)) {
            // Rounding ate the triangle: it touches the voxel at most in a corner. Never lose it.
            (None, None) => (Some(left_voxel), Some(right_voxel)),
            parts => parts,
        }
    }

    /// Bounds of what a voxel holds of a triangle that is in it.
    pub(crate) fn bounds(&mut self, corners: &[[f32; 3]; 3], voxel: &Aabb) -> Aabb {
        self.load(corners, voxel);
        let mut bounds = Bounds::EMPTY;
        self.polygon.corners().iter().for_each(|corner| bounds.include(corner));
        // Where rounding eats the triangle, the whole voxel is a safe answer.
        bounds.rounded(voxel).unwrap_or(*voxel)
    }

    /// Cuts a triangle to the voxel.
    fn load(&mut self, corners: &[[f32; 3]; 3], voxel: &Aabb) {
        for (to, from) in self.polygon.corners.iter_mut().zip(corners) {
            *to = from.map(f64::from);
        }
        self.polygon.len = 3;
        for k in 0..3 {
            let [a, b, c] = [corners[0][k], corners[1][k], corners[2][k]];
            if a.min(b).min(c) < voxel.min[k] {
                self.polygon.clip(k, voxel.min[k].into(), 1.0, &mut self.other);
                std::mem::swap(&mut self.polygon, &mut self.other);
            }
            if a.max(b).max(c) > voxel.max[k] {
                self.polygon.clip(k, voxel.max[k].into(), -1.0, &mut self.other);
                std::mem::swap(&mut self.polygon, &mut self.other);
            }
        }
    }
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
        let (left, right) = Clipper::default().split_bounds(&corners, &VOXEL, 0, 0.25);
        assert_eq!(left.unwrap(), Aabb { min: [0.0, 0.0, 0.5], max: [0.25, 0.25, 0.5] });
        assert_eq!(right.unwrap(), Aabb { min: [0.25, 0.0, 0.5], max: [1.0, 1.0, 0.5] });
    }

    #[test]
    fn a_wall_at_an_unround_coordinate_stays_flat() {
        let corners = [[-3.7, 0.1, -9.1], [5.3, 0.1, 0.7], [0.3, 0.1, 8.8]];
        let (left, _) = Clipper::default().split_bounds(&corners, &VOXEL, 2, 0.3);
        let left = left.unwrap();
        assert_eq!((left.min[1], left.max[1]), (0.1, 0.1));
    }

    proptest! {
        #[test]
        fn every_point_of_the_triangle_in_a_half_lies_in_its_bounds(
            corners in prop::array::uniform3(prop::array::uniform3(-2.0f32..3.0)),
            axis in 0usize..3, position in 0.01f32..0.99, s in 0.0f64..1.0, r in 0.0f64..1.0,
        ) {
            let (left, right) = Clipper::default().split_bounds(&corners, &VOXEL, axis, position);
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
