//! Which hits count: an excluded triangle, a filter.

use crate::geometry::Hit;
use std::ops::Range;

/// Stands for no excluded triangle: no id has this value.
pub(crate) const NO_TRIANGLE: u32 = u32::MAX;

/// What a hit of one ray must fulfil.
pub struct Conditions<'a> {
    /// The triangle that is left out, or [`NO_TRIANGLE`].
    pub(crate) except: u32,
    pub(crate) filter: Option<&'a mut dyn FnMut(&Hit) -> bool>,
}

impl Conditions<'_> {
    /// Every hit counts.
    pub(crate) fn none() -> Self {
        Self { except: NO_TRIANGLE, filter: None }
    }
}

/// What the hits of a batch's rays must fulfil, ray by ray.
#[derive(Clone, Copy, Default)]
pub(crate) struct RayConditions<'a> {
    /// The triangle that each ray leaves out; `None` where no ray does.
    pub(crate) except: Option<&'a [u32]>,
    /// Added to a ray's position for the filter: these rays are a part of a batch.
    pub(crate) first: usize,
    /// Asked with the ray's position in the batch.
    pub(crate) filter: Option<&'a (dyn Fn(usize, &Hit) -> bool + Sync)>,
}

impl<'a> RayConditions<'a> {
    /// Those of the rays in a range.
    pub(crate) fn of(&self, range: Range<usize>) -> Self {
        let first = self.first + range.start;
        Self { except: self.except.map(|except| &except[range]), first, filter: self.filter }
    }

    /// Those of one ray.
    pub(crate) fn alone<R>(&self, ray: usize, ask: impl FnOnce(Conditions<'_>) -> R) -> R {
        let except = self.excepted(ray);
        match self.filter {
            None => ask(Conditions { except, filter: None }),
            Some(accept) => {
                let ray = self.first + ray;
                ask(Conditions { except, filter: Some(&mut |hit: &Hit| accept(ray, hit)) })
            }
        }
    }

    /// The triangle that a ray leaves out, or [`NO_TRIANGLE`].
    #[inline(always)]
    pub(crate) fn excepted(&self, ray: usize) -> u32 {
        self.except.map_or(NO_TRIANGLE, |except| except[ray])
    }

    /// Whether a hit of a ray counts.
    #[inline(always)]
    pub(crate) fn accept(&self, ray: usize, hit: &Hit) -> bool {
        hit.triangle != self.excepted(ray) && self.filter.is_none_or(|accept| accept(self.first + ray, hit))
    }
}
