//! What a ray really crosses: in f64 where its error bound decides, by 128-bit integers where the numbers' exponents are
//! near enough, else in double-double where its bound decides, else by integers of any length; and distances in f64.
#![allow(unreachable_pub)]

use num_bigint::{BigInt, Sign};
use slimkd::Ray;

pub type Corners = [[f32; 3]; 3];
type Vector = [f64; 3];

/// Error of a 3 × 3 determinant of rounded differences in f64, relative to the sum of its terms' sizes: each term has two
/// differences and two products, a difference of both, and two sums, so 7 roundings of 2⁻⁵³ or 7.8·10⁻¹⁶; generously.
const FILTER: f64 = 1e-14;
/// The same in double-double: numbers are exact, a product and a sum err by less than 2⁻¹⁰⁰ each.
const FINE_FILTER: f64 = 1e-28;
/// Sums of sizes below this may have lost something to underflow.
const LEAST: f64 = 1e-280;
/// Relative error that is good enough for t: of a crossing inside the bounds it is below .004 of `docs/promises.md`'s units.
const GOOD: f64 = 1.0 / (1u64 << 34) as f64;
/// Widest whole numbers, bits: a determinant of such, and of differences of such, stays below 2¹²⁰.
const WIDEST: i32 = 38;

pub fn sub(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

pub fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

pub fn wide(a: [f32; 3]) -> Vector {
    a.map(f64::from)
}

/// A finite f32 in units of 2⁻¹⁴⁹: every one is a whole number.
fn whole(x: f32) -> BigInt {
    let bits = x.to_bits();
    let (exponent, fraction) = (bits >> 23 & 0xff, bits & 0x007f_ffff);
    let size = if exponent == 0 {
        BigInt::from(fraction)
    } else {
        BigInt::from(fraction | 1 << 23) << (exponent - 1)
    };
    if bits >> 31 == 1 { -size } else { size }
}

fn whole_difference(a: [f32; 3], b: [f32; 3]) -> [BigInt; 3] {
    std::array::from_fn(|k| whole(a[k]) - whole(b[k]))
}

fn exact_determinant(a: &[BigInt; 3], b: &[BigInt; 3], c: &[BigInt; 3]) -> BigInt {
    let minor = |i: usize, j: usize| &b[i] * &c[j] - &b[j] * &c[i];
    &a[0] * minor(1, 2) + &a[1] * minor(2, 0) + &a[2] * minor(0, 1)
}

/// As whole multiples of one power of two, which is returned too; `None` where that takes more than [`WIDEST`] bits.
fn multiples<const N: usize>(numbers: [f32; N]) -> Option<([i128; N], i32)> {
    let (mut low, mut high) = (i32::MAX, i32::MIN);
    for x in numbers.iter().filter(|x| **x != 0.0) {
        let bits = x.to_bits();
        let (exponent, fraction) = ((bits >> 23 & 0xff) as i32, bits & 0x007f_ffff);
        let (first, digits) =
            if exponent == 0 { (-149, fraction) } else { (exponent - 150, fraction | 1 << 23) };
        low = low.min(first + digits.trailing_zeros() as i32);
        high = high.max(first + 32 - digits.leading_zeros() as i32);
    }
    let low = low.min(high); // all are 0
    let unit = f64::from(-low).exp2();
    (i64::from(high) - i64::from(low) <= WIDEST.into())
        .then(|| (numbers.map(|x| (f64::from(x) * unit) as i128), low))
}

fn small_determinant(a: [i128; 3], b: [i128; 3], c: [i128; 3]) -> i128 {
    let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
    a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)
}

/// A determinant in f64, and the sum of its terms' sizes.
fn rounded_determinant(a: Vector, b: Vector, c: Vector) -> (f64, f64) {
    let (mut sum, mut sizes) = (0.0, 0.0);
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (left, right) = (b[i] * c[j], b[j] * c[i]);
        sum += a[k] * (left - right);
        sizes += a[k].abs() * (left.abs() + right.abs());
    }
    (sum, sizes)
}

