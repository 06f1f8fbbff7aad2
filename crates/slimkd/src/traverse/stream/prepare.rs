//! Rays made ready, 16 at a time: what `PreparedRay::new` does, by lanes. Read `prepared.rs` first: it has the reasons.
//!
//! The same operations in the same order, so the same bits; where a lane's ray is invalid they give anything.

use super::answers::Answers;
use crate::geometry::{Aabb, Ray};
use crate::layout::Planes;
use crate::simd::{Simd, prefetch};
use crate::traverse::prepared::{LEAST, LEAST_SCALED, PARALLEL, PreparedRay, QUARTER_SLACK};
use std::mem::offset_of;

/// A value a ray.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Lanes<T>(pub(super) [T; 16]);

const NONE: Lanes<f32> = Lanes([0.0; 16]);

/// Rays that wait for a slot. Fields as in `Slots`.
pub(crate) struct Prepared {
    /// Position in the batch of the ray in lane 0.
    pub(super) first: u32,
    /// Lanes with a ray that still waits.
    waiting: u32,
    pub(super) enter: Lanes<f32>,
    pub(super) exit: Lanes<f32>,
    pub(super) limit: Lanes<f32>,
    pub(super) margin: Lanes<f32>,
    pub(super) plane_origin: [Lanes<f32>; 3],
    pub(super) inverse: [Lanes<f32>; 3],
    pub(super) slack: [Lanes<f32>; 3],
    pub(super) frame_origin: [Lanes<f32>; 3],
    pub(super) slope: [Lanes<f32>; 2],
    pub(super) along: Lanes<f32>,
    pub(super) longest: Lanes<f32>,
    pub(super) t_min: Lanes<f32>,
    pub(super) t_max: Lanes<f32>,
    pub(super) scale: Lanes<f32>,
}

// Two rows of four f32 a ray: origin and start of the range, then direction and end of the range.
const _: () =
    assert!(size_of::<Ray>() == 32 && offset_of!(Ray, origin) == 0 && offset_of!(Ray, direction) == 16);
const _: () = assert!(offset_of!(Ray, t_min) == 12 && offset_of!(Ray, t_max) == 28);

