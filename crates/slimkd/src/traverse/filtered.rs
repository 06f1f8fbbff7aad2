//! Queries that look away from some triangles: a sink before the query's own.

use super::Hit;
use super::sink::Sink;
use crate::geometry::Intersection;

/// Hands on what `accept` says yes to. What lies behind the limit is not asked about.
pub(crate) struct Filtered<S, F> {
    pub(crate) sink: S,
    pub(crate) accept: F,
}

impl<S: Sink, F: FnMut(&Hit) -> bool> Sink for Filtered<S, F> {
    const COHERENT: bool = S::COHERENT;

    #[inline(always)]
    fn offer(&mut self, found: Intersection, triangle: u32) -> bool {
        let hit = Hit { t: found.t, u: found.u, v: found.v, triangle };
        found.t <= self.sink.limit() && (self.accept)(&hit) && self.sink.offer(found, triangle)
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.sink.limit()
    }
}