/// Sign of det(direction, b − origin, c − origin).
fn side(ray: &Ray, b: [f32; 3], c: [f32; 3]) -> i32 {
    let (d, o) = (wide(ray.direction), wide(ray.origin));
    let (sum, sizes) = rounded_determinant(d, sub(wide(b), o), sub(wide(c), o));
    if sum.abs() > FILTER * sizes && sizes > LEAST {
        return if sum > 0.0 { 1 } else { -1 };
    }
    exact_side(ray, b, c)
}

#[cold]
fn exact_side(ray: &Ray, b: [f32; 3], c: [f32; 3]) -> i32 {
    if let (Some((d, _)), Some((p, _))) =
        (multiples(ray.direction), multiples([ray.origin, b, c].as_flattened().try_into().unwrap()))
    {
        return small_side(d, p);
    }
    fine_side(ray, b, c).unwrap_or_else(|| long_side(ray, b, c))
}

/// An unevaluated sum of two f64 (Dekker 1971), the second below half an ulp of the first.
#[derive(Clone, Copy)]
struct Double(f64, f64);

impl Double {
    /// Exact.
    fn sum(a: f64, b: f64) -> Self {
        let sum = a + b;
        let back = sum - a;
        Self(sum, (a - (sum - back)) + (b - back))
    }

    /// Exact, short of underflow.
    fn product(a: f64, b: f64) -> Self {
        let split = |x: f64| {
            let c = 134_217_729.0 * x;
            let high = c - (c - x);
            (high, x - high)
        };
        let (product, (ah, al), (bh, bl)) = (a * b, split(a), split(b));
        Self(product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
    }

    fn times(self, other: Self) -> Self {
        let Self(high, low) = Self::product(self.0, other.0);
        Self::sum(high, low + (self.0 * other.1 + self.1 * other.0))
    }

    fn minus(self, other: Self) -> Self {
        let Self(high, rest) = Self::sum(self.0, -other.0);
        let Self(low, last) = Self::sum(self.1, -other.1);
        let Self(high, rest) = Self::sum(high, rest + low);
        Self::sum(high, rest + last)
    }
}

/// The side where double-double can tell it.
fn fine_side(ray: &Ray, b: [f32; 3], c: [f32; 3]) -> Option<i32> {
    let from_origin = |p: [f32; 3]| -> [Double; 3] {
        std::array::from_fn(|k| Double::sum(p[k].into(), -f64::from(ray.origin[k])))
    };
    let (p, q) = (from_origin(b), from_origin(c));
    let (mut sum, mut sizes) = (Double(0.0, 0.0), 0.0);
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (left, right) = (p[i].times(q[j]), p[j].times(q[i]));
        let d = f64::from(ray.direction[k]);
        sum = sum.minus(left.minus(right).times(Double(-d, 0.0)));
        sizes += d.abs() * (left.0.abs() + right.0.abs());
    }
    let found = sum.0 + sum.1;
    (found.abs() > FINE_FILTER * sizes && found.abs() > LEAST).then(|| found.signum() as i32)
}

fn small_side(d: [i128; 3], points: [i128; 9]) -> i32 {
    let from_origin = |at: usize| std::array::from_fn(|k| points[at + k] - points[k]);
    small_determinant(d, from_origin(3), from_origin(6)).signum() as i32
}

fn long_side(ray: &Ray, b: [f32; 3], c: [f32; 3]) -> i32 {
    let direction = ray.direction.map(whole);
    let determinant =
        exact_determinant(&direction, &whole_difference(b, ray.origin), &whole_difference(c, ray.origin));
    match determinant.sign() {
        Sign::Plus => 1,
        Sign::NoSign => 0,
        Sign::Minus => -1,
    }
}

/// Whether the ray's whole line crosses the closed triangle, exactly. A line within the plane does not.
pub fn crosses(ray: &Ray, corners: &Corners) -> bool {
    let [a, b, c] = *corners;
    let (first, second) = (side(ray, b, c), side(ray, c, a));
    if first * second < 0 {
        return false;
    }
    let sides = [first, second, side(ray, a, b)];
    (sides.iter().all(|&s| s >= 0) || sides.iter().all(|&s| s <= 0)) && sides != [0; 3]
}

