//! What a ray really crosses: exact, by integers of any length where f64 cannot tell; and distances in f64.
#![allow(unreachable_pub)]

use num_bigint::{BigInt, Sign};
use slimkd::Ray;

pub type Corners = [[f32; 3]; 3];
type Vector = [f64; 3];

/// Relative error of a 3 × 3 determinant in f64, generously: a dozen roundings of 2⁻⁵³ each.
const FILTER: f64 = 1e-14;

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

/// Sign of det(direction, b − origin, c − origin).
fn side(ray: &Ray, b: [f32; 3], c: [f32; 3]) -> i32 {
    let (d, o) = (wide(ray.direction), wide(ray.origin));
    let (p, q) = (sub(wide(b), o), sub(wide(c), o));
    let (mut sum, mut sizes) = (0.0, 0.0);
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (left, right) = (p[i] * q[j], p[j] * q[i]);
        sum += d[k] * (left - right);
        sizes += d[k].abs() * (left.abs() + right.abs());
    }
    if sum.abs() > FILTER * sizes && sizes > 1e-280 {
        return if sum > 0.0 { 1 } else { -1 };
    }
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
    let sides = [side(ray, b, c), side(ray, c, a), side(ray, a, b)];
    (sides.iter().all(|&s| s >= 0) || sides.iter().all(|&s| s <= 0)) && sides != [0; 3]
}

/// Where the line crosses the triangle's plane: the exact quotient, rounded to f64.
pub fn crossing(ray: &Ray, corners: &Corners) -> Option<f64> {
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
