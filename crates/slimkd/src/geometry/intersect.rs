//! The ray-triangle test: watertight, two-sided, and the same to the last bit wherever it runs.
//!
//! Source: Woop, Benthin & Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013.
//!
//! Deviations
//! 1. The f32 edge functions only *reject*, and only when two of them have strictly opposite signs. Without fused
//!    multiply-add, rounding is monotonic, so the sign of `fl(ab) − fl(cd)` is right whenever it is not zero.
//! 2. Whatever passes is decided again in f64, where the products of two f32 are exact: the sheared triangle is
//!    tested exactly, edges and vertices included, and t, u, v come from weights with an error of 2⁻⁵², so that a
//!    grazing triangle's hit point lies on the triangle. The kd-tree's proof that no hit is lost needs that
//!    (`traverse/prepared.rs`).
//! 3. No back-face culling, hence no winding swap.
//!
//! A kernel may reject in any conservative way; [`Sheared::finish`] alone decides, so all kernels agree.

/// The frame in which a ray runs along z: the part of a prepared ray that the triangle test needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    pub(crate) origin: [f32; 3],
    /// World axes that play x, y, z; z is where the direction is longest.
    pub(crate) axes: [usize; 3],
    /// Direction's x/z and y/z.
    pub(crate) slope: [f32; 2],
    /// The direction's z component, user units.
    pub(crate) along: f64,
}

/// A triangle in the ray's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheared {
    pub(super) x: [f32; 3],
    pub(super) y: [f32; 3],
    pub(super) z: [f32; 3],
}

/// What one ray-triangle test found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Intersection {
    pub(crate) t: f32,
    pub(crate) u: f32,
    pub(crate) v: f32,
}

impl Shear {
    /// The direction must be finite and not zero. It is borrowed, since a copy that is then indexed keeps the processor waiting for it.
    #[inline]
    pub(crate) fn new(origin: [f32; 3], direction: &[f32; 3]) -> Self {
        let [dx, dy, dz] = direction.map(f32::abs);
        let z = if dx > dy {
            if dx > dz { 0 } else { 2 }
        } else if dy > dz {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let slope = [direction[x] / direction[z], direction[y] / direction[z]];
        Self { origin, axes: [x, y, z], slope, along: f64::from(direction[z]) }
    }

    /// The whole test for one triangle. `Z` must be `axes[2]`: as a constant it turns permuted loads into plain ones.
    #[inline(always)]
    pub(crate) fn intersect<const Z: usize>(&self, corners: &[[f32; 3]; 3]) -> Option<Intersection> {
        debug_assert_eq!(Z, self.axes[2]);
        let sheared = self.apply::<Z>(corners);
        if sheared.certainly_missed() { None } else { sheared.finish(self.along) }
    }

    /// [`Shear::intersect`] with the three corners side by side in a vector. The answer is the same to the last bit; single rays are
    /// 4 to 7 % faster.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(crate) fn intersect_by_lanes<const Z: usize>(&self, corners: &[[f32; 3]; 3]) -> Option<Intersection> {
        use std::arch::x86_64::*;
        debug_assert_eq!(Z, self.axes[2]);
        let [a, b, c] = corners;
        // SAFETY: SSE2 is part of x86-64.
        unsafe {
            let from_origin =
                |k: usize| _mm_sub_ps(_mm_set_ps(0.0, c[k], b[k], a[k]), _mm_set1_ps(self.origin[k]));
            let z = from_origin(Z);
            let x = _mm_sub_ps(from_origin((Z + 1) % 3), _mm_mul_ps(_mm_set1_ps(self.slope[0]), z));
            let y = _mm_sub_ps(from_origin((Z + 2) % 3), _mm_mul_ps(_mm_set1_ps(self.slope[1]), z));
            // Each corner with the next one: w, u, v. The fourth lane is xy − yx, 0 or NaN, and has no sign.
            const NEXT: i32 = 0b11_00_10_01;
            let (next_x, next_y) = (_mm_shuffle_ps::<NEXT>(x, x), _mm_shuffle_ps::<NEXT>(y, y));
            let edges = _mm_sub_ps(_mm_mul_ps(next_x, y), _mm_mul_ps(next_y, x));
            let zero = _mm_setzero_ps();
            let below = _mm_movemask_ps(_mm_cmplt_ps(edges, zero));
            let above = _mm_movemask_ps(_mm_cmplt_ps(zero, edges));
            if below != 0 && above != 0 {
                return None;
            }
            let lanes = |v| {
                let mut to = [0.0; 4];
                _mm_storeu_ps(to.as_mut_ptr(), v);
                [to[0], to[1], to[2]]
            };
            Sheared { x: lanes(x), y: lanes(y), z: lanes(z) }.finish(self.along)
        }
    }

