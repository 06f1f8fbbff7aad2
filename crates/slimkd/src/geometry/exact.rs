//! A ray in f64 whose crossings are decided exactly, by the signs of real numbers.
//!
//! Sources: Shewchuk 1997 for signs by a filter first and without rounding then; Edelsbrunner & Mücke, *Simulation of Simplicity*, 1990,
//! for rays through edges and vertices; Woop, Benthin & Wald 2013 for the ray's frame.
//!
//! **Signs.** For the corners p, q of an edge, `side(p, q) = det(d, p − o, q − o)` tells on which side of it the ray o + t·d passes. In the
//! ray's frame it is d_z · (x_p·y_q − y_p·x_q). Let R be the largest |x| + |z| or |y| + |z| of the corners as seen from o, and u = 2⁻⁵³. A
//! sheared coordinate is off by at most 4u·R: a difference, a slope and its product, another difference. So the bracket is off by at most
//! 2 · 2 · 4u·R² of that, 2u·R² of its products and 2u·R² of their difference: 20u·R², and its sign is certain beyond 32u·R² = 2⁻⁴⁸·R².
//! Where it is not, the determinant is computed without rounding.
//!
//! **Ownership.** A ray that counts crossings is thought to start at o + ε·x + ε²·y, with x and y the frame's first axes and ε above 0, but
//! smaller than any number that matters. `side` is linear in o, so its sign there is that of the first of three numbers which is not 0: the
//! determinant itself; `d_y·r_z − d_z·r_y`; `d_z·r_x − d_x·r_z`, with r = q − p. All three are 0 only where the edge runs along the ray, so that
//! its triangle is seen edge-on. Hence the displaced ray meets no edge and no vertex, and crosses exactly those triangles whose three
//! signs are equal; no triangle within whose plane d lies is among them. Whatever is true of the crossings of a ray that meets no edge
//! is true of these: `query/crossings.rs` says what that is.
//!
//! **Where.** The crossing tends to a point of the closed triangle on the undisplaced ray as ε tends to 0. Its t is N / D with
//! N = det(a − o, b − a, c − a) and D = det(d, b − a, c − a), and compares with the ends of the range by the sign of N − t_end·D, exactly
//! again. An end that the crossing falls on belongs to the range. So t ≥ 0 holds for the displaced ray as well, unless o itself
//! lies on the triangle.
//!
//! **Range of numbers.** Coordinates of corners are f32. A direction is multiplied by a power of two so that its longest component is in
//! [4, 8); of it, of the origin and of the range's ends what is below 2⁻³⁰⁰ is taken to be 0. Origins are at most `f32::MAX`; ends above
//! 2²⁰⁰ are infinite, as nothing is that far away. So the smallest bit of any product is 2⁻¹⁰⁵⁶, and none overflows.
//!
//! **Which triangles a walk must meet** is proved in `traverse/exact.rs`.

use super::double::{Double, determinant};
use super::expansion::Expansion;
use super::{HitF64, Ray, RayF64};
use std::cmp::Ordering;

/// Relative error of a side's bracket, as derived in the module head.
const FILTER: f64 = 1.0 / (1u64 << 48) as f64;
/// Where a determinant in double-double keeps more than this of its terms' sizes, 60 bits of it are right.
const FINE_FILTER: f64 = 1.0 / (1u64 << 40) as f64;
/// What is smaller is 0.
const LEAST: f64 = f64::from_bits((1023 - 300) << 52);
/// What is larger is infinite.
const MOST: f64 = f64::from_bits((1023 + 200) << 52);
/// The longest component of a direction is between 2⁻¹⁰⁰⁰ and 2¹⁰⁰⁰.
const SHORTEST: f64 = f64::from_bits((1023 - 1000) << 52);
const LONGEST: f64 = f64::from_bits((1023 + 1000) << 52);

type Corners = [[f32; 3]; 3];

/// A ray as exact decisions need it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactRay {
    origin: [f64; 3],
    /// Scaled by a power of two: its longest component is in [4, 8).
    direction: [f64; 3],
    /// World axes that play x, y, z; z is where the direction is longest.
    axes: [usize; 3],
    /// Direction's x/z and y/z, rounded.
    slope: [f64; 2],
    /// The range in units of the scaled direction.
    t_min: f64,
    t_max: f64,
    /// The user's t per scaled t.
    unit: f64,
}

