//! Double-double arithmetic: about 2⁻¹⁰⁰ of error instead of 2⁻⁵³ (Dekker 1971; Hida, Li & Bailey 2001), and the exact sum and product of
//! two f64 that it is made of.

use std::ops::{Add, Mul, Sub};

/// An unevaluated sum of two f64, the second below half an ulp of the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Double(pub(super) f64, pub(super) f64);

impl Double {
    /// The exact difference.
    #[inline(always)]
    pub(super) fn difference(a: impl Into<f64>, b: impl Into<f64>) -> Self {
        two_sum(a.into(), -b.into())
    }

    pub(super) fn value(self) -> f64 {
        self.0 + self.1
    }
}

/// The exact sum.
#[inline(always)]
pub(super) fn two_sum(a: f64, b: f64) -> Double {
    let sum = a + b;
    let back = sum - a;
    Double(sum, (a - (sum - back)) + (b - back))
}

/// The exact product, short of overflow and underflow.
#[inline(always)]
pub(super) fn two_product(a: f64, b: f64) -> Double {
    // Veltkamp's split: exact without a fused multiply-add, which not every target has.
    let split = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let product = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    Double(product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = two_sum(self.0, other.0);
        let low = two_sum(self.1, other.1);
        let Double(high, rest) = two_sum(high.0, high.1 + low.0);
        two_sum(high, rest + low.1)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + Self(-other.0, -other.1)
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.0, other.0);
        two_sum(product.0, product.1 + (self.0 * other.1 + self.1 * other.0))
    }
}

/// Of the rows a, b, c.
pub(super) fn determinant(a: [Double; 3], b: [Double; 3], c: [Double; 3]) -> Double {
    let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
    a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)
}
