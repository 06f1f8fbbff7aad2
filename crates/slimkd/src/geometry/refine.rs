//! t, u, v of a hit in f64, from the mesh's own coordinates.
//!
//! Determinants in double-double arithmetic (Dekker 1971; Hida, Li & Bailey 2001): about 2⁻¹⁰⁰ of the sum of their
//! terms' sizes, so cancellation eats into f64 only where a triangle is seen at an angle below 10⁻¹⁴.

use super::{Ray, TriangleMesh};
use std::ops::{Add, Mul, Sub};

/// A crossing of a ray with a triangle's plane, unrounded to f32.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefinedHit {
    /// Distance along the ray in units of its direction.
    pub t: f64,
    /// Barycentric weight of vertex 1; may leave [0, 1] by the rounding of the test that found the hit.
    pub u: f64,
    /// Barycentric weight of vertex 2; the same holds.
    pub v: f64,
}

/// An unevaluated sum of two f64, the second below half an ulp of the first.
#[derive(Clone, Copy, Debug)]
struct Double(f64, f64);

impl Double {
    /// The exact difference of two f32.
    fn difference(a: f32, b: f32) -> Self {
        two_sum(a.into(), -f64::from(b))
    }

    fn value(self) -> f64 {
        self.0 + self.1
    }
}

fn two_sum(a: f64, b: f64) -> Double {
    let sum = a + b;
    let back = sum - a;
    Double(sum, (a - (sum - back)) + (b - back))
}

fn two_product(a: f64, b: f64) -> Double {
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

fn determinant(a: [Double; 3], b: [Double; 3], c: [Double; 3]) -> Double {
    let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
    a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)
}

impl TriangleMesh {
    /// Where `ray` crosses the plane of `triangle`, in f64: for those who need more of a hit than the f32 of a
    /// [`Hit`](crate::Hit). `None` where the ray runs within the plane, or numbers leave the range of f64.
    ///
    /// ```
    /// use slimkd::{BuildOptions, KdTree, Ray, TriangleMesh};
    /// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let tree = KdTree::build(mesh, &BuildOptions::default())?;
    /// let ray = Ray::new([0.1, 0.2, 1.0], [0.0, 0.0, -3.0]);
    /// let hit = tree.closest_hit(&ray).unwrap();
    /// let refined = tree.mesh().refine(&ray, hit.triangle).unwrap();
    /// assert_eq!(refined.t, 1.0 / 3.0);
    /// assert_eq!(refined.u, f64::from(0.1f32));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// When `triangle` is not below [`TriangleMesh::len`].
    pub fn refine(&self, ray: &Ray, triangle: u32) -> Option<RefinedHit> {
        let [a, b, c] = self.corners(triangle);
        let minus = |p: [f32; 3], q: [f32; 3]| std::array::from_fn(|k| Double::difference(p[k], q[k]));
        let (e1, e2, to_corner) = (minus(b, a), minus(c, a), minus(a, ray.origin));
        let direction = ray.direction.map(|x| Double(x.into(), 0.0));
        let whole = determinant(direction, e1, e2).value();
        let part = |determinant: Double| determinant.value() / whole;
        let found = RefinedHit {
            t: part(determinant(to_corner, e1, e2)),
            u: part(determinant(direction, e2, to_corner)),
            v: part(determinant(direction, to_corner, e1)),
        };
        [found.t, found.u, found.v].iter().all(|x| x.is_finite()).then_some(found)
    }
}
