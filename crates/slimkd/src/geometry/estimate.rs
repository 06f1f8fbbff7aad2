//! Where along a ray a hit lies, in f32 and with a bound of the error, so that f64 can wait until it is known which hits matter.
//!
//! Source: running error analysis as in Higham, *Accuracy and Stability of Numerical Algorithms*, §3.3. The bound is our own:
//!
//! With ε = 2⁻²⁴ and everything in the ray's frame, where the corners are the same f32 numbers that [`Shear::decide`] starts from: u, v
//! and w are differences of two products, S is the sum of the six products' absolute values, Z the largest |z| of a corner, and `along`
//! the ray's longest component. The exact t is `T / D` with `T = u·az + v·bz + w·cz` and `D = (u + v + w) · along`.
//!
//! 1. *Signs.* Each edge function is off by at most 2ε of its own two products, so by less than 2ε·S(1 + ε). Where all three are above
//!    8ε·S, or all below −8ε·S, their exact signs are the computed ones, and [`Shear::decide`] finds a hit.
//! 2. *Distance.* The exact `|T / D|` is then at most Z/|along|. To first order, T is off by ε·S·Z times 2 for the edge functions, 1 for
//!    the products and 2 for the sums; D, in parts of itself, by ε·S/|u + v + w| times 2 for the edge functions, 2 for the sums and 1 for
//!    the product. So `T / D` is off by ε·S·Z/|D| times 10, and by 4 more for the reciprocal of D, its product with T, the rounding of the
//!    decided t to f32, and that of the two bounds here. The bound is 32 of these units, which leaves more than half of it for terms of
//!    second order and for the rounding of the bound itself.
//! 3. *Underflow.* A product below the normal numbers is off by 2⁻¹⁵⁰ besides. With S ≥ 2⁻⁶⁰ and Z ≥ 2⁻⁴⁰ that is nothing beside 8ε·S and
//!    ε·S·Z. With |D| ≥ 2⁻¹⁰⁰, its reciprocal is finite.
//! 4. *Overflow.* With |D| ≤ 2¹⁰⁰ and 32ε·S·Z ≤ 2¹⁰⁰, T is finite, and the reciprocal a normal number. An infinity or NaN makes one of
//!    the comparisons false, and the answer "not sure".
//!
//! [`Simd::quad`](crate::simd::Simd::quad) computes the same for four triangles at once.

use super::Shear;

/// 8ε: what an edge function must exceed, relative to S.
pub(crate) const SIGN: f32 = 1.0 / (1 << 21) as f32;
/// 32ε: the error of T/D, relative to S·Z/|D|.
pub(crate) const DISTANCE: f32 = 1.0 / (1 << 19) as f32;
pub(crate) const LEAST_SUM: f32 = 1.0 / (1u64 << 60) as f32;
pub(crate) const LEAST_REACH: f32 = 1.0 / (1u64 << 40) as f32;
pub(crate) const LEAST_SCALE: f32 = 1.0 / (1u128 << 100) as f32;
pub(crate) const MOST_SCALE: f32 = (1u128 << 100) as f32;

/// What f32 can say of a ray and a triangle that it may hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimate {
    /// The ray hits the triangle, and the t that [`Shear::decide`] finds lies within [`Estimate::bounds`]. Otherwise f32 cannot tell.
    pub(crate) sure: bool,
    /// T and D, both negated where D would be negative.
    pub(crate) distance: f32,
    pub(crate) scale: f32,
    /// 32ε·S·Z.
    pub(crate) error: f32,
}

impl Estimate {
    /// The least and the largest t that the hit can have.
    #[inline(always)]
    pub(crate) fn bounds(&self) -> [f32; 2] {
        let per_scale = 1.0 / self.scale;
        let (t, error) = (self.distance * per_scale, self.error * per_scale);
        [t - error, t + error]
    }

    /// Whether the ray surely hits the triangle behind `limit`.
    #[inline(always)]
    pub(crate) fn is_behind(&self, limit: f32) -> bool {
        self.sure & (self.distance - self.error > limit * self.scale)
    }
}

