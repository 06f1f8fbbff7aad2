//! Sums and products of f64 without any rounding.
//!
//! Source: Shewchuk, *Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates*, 1997, §2.
//!
//! Deviation: an expansion grows term by term and products are expanded into such terms. That is slower than his sums of
//! expansions, and rarely needed: only where f64 cannot tell a sign.
//!
//! Everything is exact as long as no term leaves the range of f64: no product above 2⁹⁰⁰, and none with a bit below 2⁻¹⁰⁷⁴.

use super::double::{Double, two_product, two_sum};

/// A number as the exact sum of f64 that do not overlap, the smallest first and none of them 0.
#[derive(Clone, Debug, Default)]
pub(super) struct Expansion {
    parts: Vec<f64>,
}

impl Expansion {
    /// Adds a number (Shewchuk's `GROW-EXPANSION`, with zeros left out).
    pub(super) fn add(&mut self, number: f64) {
        let mut sum = number;
        self.parts.retain_mut(|part| {
            let Double(next, rest) = two_sum(sum, *part);
            (sum, *part) = (next, rest);
            rest != 0.0
        });
        if sum != 0.0 {
            self.parts.push(sum);
        }
    }

    /// Adds the product of all factors.
    fn add_product<const N: usize>(&mut self, factors: [f64; N]) {
        if factors.contains(&0.0) {
            return;
        }
        // Each factor at most doubles the number of terms.
        let (mut terms, mut count) = ([0.0; 8], 1);
        terms[0] = factors[0];
        for factor in &factors[1..] {
            for at in 0..count {
                let Double(high, low) = two_product(terms[at], *factor);
                (terms[at], terms[count + at]) = (low, high);
            }
            count *= 2;
        }
        for term in &terms[..count] {
            if *term != 0.0 {
                self.add(*term);
            }
        }
    }

    /// Adds `factor` times the determinant of the rows a, b, c.
    pub(super) fn add_determinant(&mut self, factor: f64, a: [Double; 3], b: [Double; 3], c: [Double; 3]) {
        let parts = |x: Double| [x.0, x.1];
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            for x in parts(a[k]) {
                for (y, z, sign) in [(b[i], c[j], factor), (b[j], c[i], -factor)] {
                    for y in parts(y) {
                        for z in parts(z) {
                            // A factor of 1 would only add zeros.
                            if sign.abs() == 1.0 {
                                self.add_product([sign * x, y, z]);
                            } else {
                                self.add_product([x, y, z, sign]);
                            }
                        }
                    }
                }
            }
        }
    }

    /// Adds `a·d − b·c`.
    pub(super) fn add_minor(&mut self, [a, b]: [f64; 2], [c, d]: [Double; 2]) {
        for (factor, number) in [(a, d), (-b, c)] {
            self.add_product([factor, number.0]);
            self.add_product([factor, number.1]);
        }
    }

    /// −1, 0 or 1. The last part is larger than the sum of all others.
    pub(super) fn sign(&self) -> i8 {
        self.parts.last().map_or(0, |&last| if last > 0.0 { 1 } else { -1 })
    }

    /// The number, rounded to f64 with an error below two units in the last place.
    pub(super) fn value(&self) -> f64 {
        self.parts.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost() {
        let mut sum = Expansion::default();
        let numbers = [1e300, 1e-300, -1e300, 3.0, 1e17, -1e17, -3.0];
        numbers.iter().for_each(|&x| sum.add(x));
        assert_eq!((sum.sign(), sum.value()), (1, 1e-300));
        sum.add(-1e-300);
        assert_eq!((sum.sign(), sum.value()), (0, 0.0));
    }

    #[test]
    fn products_are_exact() {
        // (1 + e)(1 − e) − 1 = −e², far below what f64 keeps of the product.
        let e = f64::EPSILON;
        let mut sum = Expansion::default();
        sum.add_product([1.0 + e, 1.0 - e, 3.0]);
        sum.add(-3.0);
        assert_eq!(sum.value(), -3.0 * e * e);
        let whole = |x: f64| Double(x, 0.0);
        let mut flat = Expansion::default();
        let row = [0.1, 0.2, 0.3].map(whole);
        flat.add_determinant(1.0, row, [7.0, 1e9, -3.0].map(whole), row);
        flat.add_determinant(1e-3, row, row, [7.0, 1e9, -3.0].map(whole));
        assert_eq!(flat.sign(), 0);
    }
}
