//! Up to 16·G prepared rays: each lane holds what `PreparedRay` and `Shear` hold of one ray. Read `prepared.rs` first.
//!
//! The operations are those of `prepared.rs` and `geometry/intersect.rs`, in the same order. So the slopes have the same bits, and the
//! proofs there hold for each lane.

use crate::geometry::{Aabb, Ray};
use crate::layout::Planes;
use crate::simd::{Simd, prefetch};
use crate::traverse::conditions::NO_TRIANGLE;
use crate::traverse::prepared::{LEAST, LEAST_SCALED, PARALLEL, QUARTER_SLACK};

/// The number of lanes of a vector.
pub(crate) const WIDTH: usize = 16;

/// One quantity of all rays of a group: G vectors.
pub(crate) type Lanes<V, const G: usize> = [V; G];

/// Prepared rays and their best hits so far.
pub(crate) struct Group<S: Simd, const G: usize> {
    pub(crate) origin: [Lanes<S::F, G>; 3],
    /// As `PreparedRay::plane_origin`: the origin in the tree's plane coordinates.
    pub(crate) plane_origin: [Lanes<S::F, G>; 3],
    /// As `PreparedRay::inverse`.
    pub(crate) inverse: [Lanes<S::F, G>; 3],
    /// As `PreparedRay::slack`.
    pub(crate) slack: [Lanes<S::F, G>; 3],
    /// As `Shear::slope`.
    pub(crate) slope: [Lanes<S::F, G>; 2],
    /// The direction's longest component.
    pub(crate) along: Lanes<S::F, G>,
    /// The ray's interval inside the scene's bounds, in scaled units; empty for rays that miss the bounds.
    pub(crate) enter: Lanes<S::F, G>,
    pub(crate) exit: Lanes<S::F, G>,
    /// As `PreparedRay::t_min`: the user's, cut to a finite number.
    pub(crate) t_min: Lanes<S::F, G>,
    /// As `PreparedRay::scale`.
    pub(crate) scale: Lanes<S::F, G>,
    /// The largest t that still matters, in the user's units: the best hit's, at first t_max.
    pub(crate) limit: Lanes<S::F, G>,
    /// The best hit's triangle; `u32::MAX` where there is no hit.
    pub(crate) triangle: Lanes<S::U, G>,
    pub(crate) u: Lanes<S::F, G>,
    pub(crate) v: Lanes<S::F, G>,
    /// The triangle that each ray leaves out; `u32::MAX`, which no triangle is, for none.
    pub(crate) except: Lanes<S::U, G>,
}

/// What decides the class of each ray; bit `i` of each mask is ray `i`.
#[derive(Clone, Copy)]
pub(crate) struct Classes {
    /// Rays that are valid and meet the bounds.
    pub(crate) traced: u64,
    /// For each axis, the rays whose direction is negative on it.
    pub(crate) negative: [u64; 3],
    /// Rays whose longest component is on axis 0, on axis 1.
    longest: [u64; 2],
}

/// A class of rays: what all rays of one walk have in common.
#[derive(Clone, Copy)]
pub(crate) struct Class {
    /// For each axis, 1 where the rays' direction is negative, so that the right child is the near one; else 0.
    pub(crate) descends: [u32; 3],
    /// As `Shear::axes`: the axes in the order in which the longest one is last.
    pub(crate) axes: [usize; 3],
}

impl Class {
    /// Whether the longest component is negative.
    #[inline(always)]
    pub(crate) fn goes_down(&self) -> bool {
        self.descends[self.axes[2]] != 0
    }
}

impl Classes {
    /// How many rays differ from most others in a sign or in the longest axis, summed over these: up to 32 where a tile of pixels lies across one
    /// boundary, about 100 where directions are any.
    #[inline(always)]
    pub(crate) fn mixed(&self) -> u32 {
        let all = self.traced.count_ones();
        let mut mixed = 0;
        for mask in [self.negative[0], self.negative[1], self.negative[2], self.longest[0], self.longest[1]] {
            let yes = (mask & self.traced).count_ones();
            mixed += yes.min(all - yes);
        }
        mixed
    }

    /// The class of ray `index`, and all of `among` that share it.
    #[inline(always)]
    pub(crate) fn of(&self, index: u32, among: u64) -> (Class, u64) {
        let mut lanes = among;
        let mut keep = |mask: u64| {
            let yes = mask >> index & 1 == 1;
            lanes &= if yes { mask } else { !mask };
            yes
        };
        let descends = [
            u32::from(keep(self.negative[0])),
            u32::from(keep(self.negative[1])),
            u32::from(keep(self.negative[2])),
        ];
        let z = match (keep(self.longest[0]), keep(self.longest[1])) {
            (true, _) => 0,
            (_, true) => 1,
            _ => 2,
        };
        (Class { descends, axes: [(z + 1) % 3, (z + 2) % 3, z] }, lanes)
    }
}

/// The invalid ray that takes the place of missing rays in the last group of a batch.
const NO_RAY: Ray = Ray { origin: [0.0; 3], direction: [0.0; 3], t_min: 0.0, t_max: 0.0 };