impl Prepared {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self {
            first: 0,
            waiting: 0,
            enter: NONE,
            exit: NONE,
            limit: NONE,
            margin: NONE,
            plane_origin: [NONE; 3],
            inverse: [NONE; 3],
            slack: [NONE; 3],
            frame_origin: [NONE; 3],
            slope: [NONE; 2],
            along: NONE,
            longest: NONE,
            t_min: NONE,
            t_max: NONE,
            scale: NONE,
        }
    }

    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.waiting == 0
    }

    /// Takes waiting rays for the lanes in `empty`: which of them get one, and the lane that each of those comes from.
    #[inline(always)]
    pub(super) fn take(&mut self, mut empty: u32) -> (u32, [u32; 16]) {
        let (mut filled, mut from) = (0, [0; 16]);
        while empty != 0 && self.waiting != 0 {
            from[empty.trailing_zeros() as usize & 15] = self.waiting.trailing_zeros();
            filled |= empty & empty.wrapping_neg();
            empty &= empty - 1;
            self.waiting &= self.waiting - 1;
        }
        (filled, from)
    }

    /// Writes one waiting ray to `ray`, if any waits; returns its position in the batch.
    #[inline(always)]
    pub(crate) fn take_one(&mut self, ray: &mut PreparedRay) -> Option<usize> {
        if self.waiting == 0 {
            return None;
        }
        let lane = self.waiting.trailing_zeros() as usize & 15;
        self.waiting &= self.waiting - 1;
        macro_rules! take {
            ($($to:ident)*) => {
                $(ray.$to = self.$to.0[lane];)*
            };
        }
        take!(enter exit t_min t_max scale);
        // Where x and y stand, once z is known.
        let longest = self.longest.0[lane];
        ray.shear.axes = if longest == 0.0 {
            [1, 2, 0]
        } else if longest == 1.0 {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        };
        ray.shear.along = self.along.0[lane].into();
        ray.shear.slope = [self.slope[0].0[lane], self.slope[1].0[lane]];
        for k in 0..3 {
            ray.shear.origin[ray.shear.axes[k]] = self.frame_origin[k].0[lane];
            ray.plane_origin[k] = self.plane_origin[k].0[lane];
            ray.inverse[k] = self.inverse[k].0[lane];
            ray.slack[k] = self.slack[k].0[lane];
            // An inverse is never 0, and has the direction's sign.
            ray.descends[k] = if ray.inverse[k] < 0.0 { u32::MAX } else { 0 };
        }
        Some(self.first as usize + lane)
    }

    /// Prepares the rays from `first` on, at most 16, and answers those that are invalid or pass the bounds by.
    #[inline(always)]
    pub(crate) fn load<S: Simd>(
        &mut self,
        s: S,
        rays: &[Ray],
        first: usize,
        bounds: &Aabb,
        planes: &Planes,
        answers: &mut impl Answers,
    ) {
        let rest = &rays[first..];
        let count = rest.len().min(16);
        let mut numbers = [0; 16];
        for lane in 0..16 {
            // Lanes behind the end repeat the last ray.
            numbers[lane] = lane.min(count - 1) as u32;
        }
        let numbers = s.load_u32(&numbers);
        // The next 16, two rays a line: they arrive while these are traced.
        let next = rest.as_ptr().wrapping_add(16);
        (0..16).step_by(2).for_each(|ray| prefetch(next.wrapping_add(ray)));
        // SAFETY: the numbers are below the length of `rest`; a ray is two rows of 16 bytes, see above.
        let ([ox, oy, oz, t_min], [dx, dy, dz, t_max]) = unsafe {
            let base = rest.as_ptr().cast::<u8>();
            (s.gather_rows::<32>(base, numbers), s.gather_rows::<32>(base.add(16), numbers))
        };
        let o = [s.cast_f32(ox), s.cast_f32(oy), s.cast_f32(oz)];
        let d = [s.cast_f32(dx), s.cast_f32(dy), s.cast_f32(dz)];
        let (t_min, t_max) = (s.cast_f32(t_min), s.cast_f32(t_max));

        // Valid rays, as `Ray::is_valid` says.
        let (infinite, zero) = (s.f32s(f32::INFINITY), s.f32s(0.0));
        let (x, y, z) = (s.abs(d[0]), s.abs(d[1]), s.abs(d[2]));
        let finite = s.lt(x, infinite) & s.lt(y, infinite) & s.lt(z, infinite);
        let finite =
            finite & s.lt(s.abs(o[0]), infinite) & s.lt(s.abs(o[1]), infinite) & s.lt(s.abs(o[2]), infinite);
        let moves = s.lt(zero, x) | s.lt(zero, y) | s.lt(zero, z);
        let valid = s.mask((1 << count) - 1) & finite & moves & s.le(t_min, t_max);

        // The longest axis, as `Shear::new` chooses it.
        let along_x = s.lt(y, x) & s.lt(z, x);
        let along_y = !s.lt(y, x) & s.lt(z, y);
        let along = third(s, along_x, along_y, d[0], d[1], d[2]);
        let slope_x = third(s, along_x, along_y, d[1], d[2], d[0]) / along;
        let slope_y = third(s, along_x, along_y, d[2], d[0], d[1]) / along;
        let start_x = third(s, along_x, along_y, o[1], o[2], o[0]);
        let start_y = third(s, along_x, along_y, o[2], o[0], o[1]);
        let start_z = third(s, along_x, along_y, o[0], o[1], o[2]);
        let longest = third(s, along_x, along_y, zero, s.f32s(1.0), s.f32s(2.0));

        // A power of two and its exact reciprocal, as in `PreparedRay::new`.
        let smallest = s.u32s(f32::MIN_POSITIVE.to_bits());
        let power = s.cast_u32(s.abs(along)) & s.u32s(0x7f80_0000);
        let subnormal = s.lt_u32(power, smallest);
        let power = s.select_u32(subnormal, smallest, power);
        let scale = s.cast_f32(power);
        let huge = s.le(s.f32s(2.0f32.powi(127)), scale);
        let unscale = s.select(huge, s.f32s(2.0f32.powi(-127)), s.cast_f32(s.u32s(254 << 23) - power));

        // How far the bounds reach from the origin: the width of split planes follows from that.
        let mut reach = zero;
        for k in 0..3 {
            let (low, high) = (s.f32s(bounds.min[k]) - o[k], s.f32s(bounds.max[k]) - o[k]);
            reach = s.larger(s.abs(high), s.larger(s.abs(low), reach));
        }
        let least = s.f32s(LEAST) * s.larger(scale * s.f32s(LEAST_SCALED), s.f32s(1.0));
        let reach = s.f32s(4.0) * reach + s.select(subnormal, infinite, least);
        // The interval inside the bounds, and each axis' part of the walk.
        let (t_min, t_max) = (s.larger(t_min, s.f32s(f32::MIN)), s.smaller(t_max, s.f32s(f32::MAX)));
        let (mut enter, mut exit, mut widest) = (t_min * scale, t_max * scale, zero);
        let limit = exit;
        for k in 0..3 {
            // A component near 0 is replaced: no infinity, and no 0 · ∞.
            let component = d[k] * unscale;
            let sign = s.cast_u32(d[k]) & s.u32s(0x8000_0000);
            let parallel = s.cast_f32(s.u32s(PARALLEL.to_bits()) | sign);
            let component = s.select(s.lt(s.abs(component), s.f32s(PARALLEL)), parallel, component);
            let inverse = s.f32s(1.0) / component;
            let plane_inverse = inverse * s.f32s(planes.unscale[k]);
            let width = reach * s.f32s(planes.scale[k]) * s.f32s(QUARTER_SLACK) + s.f32s(planes.cell);
            let width = width * s.abs(plane_inverse);
            let low = (s.f32s(bounds.min[k]) - o[k]) * inverse;
            let high = (s.f32s(bounds.max[k]) - o[k]) * inverse;
            let down = s.lt(component, zero);
            let (near, far) = (s.select(down, high, low), s.select(down, low, high));
            enter = s.larger(near - width, enter);
            exit = s.smaller(far + width, exit);
            widest = s.larger(width, widest);
            let origin = (o[k] - s.f32s(planes.low[k])) * s.f32s(planes.scale[k]) + s.f32s(planes.shift);
            s.store(origin, &mut self.plane_origin[k].0);
            s.store(plane_inverse, &mut self.inverse[k].0);
            s.store(width, &mut self.slack[k].0);
        }
        let enters = valid & s.le(enter, exit);
        s.store(enter, &mut self.enter.0);
        s.store(exit, &mut self.exit.0);
        s.store(limit, &mut self.limit.0);
        s.store(s.f32s(MARGIN) * widest, &mut self.margin.0);
        s.store(start_x, &mut self.frame_origin[0].0);
        s.store(start_y, &mut self.frame_origin[1].0);
        s.store(start_z, &mut self.frame_origin[2].0);
        s.store(slope_x, &mut self.slope[0].0);
        s.store(slope_y, &mut self.slope[1].0);
        s.store(along, &mut self.along.0);
        s.store(longest, &mut self.longest.0);
        s.store(t_min, &mut self.t_min.0);
        s.store(t_max, &mut self.t_max.0);
        s.store(scale, &mut self.scale.0);
        // Those that enter the bounds wait for a slot; the others have missed.
        self.first = first as u32;
        self.waiting = s.bits(enters);
        let mut misses = s.bits(!enters) & ((1 << count) - 1);
        while misses != 0 {
            answers.put(first + misses.trailing_zeros() as usize, None);
            misses &= misses - 1;
        }
    }
}

/// Widest slacks that an interval of a subtree and the interval behind it may overlap by: two, and what rounding adds.
/// Where a plane cannot be told, both children have their parent's whole interval; such a ray's widest slack is infinite.
const MARGIN: f32 = 3.0;

/// By the longest axis.
#[inline(always)]
fn third<S: Simd>(s: S, along_x: S::M, along_y: S::M, x: S::F, y: S::F, z: S::F) -> S::F {
    s.select(along_x, x, s.select(along_y, y, z))
}
