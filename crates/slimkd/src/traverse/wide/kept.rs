//! What a batch keeps of each ray until its answer is known.

use crate::geometry::{Hit, Intersection};
use crate::traverse::RayConditions;
use crate::traverse::sink::{Any, Closest, Sink};
use crate::traverse::stream::Answers;

/// Where answers go, and what is kept of a ray until its answer is known.
pub(crate) trait Asking: Answers {
    type Kept: Sink + Copy;
    /// The same places, lent.
    type Lent<'b>: Asking<Kept = Self::Kept>
    where
        Self: 'b;

    fn reborrow(&mut self) -> Self::Lent<'_>;
    fn begin(t_max: f32, except: u32) -> Self::Kept;
    fn hit(kept: &Self::Kept) -> Option<Hit>;
}

impl Asking for &mut [Option<Hit>] {
    type Kept = Closest;
    type Lent<'b>
        = &'b mut [Option<Hit>]
    where
        Self: 'b;

    #[inline(always)]
    fn reborrow(&mut self) -> &mut [Option<Hit>] {
        self
    }

    #[inline(always)]
    fn begin(t_max: f32, except: u32) -> Closest {
        Closest::new(t_max, except)
    }

    #[inline(always)]
    fn hit(kept: &Closest) -> Option<Hit> {
        kept.into_hit()
    }
}

impl Asking for &mut [bool] {
    type Kept = Any;
    type Lent<'b>
        = &'b mut [bool]
    where
        Self: 'b;

    #[inline(always)]
    fn reborrow(&mut self) -> &mut [bool] {
        self
    }

    #[inline(always)]
    fn begin(t_max: f32, except: u32) -> Any {
        Any::new(t_max, except)
    }

    #[inline(always)]
    fn hit(kept: &Any) -> Option<Hit> {
        kept.found.then_some(Hit { t: 0.0, u: 0.0, v: 0.0, triangle: 0 })
    }
}

/// Takes the hits of one ray, those that the batch's filter accepts.
pub(super) struct Taking<'a, K> {
    pub(super) kept: &'a mut K,
    /// Position in the batch.
    pub(super) place: usize,
    pub(super) conditions: &'a RayConditions<'a>,
}

impl<K: Sink> Sink for Taking<'_, K> {
    const COHERENT: bool = K::COHERENT;

    #[inline(always)]
    fn offer(&mut self, found: Intersection, triangle: u32) -> bool {
        let hit = Hit { t: found.t, u: found.u, v: found.v, triangle };
        let accepted = self.conditions.filter.is_none()
            || found.t <= self.kept.limit() && self.conditions.accept(self.place, &hit);
        accepted && self.kept.offer(found, triangle)
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.kept.limit()
    }

    #[inline(always)]
    fn knows(&self, triangle: u32) -> bool {
        self.kept.knows(triangle)
    }
}
