//! 16 pairs of a ray and a triangle.

use super::answers::Answers;
use super::slots::Slots;
use crate::geometry::Hit;
use crate::layout::LaneNodes;
use crate::simd::Simd;
use crate::traverse::{RayConditions, counters};

/// Tests the first `count` pairs.
///
/// # Safety
/// The tree must fit lanes; all pairs, behind the first `count` too, must name triangles of its mesh.
#[allow(clippy::too_many_arguments)]
#[inline(always)]
pub(super) unsafe fn test<S: Simd, N: LaneNodes, A: Answers>(
    s: S,
    nodes: N,
    conditions: &RayConditions<'_>,
    slots: &mut Slots,
    slot: S::U,
    triangle: S::U,
    count: usize,
) {
    let longest = s.pick(&slots.longest.0, slot);
    let frame = Frame {
        along_x: s.eq(longest, s.f32s(0.0)),
        along_y: s.eq(longest, s.f32s(1.0)),
        x: s.pick(&slots.start[0].0, slot),
        y: s.pick(&slots.start[1].0, slot),
        z: s.pick(&slots.start[2].0, slot),
        slope_x: s.pick(&slots.slope[0].0, slot),
        slope_y: s.pick(&slots.slope[1].0, slot),
    };
    // SAFETY: the caller says so.
    let [a, b, c] = unsafe { nodes.lane_corners(s, triangle) };
    let (a, b, c) = (frame.shear(s, a), frame.shear(s, b), frame.shear(s, c));
    let zero = s.f32s(0.0);
    let u = c[0] * b[1] - c[1] * b[0];
    let v = a[0] * c[1] - a[1] * c[0];
    let w = b[0] * a[1] - b[1] * a[0];
    // A NaN is passed over or makes `lt` false: what is then seen of the other two rejects as the scalar test does.
    let lowest = s.smaller(u, s.smaller(v, w));
    let highest = s.larger(u, s.larger(v, w));
    let missed = s.lt(lowest, zero) & s.lt(zero, highest);
    let left = s.mask((1 << count) - 1) & !missed;
    counters::count(|c| {
        let tested = count as u64;
        (c.triangles, c.ray_triangles) = (c.triangles + tested, c.ray_triangles + tested);
        c.triangle_lanes += 16;
        c.decided += u64::from(s.bits(left).count_ones());
    });
    if !s.any(left) {
        return;
    }

    let (ax, ay, az) = (s.widen(a[0]), s.widen(a[1]), s.widen(a[2]));
    let (bx, by, bz) = (s.widen(b[0]), s.widen(b[1]), s.widen(b[2]));
    let (cx, cy, cz) = (s.widen(c[0]), s.widen(c[1]), s.widen(c[2]));
    let zero = s.f64s(0.0);
    let u = cx * by - cy * bx;
    let v = ax * cy - ay * cx;
    let w = bx * ay - by * ax;
    let below = s.lt_f64(u, zero) | s.lt_f64(v, zero) | s.lt_f64(w, zero);
    let above = s.lt_f64(zero, u) | s.lt_f64(zero, v) | s.lt_f64(zero, w);
    let det = u + v + w;
    let depth = s.widen(s.pick(&slots.depth.0, slot));
    let per_depth = s.f64s(1.0) / (det * depth);
    let t = s.narrow((u * az + v * bz + w * cz) * per_depth);
    let (t_min, best) = (s.pick(&slots.t_min.0, slot), s.pick(&slots.best_t.0, slot));
    let hit = left & !(below & above) & !s.eq_f64(det, zero) & s.le(t_min, t) & s.le(t, best);
    let mut hits = s.bits(hit);
    if hits == 0 {
        return;
    }

    let (mut ts, mut us, mut vs) = ([0.0; 16], [0.0; 16], [0.0; 16]);
    let (mut slot_of, mut triangles) = ([0; 16], [0; 16]);
    s.store(t, &mut ts);
    if !A::ANY || conditions.filter.is_some() {
        let per_det = depth * per_depth;
        s.store(s.narrow(v * per_det), &mut us);
        s.store(s.narrow(w * per_det), &mut vs);
    }
    s.store_u32(slot, &mut slot_of);
    s.store_u32(triangle, &mut triangles);
    while hits != 0 {
        let lane = hits.trailing_zeros() as usize & 15;
        hits &= hits - 1;
        let hit = Hit { t: ts[lane], u: us[lane], v: vs[lane], triangle: triangles[lane] };
        let slot = slot_of[lane] as usize;
        if conditions.accept(slots.ray(slot), &hit) {
            slots.offer::<A>(slot, hit);
        }
    }
}

/// The frames of 16 rays.
struct Frame<S: Simd> {
    along_x: S::M,
    along_y: S::M,
    x: S::F,
    y: S::F,
    z: S::F,
    slope_x: S::F,
    slope_y: S::F,
}

impl<S: Simd> Frame<S> {
    /// As `Shear::apply`, for a corner.
    #[inline(always)]
    fn shear(&self, s: S, [x, y, z]: [S::F; 3]) -> [S::F; 3] {
        let deep = self.pick(s, x, y, z) - self.z;
        [
            (self.pick(s, y, z, x) - self.x) - self.slope_x * deep,
            (self.pick(s, z, x, y) - self.y) - self.slope_y * deep,
            deep,
        ]
    }

    /// By the ray's longest axis.
    #[inline(always)]
    fn pick(&self, s: S, x: S::F, y: S::F, z: S::F) -> S::F {
        s.select(self.along_x, x, s.select(self.along_y, y, z))
    }
}
