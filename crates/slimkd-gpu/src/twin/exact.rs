//! `shaders/exact.wgsl` in Rust, where floats need no guarding.

/// A float's magnitude as mantissa · 2^exponent, the mantissa's bit 23 set.
fn magnitude(x: f32) -> (u32, i32) {
    let bits = x.to_bits() & 0x7fff_ffff;
    let (exponent, fraction) = (bits >> 23, bits & 0x7f_ffff);
    if exponent == 0 {
        let shift = fraction.leading_zeros() - 8;
        return (fraction << shift, 1 - shift as i32);
    }
    (fraction | 0x80_0000, exponent as i32)
}

/// |a·b| exactly, as something that orders.
fn product(a: f32, b: f32) -> (i32, u64) {
    let ((x, i), (y, j)) = (magnitude(a), magnitude(b));
    let product = u64::from(x) * u64::from(y);
    if product >> 47 == 0 { (i + j - 1, product << 1) } else { (i + j, product) }
}

fn sign_of_product(a: f32, b: f32) -> i32 {
    if a == 0.0 || b == 0.0 {
        0
    } else if a.is_sign_negative() != b.is_sign_negative() {
        -1
    } else {
        1
    }
}

/// Sign of a·b − c·d, exactly.
pub(super) fn sign_of_difference(a: f32, b: f32, c: f32, d: f32) -> i32 {
    let (left, right) = (sign_of_product(a, b), sign_of_product(c, d));
    if left != right {
        return (left - right).signum();
    }
    if left == 0 {
        return 0;
    }
    left * product(a, b).cmp(&product(c, d)) as i32
}

/// a / b to nearest; 0 below the normal numbers.
pub(super) fn divide(a: f32, b: f32) -> f32 {
    let quotient = a / b;
    if quotient.is_subnormal() { 0.0f32.copysign(quotient) } else { quotient.clamp(f32::MIN, f32::MAX) }
}

/// A sum of two floats, the first of which is their rounded sum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Double {
    pub(super) high: f32,
    low: f32,
}

fn two_sum(a: f32, b: f32) -> Double {
    let sum = a + b;
    let part = sum - a;
    Double { high: sum, low: (a - (sum - part)) + (b - part) }
}

fn upper_half(a: f32) -> f32 {
    let c = 4097.0 * a;
    c - (c - a)
}

pub(super) fn two_product(a: f32, b: f32) -> Double {
    let p = a * b;
    let (ah, bh) = (upper_half(a), upper_half(b));
    let (al, bl) = (a - ah, b - bh);
    Double { high: p, low: (((ah * bh - p) + ah * bl) + al * bh) + al * bl }
}

pub(super) fn add(a: Double, b: Double) -> Double {
    let s = two_sum(a.high, b.high);
    let t = two_sum(a.low, b.low);
    let u = two_sum(s.high, s.low + t.high);
    two_sum(u.high, u.low + t.low)
}

pub(super) fn minus(a: Double) -> Double {
    Double { high: -a.high, low: -a.low }
}

pub(super) fn times(a: Double, b: f32) -> Double {
    let p = two_product(a.high, b);
    two_sum(p.high, p.low + a.low * b)
}

pub(super) fn quotient(a: Double, b: Double) -> f32 {
    let q = a.high / b.high;
    let rest = add(a, minus(times(b, q)));
    q + rest.high / b.high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_exact_where_rounded_products_are_equal() {
        let up = |x: f32| x.next_up();
        // (1 + e)(1 − e) < 1 and both round to 1.
        assert_eq!(sign_of_difference(1.0 + 1e-4, 1.0 - 1e-4, 1.0, 1.0), -1);
        assert_eq!(sign_of_difference(up(3.0), 7.0, 7.0, up(3.0)), 0);
        assert_eq!(sign_of_difference(-up(3.0), 7.0, -7.0, 3.0), -1);
        assert_eq!(sign_of_difference(1e-30, 1e-30, 1e-30, up(1e-30)), -1);
        assert_eq!(sign_of_difference(0.0, 5.0, -1.0, 1e-40), 1);
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..100_000 {
            let mut any = || {
                f32::from_bits(random.u32(0x3f00_0000..0x4100_0000))
                    * random.f32().mul_add(2.0, -1.0).signum()
            };
            let [a, b, c, d] = [any(), any(), any(), any()];
            let exact = f64::from(a) * f64::from(b) - f64::from(c) * f64::from(d);
            let sign = if exact == 0.0 { 0 } else { exact.signum() as i32 };
            assert_eq!(sign_of_difference(a, b, c, d), sign, "{a} {b} {c} {d}");
        }
    }
}