impl<S: Simd, const G: usize> Group<S, G> {
    /// A group without rays; [`Group::fill`] puts them in.
    #[inline(always)]
    pub(crate) fn new(s: S) -> Self {
        let zeros = [s.f32s(0.0); G];
        Self {
            origin: [zeros; 3],
            plane_origin: [zeros; 3],
            inverse: [zeros; 3],
            slack: [zeros; 3],
            slope: [zeros; 2],
            along: zeros,
            enter: zeros,
            exit: zeros,
            t_min: zeros,
            scale: zeros,
            limit: zeros,
            triangle: [s.u32s(u32::MAX); G],
            u: zeros,
            v: zeros,
            except: [s.u32s(NO_TRIANGLE); G],
        }
    }

    /// Prepares at most 16·G rays, which have no hit yet, and fills up with [`NO_RAY`]. It works in place, because a group takes 7 kB:
    /// moving it twice took 7 % of the time.
    #[inline(always)]
    pub(crate) fn fill(&mut self, s: S, rays: &[Ray], bounds: &Aabb, planes: &Planes) -> Classes {
        if rays.len() >= G * WIDTH {
            return self.prepare_all(s, &rays[..G * WIDTH], bounds, planes);
        }
        let mut filled = [[NO_RAY; WIDTH]; G];
        filled.as_flattened_mut()[..rays.len()].copy_from_slice(rays);
        self.prepare_all(s, filled.as_flattened(), bounds, planes)
    }

    /// Sets the triangle that each ray leaves out.
    #[inline(always)]
    pub(crate) fn leave_out(&mut self, s: S, except: Option<&[u32]>) {
        let Some(except) = except else { return };
        let mut lanes = [[NO_TRIANGLE; WIDTH]; G];
        lanes.as_flattened_mut()[..except.len()].copy_from_slice(except);
        for g in 0..G {
            self.except[g] = s.load_u32(&lanes[g]);
        }
    }

    /// Prepares exactly 16·G rays.
    #[inline(always)]
    fn prepare_all(&mut self, s: S, rays: &[Ray], bounds: &Aabb, planes: &Planes) -> Classes {
        // SAFETY: a ray is `repr(C)` and holds eight f32, so a slice of rays is one of as many records.
        let records: &[[f32; 8]] = unsafe { std::slice::from_raw_parts(rays.as_ptr().cast(), rays.len()) };
        let mut classes = Classes { traced: 0, negative: [0; 3], longest: [0; 2] };
        for g in 0..G {
            self.prepare(s, g, &records[g * WIDTH..], bounds, planes, &mut classes);
        }
        classes
    }