/// The corners in the ray's frame, rounded: x, y, and z along the ray.
struct Seen {
    x: [f64; 3],
    y: [f64; 3],
    /// The module head's R.
    reach: f64,
}

impl ExactRay {
    /// `None` where the ray is invalid: not finite, without a direction, with an empty range, or beyond what the module head allows.
    pub(crate) fn new(origin: [f64; 3], direction: [f64; 3], range: [f64; 2]) -> Option<Self> {
        let [t_min, t_max] = range;
        let size = direction.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let finite =
            origin.iter().all(|x| x.abs() <= f32::MAX.into()) && direction.iter().all(|x| x.is_finite());
        if !finite
            || !(SHORTEST..LONGEST).contains(&size)
            || t_min > t_max
            || t_min.is_nan()
            || t_max.is_nan()
        {
            return None;
        }
        // 4 / 2ᵉ for a size in [2ᵉ, 2ᵉ⁺¹): exponents of f64 are biased by 1023.
        let unit = f64::from_bits((2046 + 2 - (size.to_bits() >> 52)) << 52);
        let direction = direction.map(|x| flush(x * unit));
        let [x, y, z] = direction.map(f64::abs);
        let z = if x > y {
            if x > z { 0 } else { 2 }
        } else if y > z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        Some(Self {
            origin: origin.map(flush),
            direction,
            axes: [x, y, z],
            slope: [direction[x] / direction[z], direction[y] / direction[z]],
            t_min: scaled(t_min, unit),
            t_max: scaled(t_max, unit),
            unit,
        })
    }

    /// The user's `t` in units of the scaled direction.
    pub(crate) fn scaled(&self, t: f64) -> f64 {
        scaled(t, self.unit)
    }

    /// The same ray in f64.
    pub(crate) fn from_ray(ray: &Ray) -> Option<Self> {
        let range = [ray.t_min, ray.t_max].map(f64::from);
        Self::new(ray.origin.map(f64::from), ray.direction.map(f64::from), range)
    }

    /// A ray in world coordinates, for a mesh that has its `origin` there.
    pub(crate) fn in_world(ray: &RayF64, origin: [f64; 3]) -> Option<Self> {
        let start = std::array::from_fn(|k| ray.origin[k] - origin[k]);
        Self::new(start, ray.direction, [ray.t_min, ray.t_max])
    }

    /// The ray rounded to f32, its range rounded outwards, and how far its start was moved per axis at most. What it calls t is in units of
    /// the scaled direction.
    pub(crate) fn rounded(&self) -> (Ray, f32) {
        let ray = Ray::new(self.origin.map(|x| x as f32), self.direction.map(|x| x as f32))
            .with_range(below(self.t_min), above(self.t_max));
        let moved = (0..3).map(|k| (self.origin[k] - f64::from(ray.origin[k])).abs()).fold(0.0, f64::max);
        (ray, if moved == 0.0 { 0.0 } else { above(moved) })
    }

    #[inline(always)]
    fn see(&self, corners: &Corners) -> Seen {
        let [kx, ky, kz] = self.axes;
        let mut seen = Seen { x: [0.0; 3], y: [0.0; 3], reach: 0.0 };
        for (i, corner) in corners.iter().enumerate() {
            let from_origin = |k: usize| f64::from(corner[k]) - self.origin[k];
            let (x, y, z) = (from_origin(kx), from_origin(ky), from_origin(kz));
            seen.x[i] = x - self.slope[0] * z;
            seen.y[i] = y - self.slope[1] * z;
            let reach = x.abs().max(y.abs()) + z.abs();
            seen.reach = if reach > seen.reach { reach } else { seen.reach };
        }
        seen
    }

    /// 1 where the displaced ray crosses the triangle along the side's turn `(b − a) × (c − a)`, −1 where against it, 0 where it does not. The
    /// crossing may lie anywhere on the ray's line.
    #[inline(always)]
    pub(crate) fn crosses(&self, corners: &Corners) -> i8 {
        let signs = self.certain_signs(corners);
        if signs.contains(&1) && signs.contains(&-1) {
            return 0;
        }
        if signs.contains(&0) { self.crosses_exactly(corners, signs) } else { signs[0] }
    }

