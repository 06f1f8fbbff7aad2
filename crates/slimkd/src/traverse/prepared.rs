//! What is computed of a ray before its walk, and the proof that no hit is lost at a split plane.
//!
//! Sources: Ize, *Robust BVH Ray Traversal*, JCGT 2(2), 2013, for the idea of widening; Havran 2001 §4 for ordering
//! children by the sign of the direction.
//!
//! Deviations and their reason
//! 1. Every split plane is a slab of half-width `slack` (a length, not a number of ulps): the near child's interval
//!    ends at `t₀ + slack·|1/d|`, the far child's begins at `t₀ − slack·|1/d|`. A found hit point lies within
//!    `5·2⁻²⁴·M` of its triangle (sheared f32 corners, f64 weights), `t` is rounded once more (`2⁻²⁴·M`), and `t₀`
//!    is off by at most `4·2⁻²⁴·M`, with M the largest distance per axis from the origin to the scene's bounds.
//!    The sum stays below `slack = 2⁻¹⁹·M`, so the leaf that holds the triangle at that point is always visited:
//!    closest hits cannot depend on the tree. Planes on a grid (`layout/dense`) add their cell to the slack, and
//!    the conversion of the origin to grid coordinates adds `5·2⁻²⁴·M` to the error of t₀. The errors then sum to
//!    `15·2⁻²⁴·M`, and the slack is `32·2⁻²⁴·M`.
//!    Below, *width* is `(slack + cell)·|1/d|`; the proof needs only 15/32 of it.
//! 2. `1/d` is bounded: an axis-parallel ray moves less than `slack` along a replaced component, so there is no
//!    infinity and no 0·∞, and a ray inside a split plane visits both children.
//! 3. Intervals are kept in units of the direction scaled by a power of two to a length near 1, so that directions
//!    of 10⁻³⁰ or 10³⁰ neither overflow nor underflow. Hits report t in the user's units.
//! 4. Overflow and underflow of f32 make slabs wider, never narrower. Where a width is infinite, the ray visits both children:
//!    whatever `t₀` is then, infinite or NaN too, `exit < t₀ − ∞` and `t₀ + ∞ < enter` are false.
//!    - *Overflow of a factor.* Widths are counted in the units of the planes: `(4M·scale)·(slack/4M) + cell`, times the
//!      same `|1/d|·unscale` that t₀ is multiplied by. So where that factor is infinite, the width is infinite as well; and where
//!      the origin in plane units is infinite, so is `4M·scale`, which is at least twice as large.
//!    - *Overflow of t₀ alone.* The width is below 2¹²⁸, so the needed part of the slab begins above 2¹²⁸·(1 − 15/32) > 2¹²⁷.
//!      With M ≤ 2¹²⁶ the interval ends at M·(1 + 2⁻¹⁷) at most, as the longest component is 1 at least: the far child is
//!      rightly left out. With a larger M, `4M` is infinite. So is the slack of a direction below the normal numbers,
//!      whose longest component does not reach 1. The same holds for the bounds.
//!    - *Underflow.* Products off by 2⁻¹⁵⁰ instead of a part of 2⁻²⁴, in the triangle test or here, stay far below the
//!      least slack, [`LEAST`]. A t among the subnormal numbers is off by 2⁻¹⁵⁰ as well, which is `scale·2⁻¹⁵⁰` in scaled
//!      units: the second part of that least slack is 2⁷ times this.
//!    - *Range.* A `t` must be finite to count as a hit: the ray's range is cut to ±[`f32::MAX`], so that no two different t
//!      become equal by being infinite.

use super::counters::count;
use super::sink::Sink;
use crate::geometry::{Aabb, Intersection, Ray, Shear};
use crate::layout::Planes;
use crate::simd::Four;

/// Half-width of a split plane relative to M; derived in the module head.
const SLACK: f32 = 1.0 / (1 << 19) as f32;

/// [`SLACK`] relative to 4M instead of M.
pub(super) const QUARTER_SLACK: f32 = SLACK / 4.0;

/// The least value of 4M, so that the least slack is a normal number. For rays of a large scale it is multiplied by
/// `scale · LEAST_SCALED` where that is above 1.
pub(super) const LEAST: f32 = f32::MIN_POSITIVE / QUARTER_SLACK;

