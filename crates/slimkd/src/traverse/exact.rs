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

use super::Traced;
use super::conditions::Conditions;
use super::prepared::PreparedRay;
use super::single::traverse;
use super::sink::Sink;
use super::wide::walk_in_f64;
use crate::geometry::{Aabb, ExactRay, Hit, HitF64, Intersection, above};
use crate::layout::{Nodes, WideNodes};
use std::cmp::Ordering;

/// A triangle that the ray crosses, and 1 where it does so along the triangle's turn, else −1.
pub(crate) type Crossing = (u32, i8);

/// A question that is decided exactly, and its answer.
pub struct ExactQuery<'a> {
    pub(crate) ray: ExactRay,
    /// What is farther does not matter: at least the exact limit, rounded upwards.
    limit: f32,
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
    /// The nearest hit.
    Closest { hit: Option<HitF64>, conditions: Conditions<'a> },
    /// Whether there is any hit.
    Any { hit: Option<HitF64>, conditions: Conditions<'a> },
    /// The first hits, at most so many.
    First { hits: Vec<HitF64>, most: usize, conditions: Conditions<'a> },
}

/// By t and then by id.
fn order(a: &HitF64, b: &HitF64) -> Ordering {
    a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle))
}

/// At least any t that is computed of a triangle that the ray meets at this one or before: those differ by less than 2⁻⁴⁸ of themselves.
fn limit(t: f64) -> f32 {
    above(t + t.abs() / (1u64 << 40) as f64)
}

/// Whether `conditions` let a hit count.
fn counts(conditions: &mut Conditions<'_>, hit: HitF64, ray: &ExactRay) -> bool {
    conditions
        .filter
        .as_mut()
        .is_none_or(|accept| ray.unscaled(hit).is_some_and(|hit| accept(&Hit::from(hit))))
}

impl<'a> ExactQuery<'a> {
    fn new(ray: ExactRay, answer: Answer<'a>) -> Self {
        Self { ray, limit: ray.rounded().0.t_max, answer }
    }

    /// Asks for the nearest hit.
    pub(crate) fn closest(ray: ExactRay, conditions: Conditions<'a>) -> Self {
        Self::new(ray, Answer::Closest { hit: None, conditions })
    }

    /// Asks whether there is any hit.
    pub(crate) fn any(ray: ExactRay, conditions: Conditions<'a>) -> Self {
        Self::new(ray, Answer::Any { hit: None, conditions })
    }

    /// Asks for the first `most` hits, to be put into `hits`, which is empty.
    pub(crate) fn first(ray: ExactRay, most: usize, conditions: Conditions<'a>, hits: Vec<HitF64>) -> Self {
        Self::new(ray, Answer::First { hits, most, conditions })
    }

    /// The hit that was found, of [`ExactQuery::closest`] and [`ExactQuery::any`].
    pub(crate) fn into_hit(self) -> Option<HitF64> {
        match self.answer {
            Answer::Closest { hit, .. } | Answer::Any { hit, .. } => {
                hit.and_then(|hit| self.ray.unscaled(hit))
            }
            _ => None,
        }
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

    /// The hits of [`ExactQuery::first`] in their order.
    pub(crate) fn into_hits(self) -> Vec<HitF64> {
        let Answer::First { mut hits, .. } = self.answer else { return Vec::new() };
        hits.sort_unstable_by(order);
        hits.dedup_by_key(|hit| hit.triangle);
        hits.retain_mut(|hit| self.ray.unscaled(*hit).map(|unscaled| *hit = unscaled).is_some());
        hits
    }

    /// Ends a question about crossings: each triangle once, ascending. `true` where the ray starts on one, as far as that was asked; then they are
    /// not all there.
    pub(crate) fn finish(self) -> bool {
        let (found, on_surface) = match self.answer {
            Answer::Crossings(found) => (found, false),
            Answer::Inside { crossings, on_surface } => (crossings, on_surface),
            Answer::Line { crossings, touched } => {
                touched.sort_unstable();
                touched.dedup();
                (crossings, false)
            }
            Answer::Closest { .. } | Answer::Any { .. } | Answer::First { .. } => return false,
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
            Answer::Closest { hit: best, conditions } => {
                if triangle != conditions.except
                    && let Some(hit) = ray.meets(corners, triangle)
                    && best.is_none_or(|best| order(&hit, &best).is_lt())
                    && counts(conditions, hit, ray)
                {
                    (*best, self.limit) = (Some(hit), limit(hit.t));
                }
                return Some(false);
            }
            Answer::Any { hit: any, conditions } => {
                if triangle != conditions.except {
                    *any = ray.meets(corners, triangle).filter(|hit| counts(conditions, *hit, ray));
                }
                return Some(any.is_some());
            }
            Answer::First { hits, most, conditions } => {
                if triangle != conditions.except
                    && let Some(hit) = ray.meets(corners, triangle)
                    && (*most == usize::MAX || !hits.contains(&hit))
                    && counts(conditions, hit, ray)
                {
                    put(hits, *most, hit);
                    if hits.len() == *most {
                        self.limit = hits.last().map_or(f32::NEG_INFINITY, |last| limit(last.t));
                    }
                }
                return Some(false);
            }
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
        self.limit
    }
}

/// Puts a hit among the first `most` ones, which are in their order unless all are asked for.
fn put(hits: &mut Vec<HitF64>, most: usize, hit: HitF64) {
    if most == usize::MAX {
        return hits.push(hit);
    }
    let at = hits.partition_point(|other| order(other, &hit).is_lt());
    if at < most {
        // The last one makes room.
        hits.truncate(most - 1);
        hits.insert(at, hit);
    }
}

/// Lets `query` decide about every triangle that its ray may hit, nearer voxels first.
pub(crate) fn traverse_exactly<N: Nodes>(tree: Traced<'_, N>, query: &mut ExactQuery<'_>) {
    let (ray, moved) = query.ray.rounded();
    if let Some(prepared) = PreparedRay::moved(&ray, moved, tree.bounds, &tree.nodes.planes()) {
        traverse(tree.nodes, tree.depth, &prepared, query);
    }
}

/// [`traverse_exactly`] through a wide tree: by the walk in f64, which tests nothing in advance.
pub(crate) fn traverse_wide_exactly(nodes: impl WideNodes, bounds: &Aabb, query: &mut ExactQuery<'_>) {
    let (ray, moved) = query.ray.rounded();
    if let Some(prepared) = PreparedRay::moved(&ray, moved, bounds, &nodes.planes()) {
        walk_in_f64(nodes, &prepared, query);
    }
}