/// Where the line crosses the triangle's plane, to a part of 2⁻³³.
pub fn crossing(ray: &Ray, corners: &Corners) -> Option<f64> {
    let [a, b, c] = corners.map(wide);
    let (e1, e2) = (sub(b, a), sub(c, a));
    let (below, sizes_below) = rounded_determinant(wide(ray.direction), e1, e2);
    let (above, sizes_above) = rounded_determinant(sub(a, wide(ray.origin)), e1, e2);
    let good = |sum: f64, sizes: f64| sum.abs() * GOOD > FILTER * sizes && sizes > LEAST;
    if good(below, sizes_below) && good(above, sizes_above) {
        return Some(above / below);
    }
    small_crossing(ray, corners).unwrap_or_else(|| long_crossing(ray, corners))
}

/// The exact quotient, rounded to f64; the outer `None` where 128 bits do not suffice.
fn small_crossing(ray: &Ray, corners: &Corners) -> Option<Option<f64>> {
    let [a, b, c] = *corners;
    let (d, d_unit) = multiples(ray.direction)?;
    let (points, unit) = multiples::<12>([ray.origin, a, b, c].as_flattened().try_into().unwrap())?;
    let minus = |p: usize, q: usize| std::array::from_fn(|k| points[3 * p + k] - points[3 * q + k]);
    let below = small_determinant(d, minus(2, 1), minus(3, 1));
    let above = small_determinant(minus(1, 0), minus(2, 1), minus(3, 1));
    Some((below != 0).then(|| above as f64 / below as f64 * f64::from(unit - d_unit).exp2()))
}

/// The exact quotient, rounded to f64.
fn long_crossing(ray: &Ray, corners: &Corners) -> Option<f64> {
    let [a, b, c] = *corners;
    let (e1, e2) = (whole_difference(b, a), whole_difference(c, a));
    let below = exact_determinant(&ray.direction.map(whole), &e1, &e2);
    let above = exact_determinant(&whole_difference(a, ray.origin), &e1, &e2);
    let float = |x: &BigInt| -> f64 {
        // At most 3 · 278 bits: below what f64 can hold.
        let (sign, digits) = x.to_u64_digits();
        let size =
            digits.iter().rev().fold(0.0, |sum, &digit| sum * 18_446_744_073_709_551_616.0 + digit as f64);
        if sign == Sign::Minus { -size } else { size }
    };
    (below.sign() != Sign::NoSign).then(|| float(&above) / float(&below))
}

/// The steps of the oracle against its last one: whether sides agree exactly, and how far crossings are apart, relatively.
pub fn agrees_with_itself(ray: &Ray, corners: &Corners) -> Result<f64, String> {
    let [a, b, c] = *corners;
    for (p, q) in [(b, c), (c, a), (a, b)] {
        let expected = long_side(ray, p, q);
        let fine = fine_side(ray, p, q).unwrap_or(expected);
        if [side(ray, p, q), exact_side(ray, p, q), fine] != [expected; 3] {
            return Err(format!("side of {p:?} {q:?}"));
        }
    }
    let expected = long_crossing(ray, corners);
    let mut apart = 0.0f64;
    for found in small_crossing(ray, corners).into_iter().chain([crossing(ray, corners)]) {
        match (found, expected) {
            (None, None) => {}
            (Some(found), Some(expected)) if found == expected => {}
            (Some(found), Some(expected)) => apart = apart.max(((found - expected) / expected).abs()),
            _ => return Err(format!("{found:?} is not {expected:?}")),
        }
    }
    Ok(apart)
}

fn from_segment(p: Vector, q: Vector) -> f64 {
    let along = sub(q, p);
    let square = dot(along, along);
    let part = if square > 0.0 { (-dot(p, along) / square).clamp(0.0, 1.0) } else { 0.0 };
    length(std::array::from_fn(|k| p[k] + part * along[k]))
}

/// How far a point is from the triangle.
pub fn distance(point: Vector, corners: &Corners) -> f64 {
    let [a, b, c] = corners.map(|corner| sub(wide(corner), point));
    let outline = from_segment(a, b).min(from_segment(b, c)).min(from_segment(c, a));
    let normal = cross(sub(b, a), sub(c, a));
    let inside = [cross(a, b), cross(b, c), cross(c, a)].iter().all(|&side| dot(side, normal) >= 0.0);
    if inside { outline.min(dot(a, normal).abs() / length(normal)) } else { outline }
}

