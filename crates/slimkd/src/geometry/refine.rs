//! A hit in f64: t, u, v, point and normal, from the triangle's own corners.
//!
//! Determinants are computed in double-double arithmetic (Dekker 1971; Hida, Li & Bailey 2001). Their error is about 2⁻¹⁰⁰ of the sum
//! of their terms' sizes, so cancellation costs digits of the f64 result only where a triangle is seen at an angle below 10⁻¹⁴.

use super::double::{Double, determinant};
use super::{Ray, RayF64};

/// A hit in f64, as [`Tracer::refine`](crate::Tracer::refine) computes it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RefinedHit {
    /// The distance along the ray in units of its direction.
    pub t: f64,
    /// The barycentric weight of vertex 1. It may lie outside [0, 1] by the rounding of the test that found the hit.
    pub u: f64,
    /// The barycentric weight of vertex 2. It may lie outside [0, 1] by the rounding of the test that found the hit.
    pub v: f64,
    /// The point on the triangle in scene units, computed from its corners and their weights. It lies in the triangle's plane up to
    /// the rounding of f64.
    pub point: [f64; 3],
    /// The triangle's unit normal: the direction of `(b − a) × (c − a)` for its corners a, b, c in the mesh's order. It does not turn
    /// towards the ray; see `front`.
    pub normal: [f64; 3],
    /// Whether the ray meets the side from which the corners run counter-clockwise, so that it goes against the normal.
    pub front: bool,
}

impl RefinedHit {
    /// Where `ray` crosses the plane of a triangle. `None` where the ray runs within the plane, or numbers leave the range of f64.
    ///
    /// ```
    /// use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
    /// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let tree = KdTree::build(mesh, &BuildOptions::default())?;
    /// let ray = Ray::new([0.1, 0.2, 1.0], [0.0, 0.0, -3.0]);
    /// let hit = tree.closest(&ray).unwrap();
    /// let refined = tree.refine(&ray, hit.triangle).unwrap();
    /// assert_eq!((refined.t, refined.u), (1.0 / 3.0, f64::from(0.1f32)));
    /// assert_eq!((refined.normal, refined.front), ([0.0, 0.0, 1.0], true));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(ray: &Ray, corners: &[[f32; 3]; 3]) -> Option<Self> {
        Self::of(ray.origin.map(f64::from), ray.direction.map(f64::from), corners)
    }

    /// The same for a ray in world coordinates, for a mesh that has its `origin` there; so is the point.
    pub(crate) fn in_world(ray: &RayF64, origin: [f64; 3], corners: &[[f32; 3]; 3]) -> Option<Self> {
        let start = std::array::from_fn(|k| ray.origin[k] - origin[k]);
        let found = Self::of(start, ray.direction, corners)?;
        Some(Self { point: std::array::from_fn(|k| origin[k] + found.point[k]), ..found })
    }

    fn of(origin: [f64; 3], direction: [f64; 3], corners: &[[f32; 3]; 3]) -> Option<Self> {
        let [a, b, c] = *corners;
        let minus = |p: [f32; 3], q: [f32; 3]| std::array::from_fn(|k| Double::difference(p[k], q[k]));
        let (e1, e2): ([Double; 3], [Double; 3]) = (minus(b, a), minus(c, a));
        let to_corner = std::array::from_fn(|k| Double::difference(a[k], origin[k]));
        let direction = direction.map(|x| Double(x, 0.0));
        let whole = determinant(direction, e1, e2).value();
        let part = |determinant: Double| determinant.value() / whole;
        let t = part(determinant(to_corner, e1, e2));
        let u = part(determinant(direction, e2, to_corner));
        let v = part(determinant(direction, to_corner, e1));
        let point = [0, 1, 2].map(|k| f64::from(a[k]) + (u * e1[k].value() + v * e2[k].value()));
        let minor = |i: usize, j: usize| (e1[i] * e2[j] - e1[j] * e2[i]).value();
        let cross = [minor(1, 2), minor(2, 0), minor(0, 1)];
        // Scaled first, so that squares of very long or very short edges stay in range.
        let largest = cross.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let scaled = cross.map(|x| x / largest);
        let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
        let normal = scaled.map(|x| x / length);
        // The determinant of (direction, e1, e2) is the direction times the cross product.
        let found = Self { t, u, v, point, normal, front: whole < 0.0 };
        let numbers = [t, u, v].into_iter().chain(point).chain(normal);
        numbers.into_iter().all(f64::is_finite).then_some(found)
    }
}