/// The part of [`LEAST`] that a ray of scale 1 needs against underflow of t: a slack of 2⁻¹⁴², of which the longest axis keeps half.
pub(super) const LEAST_SCALED: f32 = 1.0 / (1 << 16) as f32;

/// Smallest direction component relative to the largest: below it, a ray is parallel to the plane.
pub(super) const PARALLEL: f32 = 1.0 / (1u64 << 60) as f32;

/// A ray with all values that the walk and the triangle tests use, computed in advance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedRay {
    pub(crate) shear: Shear,
    /// The origin in the tree's plane coordinates; here and below, a fourth number counts for nothing.
    pub(crate) plane_origin: [f32; 4],
    /// The ray's distance in scaled units for each plane unit along an axis.
    pub(crate) inverse: [f32; 4],
    /// Half the widths of slabs along the ray, in scaled units, for each axis: the *width* of the module head.
    pub(crate) slack: [f32; 4],
    /// All ones where the ray descends on that axis, so that the right child is the near one; else 0.
    pub(crate) descends: [u32; 4],
    /// The ray's interval inside the scene's bounds, in scaled units.
    pub(crate) enter: f32,
    pub(crate) exit: f32,
    /// The user's `t_min` and `t_max`, cut to finite numbers.
    pub(crate) t_min: f32,
    pub(crate) t_max: f32,
    /// Scaled t per user t, a power of two.
    pub(crate) scale: f32,
}

impl PreparedRay {
    /// Stands where there is no ray yet.
    pub(super) const NONE: Self = Self {
        shear: Shear { origin: [0.0; 3], axes: [0, 1, 2], slope: [0.0; 2], along: 0.0 },
        plane_origin: [0.0; 4],
        inverse: [0.0; 4],
        slack: [0.0; 4],
        descends: [0; 4],
        enter: 0.0,
        exit: 0.0,
        t_min: 0.0,
        t_max: 0.0,
        scale: 0.0,
    };

    /// `None` when the ray is invalid or passes the bounds by.
    #[inline]
    pub(crate) fn new(ray: &Ray, bounds: &Aabb, planes: &Planes) -> Option<Self> {
        Self::moved(ray, 0.0, bounds, planes)
    }

    /// [`PreparedRay::new`] for a ray whose start was moved by as much per axis at most: slabs are wider by twice that on both sides
    /// (`exact.rs`).
    #[inline(always)]
    pub(crate) fn moved(ray: &Ray, moved: f32, bounds: &Aabb, planes: &Planes) -> Option<Self> {
        let [origin, direction]: [[f32; 4]; 2] = bytemuck::cast(*ray);
        let (origin, direction) = (Four::new(origin), Four::new(direction));
        let (low, high) = (Four::three(bounds.min), Four::three(bounds.max));
        // A lane an axis; what is in the last lane counts for nothing.
        let most = Four::all(f32::MAX);
        let finite = origin.abs().up_to(most).and(direction.abs().up_to(most));
        let valid = finite.and(low.up_to(high)).bits() == 7
            && direction.differs(Four::all(0.0)).bits() != 0
            && ray.t_min <= ray.t_max;
        if !valid {
            return None;
        }
        // 1. Scale the direction to a length near 1 (deviation 3).
        let shear = Shear::new(ray.origin, &ray.direction);
        let longest = ray.direction[shear.axes[2]].abs();
        let scale = power_of_two_below(longest);
        // 2. `reach` becomes 4M, from which the slack follows (deviations 1 and 4).
        let (to_low, to_high) = (low - origin, high - origin);
        let [x, y, z, _] = to_low.abs().larger(to_high.abs()).lanes();
        let reach = larger(x, larger(y, larger(z, 0.0)));
        let least = if longest < f32::MIN_POSITIVE {
            f32::INFINITY
        } else {
            LEAST * larger(scale * LEAST_SCALED, 1.0)
        };
        let reach = 4.0 * (reach + moved * (2.0 / SLACK)) + least;
        // 3. The reciprocal (deviation 2).
        let direction = direction * Four::all(reciprocal(scale));
        let parallel = direction.and(Four::all(-0.0)).or(Four::all(PARALLEL));
        let direction = direction.abs().below(Four::all(PARALLEL)).choose(parallel, direction);
        let descends = direction.below(Four::all(0.0));
        let inverted = Four::all(1.0) / direction;
        // 4. The width of slabs, in the planes' coordinates.
        let (plane_scale, inverse) = (Four::three(planes.scale), inverted * Four::three(planes.unscale));
        let width = Four::all(reach) * plane_scale * Four::all(QUARTER_SLACK) + Four::all(planes.cell);
        let widths = width * inverse.abs();
        // 5. The interval inside the scene's bounds.
        let (to_low, to_high) = (to_low * inverted, to_high * inverted);
        let [a, b, c, _] = (descends.choose(to_high, to_low) - widths).lanes();
        let [d, e, f, _] = (descends.choose(to_low, to_high) + widths).lanes();
        let (t_min, t_max) = (larger(ray.t_min, f32::MIN), smaller(ray.t_max, f32::MAX));
        let enter = larger(c, larger(b, larger(a, t_min * scale)));
        let exit = smaller(f, smaller(e, smaller(d, t_max * scale)));
        if enter > exit {
            return None;
        }
        let plane_origin = (origin - Four::three(planes.low)) * plane_scale + Four::all(planes.shift);
        Some(Self {
            shear,
            plane_origin: plane_origin.lanes(),
            inverse: inverse.lanes(),
            slack: widths.lanes(),
            descends: bytemuck::cast(descends.lanes()),
            enter,
            exit,
            t_min,
            t_max,
            scale,
        })
    }
}