    /// The signs of the sides bc, ca and ab; 0 where they are not certain.
    #[inline(always)]
    fn certain_signs(&self, corners: &Corners) -> [i8; 3] {
        let Seen { x: [ax, bx, cx], y: [ay, by, cy], reach } = self.see(corners);
        let least = FILTER * reach * reach;
        let turned = self.direction[self.axes[2]] < 0.0;
        [bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx]
            .map(|side| (i8::from(side > least) - i8::from(side < -least)) * if turned { -1 } else { 1 })
    }

    /// Whether f64 cannot tell if the ray's line meets the triangle.
    #[inline(always)]
    pub(crate) fn is_uncertain(&self, corners: &Corners) -> bool {
        let signs = self.certain_signs(corners);
        signs.contains(&0) && !(signs.contains(&1) && signs.contains(&-1))
    }

    #[cold]
    fn crosses_exactly(&self, corners: &Corners, mut signs: [i8; 3]) -> i8 {
        let [a, b, c] = corners;
        let known = signs.iter().sum::<i8>().signum();
        let mut all = known;
        for (sign, (p, q)) in signs.iter_mut().zip([(b, c), (c, a), (a, b)]) {
            if *sign == 0 {
                *sign = self.displaced_side(p, q);
            }
            all = if all == 0 { *sign } else { all };
            if *sign != all || *sign == 0 {
                return 0;
            }
        }
        all
    }

    /// The side as the displaced ray sees it.
    fn displaced_side(&self, p: &[f32; 3], q: &[f32; 3]) -> i8 {
        let side = self.side(p, q);
        if side != 0 {
            return side;
        }
        let [x, y, z] = self.axes;
        let along = |k: usize| Double::difference(q[k], p[k]);
        let minor = |i: usize, j: usize| {
            let mut sum = Expansion::default();
            sum.add_minor([self.direction[i], self.direction[j]], [along(i), along(j)]);
            sum.sign()
        };
        let first = minor(y, z);
        if first != 0 { first } else { minor(z, x) }
    }

    /// The sign of det(d, p − o, q − o).
    fn side(&self, p: &[f32; 3], q: &[f32; 3]) -> i8 {
        let mut sum = Expansion::default();
        sum.add_determinant(1.0, self.direction.map(whole), self.seen(p), self.seen(q));
        sum.sign()
    }

    fn seen(&self, p: &[f32; 3]) -> [Double; 3] {
        std::array::from_fn(|k| Double::difference(p[k], self.origin[k]))
    }

    /// Whether the ray crosses the triangle's plane, which it `crosses` along that sign, within its range.
    #[inline]
    pub(crate) fn reaches(&self, corners: &Corners, crosses: i8) -> bool {
        self.order(corners, crosses, self.t_min).is_ge() && self.order(corners, crosses, self.t_max).is_le()
    }

