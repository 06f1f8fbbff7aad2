//! What a query does with the hits that a traversal offers.

use super::conditions::NO_TRIANGLE;
use crate::geometry::{Hit, Intersection};
use std::cmp::Ordering;

/// Receives every intersection that a traversal finds.
pub(crate) trait Sink {
    /// Whether its rays go side by side with the ones before them more often than not; see deviation 4 of `single.rs`.
    const COHERENT: bool = false;

    /// Whether the walk itself is measured, and must be the same on every machine.
    const MEASURED: bool = false;

    /// Takes an intersection whose t lies in the ray's interval. `true` ends the traversal.
    fn offer(&mut self, found: Intersection, triangle: u32) -> bool;
    /// Decides by itself whether the ray hits a triangle, and takes the hit: then the usual test is left out, and the answer says whether the
    /// traversal ends.
    #[inline(always)]
    fn decide(&mut self, _corners: &[[f32; 3]; 3], _triangle: u32) -> Option<bool> {
        None
    }
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
    hit: Hit,
    except: u32,
}

impl Closest {
    /// No hit yet: t is the ray's end.
    pub(crate) fn new(t_max: f32, except: u32) -> Self {
        Self { hit: Hit { t: t_max, u: 0.0, v: 0.0, triangle: NO_TRIANGLE }, except }
    }

    pub(crate) fn into_hit(self) -> Option<Hit> {
        (self.hit.triangle != NO_TRIANGLE).then_some(self.hit)
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
        (self.hit.triangle == triangle) | (self.except == triangle)
    }
}

/// Whether there is any hit.
pub(crate) struct Any {
    pub(crate) found: bool,
    t_max: f32,
    except: u32,
}

impl Any {
    pub(crate) fn new(t_max: f32, except: u32) -> Self {
        Self { found: false, t_max, except }
    }
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

    #[inline(always)]
    fn knows(&self, triangle: u32) -> bool {
        self.except == triangle
    }
}

/// The first hits along the ray, by t and then by id, each triangle once.
pub(crate) struct First<'a> {
    hits: &'a mut Vec<Hit>,
    /// At most so many.
    most: usize,
    t_max: f32,
    except: u32,
}

impl<'a> First<'a> {
    /// `hits` is empty.
    pub(crate) fn new(hits: &'a mut Vec<Hit>, most: usize, t_max: f32, except: u32) -> Self {
        Self { hits, most, t_max: if most == 0 { f32::NEG_INFINITY } else { t_max }, except }
    }

    fn order(a: &Hit, b: &Hit) -> Ordering {
        a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle))
    }

    /// Brings the hits into their order.
    pub(crate) fn finish(self) {
        // A triangle that was met in two leaves is the same hit twice.
        self.hits.sort_unstable_by(Self::order);
        self.hits.dedup_by_key(|hit| hit.triangle);
    }
}

impl Sink for First<'_> {
    #[inline(always)]
    fn offer(&mut self, found: Intersection, triangle: u32) -> bool {
        let hit = Hit { t: found.t, u: found.u, v: found.v, triangle };
        if self.most == usize::MAX {
            self.hits.push(hit);
            return false;
        }
        if let Err(at) = self.hits.binary_search_by(|other| Self::order(other, &hit))
            && at < self.most
        {
            // The last one makes room.
            self.hits.truncate(self.most - 1);
            self.hits.insert(at, hit);
        }
        false
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        if self.hits.len() < self.most {
            self.t_max
        } else {
            self.hits.last().map_or(self.t_max, |hit| hit.t)
        }
    }

    #[inline(always)]
    fn knows(&self, triangle: u32) -> bool {
        self.except == triangle
    }
}

/// Hands on only what `accept` says yes to. What lies behind the limit is not asked about.
pub(crate) struct Filtered<'a, S> {
    pub(crate) sink: &'a mut S,
    pub(crate) accept: &'a mut dyn FnMut(&Hit) -> bool,
}

impl<S: Sink> Sink for Filtered<'_, S> {
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

    #[inline(always)]
    fn knows(&self, triangle: u32) -> bool {
        self.sink.knows(triangle)
    }
}
