//! What a query answers.

/// A ray-triangle intersection.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let tree = KdTree::build(mesh, &BuildOptions::default())?;
/// let hit = tree.closest(&Ray::new([0.25, 0.5, 3.0], [0.0, 0.0, -2.0])).unwrap();
/// assert_eq!((hit.t, hit.u, hit.v), (1.5, 0.25, 0.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Hit {
    /// Distance along the ray in units of its direction, rounded once from f64.
    pub t: f32,
    /// Barycentric weight of vertex 1.
    pub u: f32,
    /// Barycentric weight of vertex 2.
    pub v: f32,
    /// The triangle's position in the input.
    pub triangle: u32,
}

impl Hit {
    /// The value at the hit of an attribute that is given at the triangle's three vertices: a normal, a colour, a texture coordinate.
    /// An interpolated normal is not of unit length.
    ///
    /// ```
    /// use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
    /// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let heat = [[10.0], [20.0], [30.0]]; // of each vertex
    /// let tree = KdTree::build(mesh, &BuildOptions::default())?;
    /// let hit = tree.closest(&Ray::new([0.25, 0.5, 3.0], [0.0, 0.0, -1.0])).unwrap();
    /// let corners = tree.mesh().triangles()[hit.triangle as usize];
    /// assert_eq!(hit.interpolate(corners.map(|vertex| heat[vertex as usize])), [22.5]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn interpolate<const N: usize>(&self, [a, b, c]: [[f32; N]; 3]) -> [f32; N] {
        let w = 1.0 - self.u - self.v;
        std::array::from_fn(|k| w * a[k] + self.u * b[k] + self.v * c[k])
    }

    /// The point of the hit, scene units, from the triangle's corners in f64. It lies within the rounding of `u` and `v` of the
    /// ray; [`Tracer::refine`](crate::Tracer::refine) is more exact.
    pub fn point(&self, corners: &[[f32; 3]; 3]) -> [f64; 3] {
        let [a, b, c] = corners.map(|corner| corner.map(f64::from));
        let (u, v) = (f64::from(self.u), f64::from(self.v));
        std::array::from_fn(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]))
    }
}