    /// [`Shear::intersect`]: this processor has no faster way here.
    #[cfg(not(target_arch = "x86_64"))]
    #[inline(always)]
    pub(crate) fn intersect_by_lanes<const Z: usize>(&self, corners: &[[f32; 3]; 3]) -> Option<Intersection> {
        self.intersect::<Z>(corners)
    }

    /// `false` only where the ray certainly misses the triangle. Where it may hit, [`Shear::decide`] tells.
    #[inline(always)]
    pub(crate) fn may_hit(&self, corners: &[[f32; 3]; 3]) -> bool {
        !self.sheared(corners).certainly_missed()
    }

    /// The test of a triangle that may be hit.
    #[inline(always)]
    pub(crate) fn decide(&self, corners: &[[f32; 3]; 3]) -> Option<Intersection> {
        self.sheared(corners).finish(self.along)
    }

    /// [`Shear::apply`] where the longest axis is not a constant.
    #[inline(always)]
    pub(super) fn sheared(&self, corners: &[[f32; 3]; 3]) -> Sheared {
        match self.axes[2] {
            0 => self.apply::<0>(corners),
            1 => self.apply::<1>(corners),
            _ => self.apply::<2>(corners),
        }
    }

    #[inline(always)]
    fn apply<const Z: usize>(&self, corners: &[[f32; 3]; 3]) -> Sheared {
        let (kx, ky) = ((Z + 1) % 3, (Z + 2) % 3);
        let mut out = Sheared { x: [0.0; 3], y: [0.0; 3], z: [0.0; 3] };
        for (i, corner) in corners.iter().enumerate() {
            let z = corner[Z] - self.origin[Z];
            out.x[i] = (corner[kx] - self.origin[kx]) - self.slope[0] * z;
            out.y[i] = (corner[ky] - self.origin[ky]) - self.slope[1] * z;
            out.z[i] = z;
        }
        out
    }
}

impl Sheared {
    /// True only when the ray passes beside the triangle; false when it hits or f32 cannot tell.
    #[inline(always)]
    fn certainly_missed(&self) -> bool {
        let ([ax, bx, cx], [ay, by, cy]) = (self.x, self.y);
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        // Non-short-circuit: six comparisons cost less than their mispredicted branches.
        ((u < 0.0) | (v < 0.0) | (w < 0.0)) & ((u > 0.0) | (v > 0.0) | (w > 0.0))
    }

    /// Decides in f64 and finds t, u, v.
    #[inline(always)]
    pub(crate) fn finish(&self, along: f64) -> Option<Intersection> {
        let ([ax, bx, cx], [ay, by, cy]) = (self.x.map(f64::from), self.y.map(f64::from));
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None; // edge-on: its neighbours own the outline
        }
        let [az, bz, cz] = self.z.map(f64::from);
        // One division: three cost packets and streams a sixth of their f64 work.
        let per_along = 1.0 / (det * along);
        let t = ((u * az + v * bz + w * cz) * per_along) as f32;
        let per_det = along * per_along;
        (!t.is_nan()).then_some(Intersection { t, u: (v * per_det) as f32, v: (w * per_det) as f32 })
    }
}