    /// How the t of a crossing, along that sign, compares with `t` in units of the scaled direction, exactly.
    pub(crate) fn order(&self, corners: &Corners, crosses: i8, t: f64) -> Ordering {
        if t.is_infinite() {
            return 0f64.total_cmp(&t);
        }
        let [a, b, c] = corners.map(|corner| corner.map(f64::from));
        let (mut sum, mut sizes) = (0.0, 0.0);
        let edge = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        let (e1, e2) = (edge(b), edge(c));
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let (start, step) = (a[k] - self.origin[k], t * self.direction[k]);
            let (left, right) = (e1[i] * e2[j], e1[j] * e2[i]);
            sum += (start - step) * (left - right);
            sizes += (start.abs() + step.abs()) * (left.abs() + right.abs());
        }
        // Eleven roundings at most in each term.
        let sign = if sum.abs() > FILTER * sizes {
            if sum > 0.0 { 1 } else { -1 }
        } else {
            self.exact_order(corners, t)
        };
        (sign * crosses).cmp(&0)
    }

    #[cold]
    fn exact_order(&self, corners: &Corners, t: f64) -> i8 {
        let [to_corner, e1, e2] = self.rows(corners);
        let mut sum = Expansion::default();
        sum.add_determinant(1.0, to_corner, e1, e2);
        sum.add_determinant(-t, self.direction.map(whole), e1, e2);
        sum.sign()
    }

    /// Where the ray meets the closed triangle, edges and vertices included, if it does so within its range; t is in units of the scaled
    /// direction. Each number is off by less than 2⁻⁵⁰ of itself. A ray within the triangle's plane does not meet it.
    #[inline(always)]
    pub(crate) fn meets(&self, corners: &Corners, triangle: u32) -> Option<HitF64> {
        let signs = self.certain_signs(corners);
        if signs.contains(&1) && signs.contains(&-1) {
            return None;
        }
        self.meets_exactly(corners, triangle, signs)
    }

    #[inline(never)]
    fn meets_exactly(&self, corners: &Corners, triangle: u32, mut signs: [i8; 3]) -> Option<HitF64> {
        let [a, b, c] = corners;
        for (sign, (p, q)) in signs.iter_mut().zip([(b, c), (c, a), (a, b)]) {
            if *sign == 0 {
                *sign = self.side(p, q);
            }
        }
        // Weights of different signs are a miss; three that are 0 are a triangle seen edge-on.
        let (some, other) = (signs.contains(&1), signs.contains(&-1));
        if some == other || !self.reaches(corners, if some { 1 } else { -1 }) {
            return None;
        }
        let [to_corner, e1, e2] = self.rows(corners);
        let (d, to_others) = (self.direction.map(whole), [c, b].map(|p| self.seen(p)));
        let along = number(d, e1, e2);
        let t = (number(to_corner, e1, e2) / along).max(self.t_min).min(self.t_max);
        let u = number(d, to_others[0], to_corner) / along;
        let v = number(d, to_corner, to_others[1]) / along;
        [t, u, v].iter().all(|x| x.is_finite()).then_some(HitF64 { t, u, v, triangle })
    }

    /// A hit with its t in the user's units, `None` where that is too large.
    pub(crate) fn unscaled(&self, hit: HitF64) -> Option<HitF64> {
        let t = hit.t * self.unit;
        t.is_finite().then_some(HitF64 { t, ..hit })
    }

    /// From the origin to corner a, and the edges from there.
    fn rows(&self, [a, b, c]: &Corners) -> [[Double; 3]; 3] {
        let edge = |p: &[f32; 3]| std::array::from_fn(|k| Double::difference(p[k], a[k]));
        [self.seen(a), edge(b), edge(c)]
    }

    /// Whether the ray's origin lies on the closed triangle, exactly.
    #[inline]
    pub(crate) fn starts_on(&self, corners: &Corners) -> bool {
        let [a, b, c] = corners;
        let outside = (0..3).any(|k| {
            let at = self.origin[k];
            let corners = [a[k], b[k], c[k]].map(f64::from);
            corners.iter().all(|&x| x < at) || corners.iter().all(|&x| x > at)
        });
        !outside && self.starts_exactly_on(corners)
    }

    #[cold]
    fn starts_exactly_on(&self, corners: &Corners) -> bool {
        let [to_corner, e1, e2] = self.rows(corners);
        let mut sum = Expansion::default();
        sum.add_determinant(1.0, to_corner, e1, e2);
        if sum.sign() != 0 {
            return false;
        }
        // In the triangle's plane: inside in each of the three projections, in which a side is a determinant with a unit vector.
        let [a, b, c] = corners;
        (0..3).all(|axis| {
            let unit = std::array::from_fn(|k| whole(if k == axis { 1.0 } else { 0.0 }));
            let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                let mut sum = Expansion::default();
                sum.add_determinant(1.0, unit, self.seen(p), self.seen(q));
                sum.sign()
            });
            !(sides.contains(&1) && sides.contains(&-1))
        })
    }
}

/// The determinant of the rows a, b, c with a relative error below 2⁻⁵².
fn number(a: [Double; 3], b: [Double; 3], c: [Double; 3]) -> f64 {
    let found = determinant(a, b, c).value();
    let mut sizes = 0.0;
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        sizes += a[k].0.abs() * ((b[i].0 * c[j].0).abs() + (b[j].0 * c[i].0).abs());
    }
    if found.abs() > FINE_FILTER * sizes {
        return found;
    }
    let mut sum = Expansion::default();
    sum.add_determinant(1.0, a, b, c);
    sum.value()
}

fn flush(x: f64) -> f64 {
    if x.abs() < LEAST { 0.0 } else { x }
}

fn scaled(t: f64, unit: f64) -> f64 {
    let t = flush(t / unit);
    if t.abs() > MOST { f64::INFINITY.copysign(t) } else { t }
}

/// A number without a second part.
fn whole(x: f64) -> Double {
    Double(x, 0.0)
}

/// The next f32 at or below.
fn below(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

/// The next f32 at or above.
pub(crate) fn above(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) < x { rounded.next_up() } else { rounded }
}
