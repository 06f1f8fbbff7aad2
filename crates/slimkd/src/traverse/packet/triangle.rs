//! One triangle against 16 rays: the test of `geometry/intersect.rs`, a lane each, operation by operation.

use super::group::{Class, Group};
use crate::simd::Simd;
use crate::traverse::counters::count;

/// How much farther than the limit, relative to it; derived at [`behind`].
const BEHIND: f32 = 1.0 / (1 << 20) as f32;

/// Tests a triangle against the `active` rays of vector `g` and keeps what they hit; says which did with `ANY`, where a
/// ray that hits is done.
///
/// Corners have their components in the order of the rays' frame; with `COMMON` they are given from the rays' origin.
#[inline(always)]
pub(super) fn test<S: Simd, const G: usize, const COMMON: bool, const ANY: bool>(
    s: S,
    group: &mut Group<S, G>,
    g: usize,
    active: S::M,
    class: Class,
    corners: &[[f32; 3]; 3],
    id: u32,
) -> S::M {
    let zero = s.f32s(0.0);
    let slope = [group.slope[0][g], group.slope[1][g]];
    let (mut x, mut y, mut z) = ([zero; 3], [zero; 3], [zero; 3]);
    for i in 0..3 {
        let [cx, cy, cz] = corners[i];
        let from = if COMMON {
            [s.f32s(cx), s.f32s(cy), s.f32s(cz)]
        } else {
            [
                s.f32s(cx) - group.origin[class.axes[0]][g],
                s.f32s(cy) - group.origin[class.axes[1]][g],
                s.f32s(cz) - group.origin[class.axes[2]][g],
            ]
        };
        z[i] = from[2];
        x[i] = from[0] - slope[0] * from[2];
        y[i] = from[1] - slope[1] * from[2];
    }
    let u_f32 = x[2] * y[1] - y[2] * x[1];
    let v_f32 = x[0] * y[2] - y[0] * x[2];
    let w_f32 = x[1] * y[0] - y[1] * x[0];
    // A NaN is passed over or makes `lt` false: what is then seen of the other two rejects as the scalar test does.
    let lowest = s.smaller(u_f32, s.smaller(v_f32, w_f32));
    let highest = s.larger(u_f32, s.larger(v_f32, w_f32));
    let missed = s.lt(lowest, zero) & s.lt(zero, highest);
    let mut candidates = active & !missed;
    if !s.any(candidates) {
        return candidates;
    }
    candidates = candidates & !behind(s, group, g, class.goes_down(), z);
    if !s.any(candidates) {
        return candidates;
    }

    count(|c| c.decided += u64::from(s.bits(candidates).count_ones()));

    // As `Sheared::finish`.
    let [ax, bx, cx] = [s.widen(x[0]), s.widen(x[1]), s.widen(x[2])];
    let [ay, by, cy] = [s.widen(y[0]), s.widen(y[1]), s.widen(y[2])];
    let u = cx * by - cy * bx;
    let v = ax * cy - ay * cx;
    let w = bx * ay - by * ax;
    let none = s.f64s(0.0);
    // Signs are already certain where f32 saw three of the same, none zero. `lowest` passes over a NaN, the sum does not.
    let sum = u_f32 + v_f32 + w_f32;
    let certain = (s.lt(zero, lowest) | s.lt(highest, zero)) & s.eq(sum, sum);
    let mut hit = candidates;
    if s.any(candidates & !certain) {
        let negative = s.lt_f64(u, none) | s.lt_f64(v, none) | s.lt_f64(w, none);
        let positive = s.lt_f64(none, u) | s.lt_f64(none, v) | s.lt_f64(none, w);
        hit = hit & !(negative & positive);
    }
    let det = u + v + w;
    let [az, bz, cz] = [s.widen(z[0]), s.widen(z[1]), s.widen(z[2])];
    let depth = s.widen(group.depth[g]);
    let per_depth = s.f64s(1.0) / (det * depth);
    let t = s.narrow((u * az + v * bz + w * cz) * per_depth);
    let limit = group.limit[g];
    let id = s.u32s(id);
    hit = hit & !s.eq_f64(det, none) & s.le(group.t_min[g], t) & !s.eq_u32(id, group.except[g]);
    if ANY {
        let hit = hit & s.le(t, limit);
        group.limit[g] = s.select(hit, s.f32s(f32::NEG_INFINITY), limit);
        group.triangle[g] = s.select_u32(hit, id, group.triangle[g]);
        return hit;
    }
    // A NaN is neither less nor equal.
    let hit = hit & (s.lt(t, limit) | (s.eq(t, limit) & s.lt_u32(id, group.triangle[g])));
    if s.any(hit) {
        group.limit[g] = s.select(hit, t, limit);
        group.triangle[g] = s.select_u32(hit, id, group.triangle[g]);
        let per_det = depth * per_depth;
        group.u[g] = s.select(hit, s.narrow(v * per_det), group.u[g]);
        group.v[g] = s.select(hit, s.narrow(w * per_det), group.v[g]);
    }
    hit
}

/// Rays that can only hit beyond their limit.
///
/// A hit's t is a convex combination of the corners' z over the direction's, f64 and so off by less than 2⁻⁴⁸, then rounded
/// once to f32 (2⁻²⁴): it lies beyond the limit when the nearest z lies beyond limit · depth by more than their 2⁻²². The
/// smallest normal number stands in where t is subnormal, so that its rounding is not relative, and where the product
/// underflows. NaN rejects nothing.
#[inline(always)]
fn behind<S: Simd, const G: usize>(
    s: S,
    group: &Group<S, G>,
    g: usize,
    descends: bool,
    [a, b, c]: [S::F; 3],
) -> S::M {
    let least = s.f32s(f32::MIN_POSITIVE);
    let end = (group.limit[g] + least) * s.abs(group.depth[g]);
    let end = end + s.abs(end) * s.f32s(BEHIND) + least;
    if descends {
        s.lt(s.larger(a, s.larger(b, c)), s.f32s(0.0) - end)
    } else {
        s.lt(end, s.smaller(a, s.smaller(b, c)))
    }
}