impl PreparedRay {
    /// Tests one triangle, and offers a hit within `t_min` and `t_max` to `sink`. `true` ends the walk. `Z` must be the ray's longest
    /// axis.
    #[inline(always)]
    pub(crate) fn offer<const Z: usize>(
        &self,
        corners: &[[f32; 3]; 3],
        triangle: u32,
        sink: &mut impl Sink,
    ) -> bool {
        count(|c| {
            (c.triangles, c.ray_triangles, c.triangle_lanes) =
                (c.triangles + 1, c.ray_triangles + 1, c.triangle_lanes + 1);
        });
        if let Some(done) = sink.decide(corners, triangle) {
            return done;
        }
        self.hand_over(self.shear.intersect_by_lanes::<Z>(corners), triangle, sink)
    }

    /// Offers an intersection within `t_min` and `t_max` to `sink`. `true` ends the walk.
    #[inline(always)]
    pub(crate) fn hand_over(&self, found: Option<Intersection>, triangle: u32, sink: &mut impl Sink) -> bool {
        match found {
            Some(found) if self.t_min <= found.t && found.t <= self.t_max => sink.offer(found, triangle),
            _ => false,
        }
    }
}

/// `a` when it is the larger, else `b`; so where `a` is NaN, this is `b`. It is one instruction, unlike `f32::max`.
#[inline(always)]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `a` when it is the smaller, else `b`; so where `a` is NaN, this is `b`.
#[inline(always)]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The power of two at or below a positive normal `x`; the smallest normal one for anything below.
#[inline]
fn power_of_two_below(x: f32) -> f32 {
    f32::from_bits((x.to_bits() & 0x7f80_0000).max(f32::MIN_POSITIVE.to_bits()))
}

/// Exact reciprocal of a power of two between 2⁻¹²⁶ and 2¹²⁷ (the last one's is subnormal, and still exact).
#[inline]
fn reciprocal(power: f32) -> f32 {
    if power >= 2.0f32.powi(127) { 2.0f32.powi(-127) } else { f32::from_bits((254 << 23) - power.to_bits()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_exact() {
        for x in [1.0f32, 1.5, 3.0, 1e-30, 1e30, f32::MIN_POSITIVE, f32::MAX, 2.0f32.powi(127)] {
            let power = power_of_two_below(x);
            assert!(power <= x && x / power < 2.0, "{x}");
            assert_eq!(power * reciprocal(power), 1.0, "{x}");
        }
        assert_eq!(power_of_two_below(1e-40), f32::MIN_POSITIVE);
    }
}