/// How far the ray's line passes from the triangle's outline.
pub fn from_outline(ray: &Ray, corners: &Corners) -> f64 {
    let (d, o) = (wide(ray.direction), wide(ray.origin));
    let square = dot(d, d);
    let seen = corners.map(|corner| {
        let p = sub(wide(corner), o);
        let part = dot(p, d) / square;
        std::array::from_fn(|k| p[k] - part * d[k])
    });
    (0..3).map(|k| from_segment(seen[k], seen[(k + 1) % 3])).fold(f64::INFINITY, f64::min)
}

/// Cosine of the angle between the ray and the triangle's normal.
pub fn cosine(ray: &Ray, corners: &Corners) -> f64 {
    let [a, b, c] = corners.map(wide);
    let (normal, d) = (cross(sub(b, a), sub(c, a)), wide(ray.direction));
    dot(normal, d).abs() / (length(normal) * length(d))
}

/// Bits by which a displacement stays below anything that matters: more than a determinant's terms have.
const DISPLACED: u32 = 700;

/// Axes in the order in which `slimkd` displaces a ray's start: along the first by a smallest amount, along the second by a still smaller one.
fn frame(ray: &Ray) -> [usize; 3] {
    let [x, y, z] = ray.direction.map(f32::abs);
    let longest = if x > y && x > z {
        0
    } else if x <= y && y > z {
        1
    } else {
        2
    };
    [(longest + 1) % 3, (longest + 2) % 3, longest]
}

/// Whether a ray that was really displaced crosses the triangle, and along which side of it: 1 along its turn, −1 against it, else 0. The range is
/// that of the ray itself.
pub fn displaced_crossing(ray: &Ray, corners: &Corners) -> i32 {
    let scaled = |p: [f32; 3]| p.map(|x| whole(x) << (2 * DISPLACED));
    let mut origin = scaled(ray.origin);
    let [x, y, _] = frame(ray);
    origin[x] += BigInt::from(1) << DISPLACED;
    origin[y] += 1;
    let seen = corners.map(|p| {
        let p = scaled(p);
        std::array::from_fn::<_, 3, _>(|k| &p[k] - &origin[k])
    });
    let direction = ray.direction.map(whole);
    let sign = |x: BigInt| match x.sign() {
        Sign::Plus => 1,
        Sign::NoSign => 0,
        Sign::Minus => -1,
    };
    let sides =
        [(1, 2), (2, 0), (0, 1)].map(|(p, q)| sign(exact_determinant(&direction, &seen[p], &seen[q])));
    if sides[0] == 0 || sides != [sides[0]; 3] {
        return 0;
    }
    // t = N / D with N = det(a − o, e1, e2), in units of the direction: 2⁻¹⁴⁹ of both ends of the range.
    let [a, b, c] = *corners;
    let (e1, e2) = (whole_difference(b, a), whole_difference(c, a));
    let below = exact_determinant(&direction, &e1, &e2);
    let above = exact_determinant(&whole_difference(a, ray.origin), &e1, &e2) << 149;
    let beyond = |t: f32| match t {
        f32::INFINITY => -1,
        f32::NEG_INFINITY => 1,
        t => sign(&above - whole(t) * &below) * sides[0],
    };
    if beyond(ray.t_min) >= 0 && beyond(ray.t_max) <= 0 { sides[0] } else { 0 }
}

/// Whether a point lies on the closed triangle.
pub fn lies_on(point: [f32; 3], corners: &Corners) -> bool {
    let [a, b, c] = *corners;
    let (e1, e2) = (whole_difference(b, a), whole_difference(c, a));
    if exact_determinant(&whole_difference(a, point), &e1, &e2).sign() != Sign::NoSign {
        return false;
    }
    // A ray from the point out of the plane, along some axis that is not in it, crosses the triangle there.
    (0..3).any(|axis| {
        let direction = std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 });
        crosses(&Ray::new(point, direction), corners)
    })
}
