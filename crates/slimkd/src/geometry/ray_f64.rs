//! Rays and hits in f64, in world coordinates.

use super::Hit;

/// A ray in f64 and in world coordinates: `origin + t · direction` for t in `[t_min, t_max]`. The verbs that end in `_f64` take it.
///
/// The mesh's [origin](crate::TriangleMesh::origin) is subtracted from the ray's, which is exact but for a rounding of 2⁻⁵³ of the larger one;
/// from there on everything is decided exactly. So a ray that starts a tenth of a millimetre beside a wall is on that side of it, five million
/// metres from the world's origin.
///
/// `t` counts in units of `direction`, which may have any length from 2⁻¹⁰⁰⁰ to 2¹⁰⁰⁰. A ray with a NaN, an infinite origin or
/// direction, a zero direction, or `t_min > t_max` is invalid and misses everything; so does one that starts farther than `f32::MAX`
/// from the mesh's origin. Of a direction and a range, what is below 2⁻³⁰⁰ of the direction's length counts as 0.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, RayF64, Tracer, TriangleMesh};
/// let origin = [528_980.0, 183_524.0, 0.0];
/// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = TriangleMesh::new(corners, vec![[0, 1, 2]])?.with_origin(origin);
/// let tree = KdTree::build(mesh, &BuildOptions::default())?;
/// let ray = RayF64::new([528_980.25, 183_524.5, 3.0], [0.0, 0.0, -1.0]);
/// let hit = tree.closest_f64(&ray).unwrap();
/// assert_eq!((hit.t, hit.u, hit.v), (3.0, 0.25, 0.5));
/// assert_eq!(tree.refine_f64(&ray, hit.triangle).unwrap().point, [528_980.25, 183_524.5, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RayF64 {
    /// Where the ray starts, world coordinates in scene units.
    pub origin: [f64; 3],
    /// The smallest `t` that counts as a hit (inclusive), in units of the direction. It may be negative.
    pub t_min: f64,
    /// Where the ray goes; any length but 0.
    pub direction: [f64; 3],
    /// The largest `t` that counts as a hit (inclusive), in units of the direction. It may be infinite.
    pub t_max: f64,
}

impl RayF64 {
    /// A ray over `[0, ∞]`.
    pub fn new(origin: impl Into<[f64; 3]>, direction: impl Into<[f64; 3]>) -> Self {
        Self { origin: origin.into(), direction: direction.into(), t_min: 0.0, t_max: f64::INFINITY }
    }

    /// This ray with another range: hits count where `t_min ≤ t ≤ t_max`.
    #[must_use]
    pub fn with_range(mut self, t_min: f64, t_max: f64) -> Self {
        self.t_min = t_min;
        self.t_max = t_max;
        self
    }

    /// The point at `t`.
    pub fn at(&self, t: f64) -> [f64; 3] {
        std::array::from_fn(|k| self.origin[k] + t * self.direction[k])
    }
}

/// A hit of a [`RayF64`]. Each number is off by less than 2⁻⁵⁰ of itself; which triangles are hit, edges and vertices included, is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HitF64 {
    /// Distance along the ray in units of its direction.
    pub t: f64,
    /// The barycentric weight of the triangle's vertex 1; vertex 0 has the weight `1 − u − v`.
    pub u: f64,
    /// The barycentric weight of the triangle's vertex 2.
    pub v: f64,
    /// The triangle's id: its position in the mesh.
    pub triangle: u32,
}

impl From<HitF64> for Hit {
    /// Rounded to f32.
    fn from(hit: HitF64) -> Self {
        Self { t: hit.t as f32, u: hit.u as f32, v: hit.v as f32, triangle: hit.triangle }
    }
}
