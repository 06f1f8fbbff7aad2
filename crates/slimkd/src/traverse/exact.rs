//! Queries that decide each triangle exactly, on any walk of one ray.
//!
//! The walk follows the ray rounded to f32 ([`ExactRay::rounded`]); only what it tests is decided otherwise, by [`Sink::decide`].
//!
//! **Why it meets every triangle that matters.** Let X = o + t·d be the point where the exact ray meets a closed triangle, M the largest distance
//! per axis from the rounded origin to the bounds, and m how far the rounding moved the origin at most. X lies on the triangle, so the triangle is
//! named by a leaf, or above one, whose closed voxel holds X. The rounded ray's point at the same t differs from X by m for its start and by
//! `2⁻²⁴·|t·d_k| ≤ 2⁻²⁴·(M + m)` for its direction's rounding, whose smallest components may also become 0: `2⁻¹⁵⁰·t`, which the slack's least
//! value covers as it covers the underflow of t. The proof in `prepared.rs` allows a found hit point to be off its triangle by `5·2⁻²⁴·M` and its t to be
//! rounded once, `2⁻²⁴·M`. Neither happens here but for the limit's rounding, which goes upwards. So of its sum `15·2⁻²⁴·M` there stay
//! `9·2⁻²⁴·M` for t₀ and the grid, and all together is below `11·2⁻²⁴·M + 2·m`. The slack is `32·2⁻²⁴·M + 2·m` ([`PreparedRay::moved`]).

use super::prepared::PreparedRay;
use super::sink::Sink;
use super::single::traverse;
use super::Traced;
use crate::geometry::{ExactRay, Intersection};
use crate::layout::Nodes;

/// A triangle that the ray crosses, and 1 where it does so along the triangle's turn, else −1.
pub(crate) type Crossing = (u32, i8);

/// A question that is decided exactly, and its answer.
pub struct ExactQuery<'a> {
    pub(crate) ray: ExactRay,
    /// The rounded ray's end.
    t_max: f32,
    answer: Answer<'a>,
}

/// What is asked, and what was found.
enum Answer<'a> {
    /// Every crossing; triangles may come several times.
    Crossings(&'a mut Vec<Crossing>),
    /// Every crossing, until the ray turns out to start on a triangle.
    Inside { crossings: &'a mut Vec<Crossing>, on_surface: bool },
    /// Every crossing, and triangles that the ray's line may touch in any way.
    Line { crossings: &'a mut Vec<Crossing>, touched: &'a mut Vec<u32> },
}

impl<'a> ExactQuery<'a> {
    fn new(ray: ExactRay, answer: Answer<'a>) -> Self {
        Self { ray, t_max: ray.rounded().0.t_max, answer }
    }

    /// Asks which triangles the ray crosses, to be written over what `found` held.
    pub(crate) fn crossings(ray: ExactRay, found: &'a mut Vec<Crossing>) -> Self {
        found.clear();
        Self::new(ray, Answer::Crossings(found))
    }

    /// [`ExactQuery::crossings`], and whether the ray starts on a triangle.
    pub(crate) fn inside(ray: ExactRay, found: &'a mut Vec<Crossing>) -> Self {
        found.clear();
        Self::new(ray, Answer::Inside { crossings: found, on_surface: false })
    }

    /// [`ExactQuery::crossings`], and which other triangles the ray's line may touch.
    pub(crate) fn line(ray: ExactRay, found: &'a mut Vec<Crossing>, touched: &'a mut Vec<u32>) -> Self {
        found.clear();
        touched.clear();
        Self::new(ray, Answer::Line { crossings: found, touched })
    }

    /// Ends a question about crossings: each triangle once, ascending. `true` where the ray starts on one, as far as that was asked; then the
    /// crossings are not all there.
    pub(crate) fn finish(self) -> bool {
        let (found, on_surface) = match self.answer {
            Answer::Crossings(found) => (found, false),
            Answer::Inside { crossings, on_surface } => (crossings, on_surface),
            Answer::Line { crossings, touched } => {
                touched.sort_unstable();
                touched.dedup();
                (crossings, false)
            }
        };
        found.sort_unstable();
        found.dedup();
        on_surface
    }
}

impl Sink for ExactQuery<'_> {
    #[inline(always)]
    fn decide(&mut self, corners: &[[f32; 3]; 3], triangle: u32) -> Option<bool> {
        let ray = &self.ray;
        let found = match &mut self.answer {
            Answer::Crossings(found) => found,
            Answer::Inside { crossings, on_surface } => {
                if ray.starts_on(corners) {
                    *on_surface = true;
                    return Some(true);
                }
                crossings
            }
            Answer::Line { crossings, touched } => {
                if ray.is_uncertain(corners) {
                    touched.push(triangle);
                }
                crossings
            }
        };
        let sign = ray.crosses(corners);
        if sign != 0 && found.last() != Some(&(triangle, sign)) && ray.reaches(corners, sign) {
            found.push((triangle, sign));
        }
        Some(false)
    }

    fn offer(&mut self, _: Intersection, _: u32) -> bool {
        false
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.t_max
    }
}

/// Lets `query` decide about every triangle that its ray may hit, nearer voxels first.
pub(crate) fn traverse_exactly<N: Nodes>(tree: Traced<'_, N>, query: &mut ExactQuery<'_>) {
    let (ray, moved) = query.ray.rounded();
    if let Some(prepared) = PreparedRay::moved(&ray, moved, tree.bounds, &tree.nodes.planes()) {
        traverse(tree.nodes, tree.depth, &prepared, query);
    }
}
