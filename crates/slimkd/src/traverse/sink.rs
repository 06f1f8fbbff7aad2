//! What a query does with the hits that a traversal offers.

use super::Hit;
use crate::geometry::Intersection;

/// Receives every intersection that a traversal finds.
pub(crate) trait Sink {
    /// Whether its rays go side by side with the ones before them more often than not; see deviation 4 of `single.rs`.
    const COHERENT: bool = false;

    /// Takes an intersection whose t lies in the ray's interval. `true` ends the traversal.
    fn offer(&mut self, found: Intersection, triangle: u32) -> bool;
    /// The largest t that still matters, user units.
    fn limit(&self) -> f32;
    /// Whether offering the triangle once more would change nothing.
    #[inline(always)]
    fn knows(&self, _: u32) -> bool {
        false
    }
    /// A node is visited.
    #[inline(always)]
    fn visit(&mut self) {}
    /// A triangle is tested.
    #[inline(always)]
    fn test(&mut self) {}
}

/// The nearest hit; equal t goes to the lowest id.
pub(crate) struct Closest {
    pub(crate) hit: Hit,
}

impl Closest {
    /// No hit yet: t is the ray's end.
    pub(crate) fn new(t_max: f32) -> Self {
        Self { hit: Hit { t: t_max, u: 0.0, v: 0.0, triangle: u32::MAX } }
    }

    pub(crate) fn into_hit(self) -> Option<Hit> {
        (self.hit.triangle != u32::MAX).then_some(self.hit)
    }
}

impl Sink for Closest {
    #[inline(always)]
    fn offer(&mut self, found: Intersection, triangle: u32) -> bool {
        let best = &mut self.hit;
        if found.t < best.t || (found.t == best.t && triangle < best.triangle) {
            *best = Hit { t: found.t, u: found.u, v: found.v, triangle };
        }
        false
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.hit.t
    }

    #[inline(always)]
    fn knows(&self, triangle: u32) -> bool {
        self.hit.triangle == triangle
    }
}

/// Whether there is any hit.
pub(crate) struct Any {
    pub(crate) found: bool,
    pub(crate) t_max: f32,
}

impl Sink for Any {
    const COHERENT: bool = true;

    #[inline(always)]
    fn offer(&mut self, _: Intersection, _: u32) -> bool {
        self.found = true;
        true
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.t_max
    }
}

/// Hits by (t, id), each triangle once: what it was met in twice is the same hit.
pub(crate) fn sort_hits(hits: &mut Vec<Hit>) {
    hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
    hits.dedup_by_key(|hit| hit.triangle);
}

/// Every hit, as often as the triangle was met.
pub(crate) struct All<'a> {
    pub(crate) hits: &'a mut Vec<Hit>,
    pub(crate) t_max: f32,
}

impl Sink for All<'_> {
    #[inline(always)]
    fn offer(&mut self, found: Intersection, triangle: u32) -> bool {
        self.hits.push(Hit { t: found.t, u: found.u, v: found.v, triangle });
        false
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.t_max
    }
}