    /// Prepares the 16 rays of vector `g`: `PreparedRay::new` in lanes. `records` begins with them.
    #[inline(always)]
    fn prepare(
        &mut self,
        s: S,
        g: usize,
        records: &[[f32; 8]],
        bounds: &Aabb,
        planes: &Planes,
        classes: &mut Classes,
    ) {
        let [ox, oy, oz, t_min, dx, dy, dz, t_max] = s.columns(records);
        // Fetch the rays of the next group while this one is traced; a line of the cache holds two rays.
        let next = records.as_ptr().wrapping_add(G * WIDTH);
        (0..WIDTH).step_by(2).for_each(|ray| prefetch(next.wrapping_add(ray)));
        let (origin, direction) = ([ox, oy, oz], [dx, dy, dz]);
        let at = g * WIDTH;

        // Valid rays, as `Ray::is_valid`.
        let zero = s.f32s(0.0);
        let infinity = s.f32s(f32::INFINITY);
        let mut valid = s.le(t_min, t_max);
        for x in [ox, oy, oz, dx, dy, dz] {
            valid = valid & s.lt(s.abs(x), infinity);
        }
        let size = [s.abs(direction[0]), s.abs(direction[1]), s.abs(direction[2])];
        valid = valid & (s.lt(zero, size[0]) | s.lt(zero, size[1]) | s.lt(zero, size[2]));

        // The longest axis, as `Shear::new` breaks ties.
        let x_over_y = s.lt(size[1], size[0]);
        let is_x = x_over_y & s.lt(size[2], size[0]);
        let is_y = !x_over_y & s.lt(size[2], size[1]);
        let along = pick(s, [is_x, is_y], direction);
        self.slope[0][g] = pick(s, [is_x, is_y], [direction[1], direction[2], direction[0]]) / along;
        self.slope[1][g] = pick(s, [is_x, is_y], [direction[2], direction[0], direction[1]]) / along;
        self.along[g] = along;

        // Scale: the power of two at or below the longest component, and its reciprocal.
        let exponent = s.cast_u32(s.abs(along)) & s.u32s(0x7f80_0000);
        let least = s.u32s(f32::MIN_POSITIVE.to_bits());
        let subnormal = s.lt_u32(exponent, least);
        let exponent = s.select_u32(subnormal, least, exponent);
        let scale = s.cast_f32(exponent);
        let last = s.u32s(254 << 23);
        let unscale = s.cast_f32(last - exponent);
        let top = s.eq_u32(exponent, last);
        let unscale = s.select(top, s.f32s(2.0f32.powi(-127)), unscale);

        // The width of split planes.
        let mut reach = zero;
        for k in 0..3 {
            let (low, high) = (s.f32s(bounds.min[k]) - origin[k], s.f32s(bounds.max[k]) - origin[k]);
            reach = s.larger(s.abs(high), s.larger(s.abs(low), reach));
        }
        let least = s.f32s(LEAST) * s.larger(scale * s.f32s(LEAST_SCALED), s.f32s(1.0));
        let reach = s.f32s(4.0) * reach + s.select(subnormal, infinity, least);

        // For each axis: the reciprocal, the width of slabs, and the interval inside the scene's bounds.
        let (t_min, t_max) = (s.larger(t_min, s.f32s(f32::MIN)), s.smaller(t_max, s.f32s(f32::MAX)));
        let (mut enter, mut exit) = (t_min * scale, t_max * scale);
        for k in 0..3 {
            let d = direction[k] * unscale;
            let sign = s.cast_u32(d) & s.u32s(1 << 31);
            let small = s.cast_f32(sign | s.u32s(PARALLEL.to_bits()));
            let d = s.select(s.lt(s.abs(d), s.f32s(PARALLEL)), small, d);
            let inverse = s.f32s(1.0) / d;
            let plane_inverse = inverse * s.f32s(planes.unscale[k]);
            let width = reach * s.f32s(planes.scale[k]) * s.f32s(QUARTER_SLACK) + s.f32s(planes.cell);
            let width = width * s.abs(plane_inverse);
            let low = (s.f32s(bounds.min[k]) - origin[k]) * inverse;
            let high = (s.f32s(bounds.max[k]) - origin[k]) * inverse;
            let negative = s.lt(d, zero);
            let (first, last) = (s.select(negative, high, low), s.select(negative, low, high));
            enter = s.larger(first - width, enter);
            exit = s.smaller(last + width, exit);
            classes.negative[k] |= u64::from(s.bits(negative)) << at;
            let start = (origin[k] - s.f32s(planes.low[k])) * s.f32s(planes.scale[k]) + s.f32s(planes.shift);
            self.origin[k][g] = origin[k];
            self.plane_origin[k][g] = start;
            self.inverse[k][g] = plane_inverse;
            self.slack[k][g] = width;
        }
        // Note each ray's class, and begin without a hit.
        valid = valid & s.le(enter, exit);
        classes.traced |= u64::from(s.bits(valid)) << at;
        classes.longest[0] |= u64::from(s.bits(is_x)) << at;
        classes.longest[1] |= u64::from(s.bits(is_y)) << at;
        (self.enter[g], self.exit[g]) = (enter, exit);
        (self.t_min[g], self.limit[g], self.scale[g]) = (t_min, t_max, scale);
        self.triangle[g] = s.u32s(u32::MAX);
    }

    /// Whether all rays of `lanes` start at the point `eye`, to the last bit.
    #[inline(always)]
    pub(crate) fn all_start_at(&self, s: S, eye: [f32; 3], lanes: u64) -> bool {
        let mut same = lanes;
        for g in 0..G {
            let mut here = s.mask(u32::MAX);
            for k in 0..3 {
                here = here & s.eq_u32(s.cast_u32(self.origin[k][g]), s.u32s(eye[k].to_bits()));
            }
            same &= u64::from(s.bits(here)) << (g * WIDTH) | !(0xffff << (g * WIDTH));
        }
        same == lanes
    }

    /// A copy of vector `g` as a group of its own: a packet.
    #[inline(always)]
    pub(crate) fn part(&self, g: usize) -> Group<S, 1> {
        Group {
            origin: [[self.origin[0][g]], [self.origin[1][g]], [self.origin[2][g]]],
            plane_origin: [[self.plane_origin[0][g]], [self.plane_origin[1][g]], [self.plane_origin[2][g]]],
            inverse: [[self.inverse[0][g]], [self.inverse[1][g]], [self.inverse[2][g]]],
            slack: [[self.slack[0][g]], [self.slack[1][g]], [self.slack[2][g]]],
            slope: [[self.slope[0][g]], [self.slope[1][g]]],
            along: [self.along[g]],
            enter: [self.enter[g]],
            exit: [self.exit[g]],
            t_min: [self.t_min[g]],
            scale: [self.scale[g]],
            limit: [self.limit[g]],
            triangle: [self.triangle[g]],
            u: [self.u[g]],
            v: [self.v[g]],
            except: [self.except[g]],
        }
    }

    /// Takes over the hits of `part`, a packet that [`Group::part`] made of vector `g`.
    #[inline(always)]
    pub(crate) fn take(&mut self, g: usize, part: &Group<S, 1>) {
        self.limit[g] = part.limit[0];
        self.triangle[g] = part.triangle[0];
        (self.u[g], self.v[g]) = (part.u[0], part.v[0]);
    }
}

/// In each lane, the one of three values that belongs to the longest axis.
#[inline(always)]
fn pick<S: Simd>(s: S, [is_x, is_y]: [S::M; 2], [x, y, z]: [S::F; 3]) -> S::F {
    s.select(is_x, x, s.select(is_y, y, z))
}
