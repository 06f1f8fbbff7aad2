//! What a query does with the hits that a traversal offers.

use super::conditions::NO_TRIANGLE;
use super::prepared::PreparedRay;
use crate::geometry::{Estimate, Hit, Intersection};
use crate::layout::MeshView;
use std::cmp::Ordering;

/// Receives every intersection that a traversal finds.
pub(crate) trait Sink: Sized {
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
    /// Takes a triangle that the ray may hit, with what f32 knows of it, and decides no more than it needs. `true` ends the traversal.
    /// Whoever calls this calls [`Sink::settle`] at the end.
    #[inline(always)]
    fn consider(
        &mut self,
        ray: &PreparedRay,
        _estimate: Estimate,
        triangle: u32,
        mesh: &MeshView<'_>,
    ) -> bool {
        ray.hand_over(ray.shear.decide(&corners_of(mesh, triangle)), triangle, self)
    }
    /// Decides what [`Sink::consider`] left open.
    #[inline(always)]
    fn settle(&mut self, _ray: &PreparedRay, _mesh: &MeshView<'_>) {}
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

/// The corners of a triangle that a leaf of the tree named, since sinks are asked about no others.
#[inline(always)]
fn corners_of(mesh: &MeshView<'_>, triangle: u32) -> [[f32; 3]; 3] {
    // SAFETY: a proved tree's leaves name triangles of its mesh.
    unsafe { mesh.corners(triangle) }
}

/// A hit between `t_min` and `t_max`. A function of its own: [`Sink::consider`] rarely needs it.
#[inline(never)]
fn decide_exactly(ray: &PreparedRay, corners: &[[f32; 3]; 3]) -> Option<Intersection> {
    ray.shear.decide(corners).filter(|found| ray.t_min <= found.t && found.t <= ray.t_max)
}

/// The nearest hit; equal t goes to the lowest id.
#[derive(Clone, Copy)]
pub(crate) struct Closest {
    /// Its t is the largest that the nearest hit can have.
    hit: Hit,
    /// The least t that it can have; `hit` is decided where the two are the same.
    low: f32,
    except: u32,
}

impl Closest {
    /// No hit yet: t is the ray's end.
    pub(crate) fn new(t_max: f32, except: u32) -> Self {
        Self { hit: Hit { t: t_max, u: 0.0, v: 0.0, triangle: NO_TRIANGLE }, low: t_max, except }
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
            self.low = found.t;
        }
        false
    }

    #[inline(always)]
    fn consider(
        &mut self,
        ray: &PreparedRay,
        estimate: Estimate,
        triangle: u32,
        mesh: &MeshView<'_>,
    ) -> bool {
        let [low, high] = estimate.bounds();
        if estimate.sure {
            if low > self.hit.t {
                return false;
            }
            if high < self.low && low >= ray.t_min {
                self.hit = Hit { t: high, u: 0.0, v: 0.0, triangle };
                self.low = low;
                return false;
            }
        }
        // Too close to an edge, to the ray's ends or to the other hit.
        if let Some(found) = decide_exactly(ray, &corners_of(mesh, triangle)) {
            if found.t >= self.low {
                self.settle(ray, mesh);
            }
            self.offer(found, triangle);
        }
        false
    }

    #[inline(always)]
    fn settle(&mut self, ray: &PreparedRay, mesh: &MeshView<'_>) {
        if self.low < self.hit.t {
            let triangle = self.hit.triangle;
            let found = ray.shear.decide(&corners_of(mesh, triangle));
            debug_assert!(found.is_some_and(|found| self.low <= found.t && found.t <= self.hit.t));
            if let Some(found) = found {
                self.hit = Hit { t: found.t, u: found.u, v: found.v, triangle };
                self.low = found.t;
            }
        }
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
#[derive(Clone, Copy)]
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
    fn consider(
        &mut self,
        ray: &PreparedRay,
        estimate: Estimate,
        triangle: u32,
        mesh: &MeshView<'_>,
    ) -> bool {
        let [low, high] = estimate.bounds();
        let inside = estimate.sure & (ray.t_min <= low) & (high <= ray.t_max);
        let outside = estimate.sure & ((high < ray.t_min) | (ray.t_max < low));
        self.found = inside || !outside && decide_exactly(ray, &corners_of(mesh, triangle)).is_some();
        self.found
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
