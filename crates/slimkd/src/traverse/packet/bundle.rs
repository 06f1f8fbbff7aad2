//! All rays of a walk as one: intervals that hold what each of them has, so that scalars say where all go the same way.
//!
//! Source: Reshetov, Soupikov & Hurley, *Multi-Level Ray Tracing Algorithm*, SIGGRAPH 2005, for intervals in place of rays
//! high up in a kd-tree.
//!
//! Deviations
//! 1. Not for the descent to an entry point alone but at every node, before the lanes are asked: a fifth (San Francisco) to a
//!    half (Sponza) of all nodes are decided so, and nothing of the walk's state changes there.
//! 2. Rounding is monotonic, and both ends are computed by the lanes' operations from the ends of their factors; so no lane
//!    lies outside, and what is left out here is what the lanes would leave out. Where a factor is not finite or has
//!    underflowed, the interval is made to decide nothing.

use super::group::{Class, Group, WIDTH};
use crate::simd::Simd;
use crate::traverse::prepared::{larger, smaller};

/// Ends of what the rays have, by axis.
pub(crate) struct Bundle {
    /// The starts that give the least and the most t, plane coordinates.
    pub(crate) plane_origin: [[f32; 2]; 3],
    /// Least and most of `Group::inverse`; of one sign.
    pub(crate) inverse: [[f32; 2]; 3],
    /// The most.
    pub(crate) slack: [f32; 3],
}

impl Bundle {
    /// Of the rays of `lanes`, all of one class.
    #[inline(always)]
    pub(crate) fn new<S: Simd, const G: usize>(s: S, group: &Group<S, G>, class: Class, lanes: u64) -> Self {
        let (none, all) = (s.f32s(f32::INFINITY), s.f32s(f32::NEG_INFINITY));
        let mut bundle = Self { plane_origin: [[0.0; 2]; 3], inverse: [[0.0; 2]; 3], slack: [0.0; 3] };
        for k in 0..3 {
            let [mut least_start, mut least_inverse] = [none; 2];
            let [mut most_start, mut most_inverse, mut slack] = [all; 3];
            let mut tame = s.mask(u32::MAX);
            for g in 0..G {
                let mask = s.mask((lanes >> (g * WIDTH)) as u32);
                let (start, inverse) = (group.plane_origin[k][g], group.inverse[k][g]);
                let sound = s.lt(s.abs(start), none)
                    & s.lt(s.abs(inverse), none)
                    & s.le(s.f32s(f32::MIN_POSITIVE), s.abs(inverse))
                    & s.lt(group.slack[k][g], none);
                tame = tame & (sound | !mask);
                least_start = s.smaller(s.select(mask, start, none), least_start);
                most_start = s.larger(s.select(mask, start, all), most_start);
                least_inverse = s.smaller(s.select(mask, inverse, none), least_inverse);
                most_inverse = s.larger(s.select(mask, inverse, all), most_inverse);
                slack = s.larger(s.select(mask, group.slack[k][g], all), slack);
            }
            let ends = [s.least(least_start), s.most(most_start)];
            bundle.plane_origin[k] = if class.descends[k] == 0 { [ends[1], ends[0]] } else { ends };
            bundle.inverse[k] = [s.least(least_inverse), s.most(most_inverse)];
            bundle.slack[k] = if s.all(tame) { s.most(slack) } else { f32::INFINITY };
        }
        bundle
    }

    /// Where the rays meet a plane's slab, scaled units: none before the first, none after the second. NaN says nothing.
    #[inline(always)]
    pub(crate) fn slab(&self, axis: usize, split: f32) -> (f32, f32) {
        let (start, [a, b], slack) = (self.plane_origin[axis], self.inverse[axis], self.slack[axis]);
        let (nearest, farthest) = (split - start[0], split - start[1]);
        (smaller(nearest * a, nearest * b) - slack, larger(farthest * a, farthest * b) + slack)
    }
}