/// True for a triangle that can never be hit: a corner that is not finite, or exactly collinear corners. A merely
/// tiny triangle is not degenerate. Exact, by Shewchuk's adaptive predicates on the three coordinate planes.
pub(crate) fn is_degenerate(corners: &[[f32; 3]; 3]) -> bool {
    if !corners.iter().flatten().all(|x| x.is_finite()) {
        return true;
    }
    let [a, b, c] = corners.map(|p| p.map(f64::from));
    // Exact differences of f32 need more than 53 bits only when exponents are far apart; the filter below is safe
    // all the same, because a difference of two f64 has the right sign and a relative error of 2⁻⁵³.
    (0..3).all(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let left = (b[i] - a[i]) * (c[j] - a[j]);
        let right = (b[j] - a[j]) * (c[i] - a[i]);
        if (left - right).abs() > 1e-14 * (left.abs() + right.abs()) {
            return false;
        }
        let point = |p: [f64; 3]| robust::Coord { x: p[i], y: p[j] };
        robust::orient2d(point(a), point(b), point(c)) == 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    fn test(shear: &Shear, corners: &[[f32; 3]; 3]) -> Option<Intersection> {
        match shear.axes[2] {
            0 => shear.intersect::<0>(corners),
            1 => shear.intersect::<1>(corners),
            _ => shear.intersect::<2>(corners),
        }
    }

    fn hit(origin: [f32; 3], direction: [f32; 3]) -> Option<Intersection> {
        test(&Shear::new(origin, &direction), &UNIT)
    }

    #[test]
    fn lanes_agree_to_the_last_bit() {
        // Corners of a coarse grid, so that many rays run through edges and vertices; some corners overflow.
        let mut state = 1u64;
        let mut coordinate = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let x = (state >> 33) % 7;
            if state >> 60 == 0 { 3e38 * (x as f32 - 3.0) / 3.0 } else { x as f32 - 3.0 }
        };
        let mut hits = 0;
        for _ in 0..50_000 {
            let mut point = || std::array::from_fn::<f32, 3, _>(|_| coordinate());
            let (origin, direction, corners) = (point(), point(), [point(), point(), point()]);
            if direction == [0.0; 3] {
                continue;
            }
            let shear = Shear::new(origin, &direction);
            let by_lanes = match shear.axes[2] {
                0 => shear.intersect_by_lanes::<0>(&corners),
                1 => shear.intersect_by_lanes::<1>(&corners),
                _ => shear.intersect_by_lanes::<2>(&corners),
            };
            let bits = |found: Option<Intersection>| found.map(|i| [i.t, i.u, i.v].map(f32::to_bits));
            assert_eq!(bits(test(&shear, &corners)), bits(by_lanes));
            hits += u32::from(by_lanes.is_some());
        }
        assert!(hits > 1000, "{hits}");
    }

    #[test]
    fn t_counts_in_units_of_the_direction_and_uv_weigh_vertices_1_and_2() {
        let found = hit([0.25, 0.5, 3.0], [0.0, 0.0, -2.0]).unwrap();
        assert_eq!(found, Intersection { t: 1.5, u: 0.25, v: 0.5 });
    }

    #[test]
    fn edges_and_vertices_belong_to_the_triangle() {
        for point in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.5, 0.0], [0.0, 0.25]] {
            assert!(hit([point[0], point[1], 1.0], [0.0, 0.0, -1.0]).is_some(), "{point:?}");
        }
        assert!(hit([0.5, f32::from_bits(0.5f32.to_bits() + 1), 1.0], [0.0, 0.0, -1.0]).is_none());
    }

    #[test]
    fn a_ray_in_the_plane_misses() {
        assert!(hit([-1.0, 0.25, 0.0], [1.0, 0.0, 0.0]).is_none());
    }

    #[test]
    fn tiny_is_not_degenerate_and_collinear_is() {
        let tiny = UNIT.map(|p| p.map(|x| x * 1e-38));
        assert!(!is_degenerate(&tiny));
        assert!(is_degenerate(&[[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.4, 0.4, 0.4]]));
        assert!(is_degenerate(&[UNIT[0], UNIT[1], UNIT[1]]));
        assert!(is_degenerate(&[UNIT[0], UNIT[1], [f32::NAN, 0.0, 0.0]]));
        // 0.1 + 0.2 is not 0.3 in f32: nearly, but not exactly collinear.
        assert!(!is_degenerate(&[[0.0, 0.0, 0.0], [0.1, 1.0, 0.0], [0.3, 3.0, 0.0]]));
    }

    #[test]
    fn a_tiny_triangle_is_hit_though_f32_products_underflow() {
        let tiny = UNIT.map(|p| p.map(|x| x * 1e-30));
        let found = test(&Shear::new([0.2e-30, 0.2e-30, 1e-30], &[0.0, 0.0, -1.0]), &tiny).unwrap();
        assert!((found.u - 0.2).abs() < 1e-6);
    }
}