impl Shear {
    /// What is known of a triangle without f64.
    #[inline(always)]
    pub(crate) fn estimate(&self, corners: &[[f32; 3]; 3]) -> Estimate {
        let sheared = self.sheared(corners);
        let ([ax, bx, cx], [ay, by, cy], [az, bz, cz]) = (sheared.x, sheared.y, sheared.z);
        let [u1, u2, v1, v2, w1, w2] = [cx * by, cy * bx, ax * cy, ay * cx, bx * ay, by * ax];
        let (u, v, w) = (u1 - u2, v1 - v2, w1 - w2);
        let sum = (u1.abs() + u2.abs()) + (v1.abs() + v2.abs()) + (w1.abs() + w2.abs());
        let reach = larger(az.abs(), larger(bz.abs(), cz.abs()));
        let (distance, scale) = (u * az + v * bz + w * cz, (u + v + w) * self.along as f32);
        let (error, least) = (sum * reach * DISTANCE, sum * SIGN);
        let inside = (u > least) & (v > least) & (w > least) | (u < -least) & (v < -least) & (w < -least);
        let sure = inside
            & (sum >= LEAST_SUM)
            & (reach >= LEAST_REACH)
            & (scale.abs() >= LEAST_SCALE)
            & (scale.abs() <= MOST_SCALE)
            & (error <= MOST_SCALE);
        Estimate { sure, distance: if scale < 0.0 { -distance } else { distance }, scale: scale.abs(), error }
    }
}

/// `a` when it is the larger, else `b`; a NaN in `a` is passed over, but then an edge function is NaN as well.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of all kinds: near 1, of a coarse grid, far from 0, very small, very large.
    fn number(state: &mut u64) -> f32 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let unit = (*state >> 40) as f32 / (1u64 << 23) as f32 - 1.0;
        match *state >> 20 & 15 {
            0..8 => unit,
            8..10 => (unit * 4.0).round(),
            10 => 1000.0 + unit,
            11 => unit * 1e-12,
            12 => unit * 1e12,
            13 => unit * 1e-3,
            14 => unit.powi(9),
            _ => unit * 2.0f32.powi((*state >> 10 & 255) as i32 - 128),
        }
    }

    #[test]
    fn what_is_sure_is_decided_so() {
        let (mut state, mut sure, mut hits) = (5u64, 0, 0);
        for case in 0..400_000 {
            let mut corners: [[f32; 3]; 3] = [[0.0; 3]; 3];
            corners.as_flattened_mut().iter_mut().for_each(|x| *x = number(&mut state));
            let origin: [f32; 3] = std::array::from_fn(|_| number(&mut state));
            // Half of the rays aim at a point of the triangle, often near its outline.
            let weights: [f32; 3] = std::array::from_fn(|_| number(&mut state).abs().min(1e3) + 1e-30);
            let total: f32 = weights.iter().sum();
            let mut direction: [f32; 3] = std::array::from_fn(|k| {
                if case % 2 == 0 {
                    (0..3).map(|i| corners[i][k] * (weights[i] / total)).sum::<f32>() - origin[k]
                } else {
                    number(&mut state)
                }
            });
            if case % 32 == 0 {
                direction = direction.map(|x| x * 1e20);
            }
            if direction == [0.0; 3] || direction.iter().any(|x| !x.is_finite()) {
                continue;
            }
            let shear = Shear::new(origin, &direction);
            let estimate = shear.estimate(&corners);
            let decided = shear.decide(&corners);
            hits += u32::from(decided.is_some());
            if estimate.sure {
                sure += 1;
                let t = decided.expect("a hit that is sure").t;
                let [low, high] = estimate.bounds();
                assert!(!estimate.is_behind(t));
                assert!(low <= t && t <= high, "{estimate:?} {t} {corners:?} {shear:?}");
                // The proof needs less than half of the bound.
                assert!((t - (low + high) / 2.0).abs() <= (high - low) * 0.25, "{estimate:?} {t}");
            }
        }
        assert!(sure > 50_000 && hits > sure, "{sure} of {hits} hits are sure");
    }

    #[test]
    fn edges_numbers_out_of_range_and_misses_are_not_sure() {
        let unit = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let sure = |origin, direction, scale: f32| {
            let shear = Shear::new(origin, &direction);
            shear.estimate(&unit.map(|p: [f32; 3]| p.map(|x| x * scale))).sure
        };
        assert!(sure([0.2, 0.2, 1.0], [0.0, 0.0, -1.0], 1.0));
        assert!(!sure([0.5, 0.5, 1.0], [0.0, 0.0, -1.0], 1.0), "on an edge");
        assert!(!sure([0.5, 0.500_000_1, 1.0], [0.0, 0.0, -1.0], 1.0), "beside an edge");
        assert!(!sure([0.2e-30, 0.2e-30, 1e-30], [0.0, 0.0, -1.0], 1e-30), "products underflow");
        assert!(!sure([0.2e30, 0.2e30, 1e30], [0.0, 0.0, -1.0], 1e30), "products overflow");
        assert!(sure([0.2, 0.2, 1.0], [0.0, 0.0, -1e-25], 1.0));
        assert!(!sure([0.2, 0.2, 1.0], [0.0, 0.0, -1e-35], 1.0), "a short direction");
        assert!(!sure([0.2, 0.2, 0.0], [0.0, 0.0, -1.0], 1.0), "a start on the triangle");
    }
}
