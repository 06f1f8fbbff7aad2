//! What a query answers.

/// A ray-triangle intersection.
///
/// Its normal, and `t` and the point in f64, come from [`Tracer::refine`](crate::Tracer::refine); values of attributes at the hit from
/// [`Hit::interpolate`].
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
    /// The barycentric weight of the triangle's vertex 1; vertex 0 has the weight `1 − u − v`.
    pub u: f32,
    /// The barycentric weight of the triangle's vertex 2.
    pub v: f32,
    /// The triangle's id: its position in the mesh.
    pub triangle: u32,
}

impl Hit {
    /// The value at the hit of an attribute that is given at the triangle's three vertices, in the triangle's order: a normal, a
    /// colour, a texture coordinate. An interpolated normal is not of unit length.
    ///
    /// The vertices of the triangle come from [`TriangleMesh::triangles`](crate::TriangleMesh::triangles), or from
    /// [`OpenTree::triangle`](crate::OpenTree::triangle) where there is no mesh. Scenes of the crate `slimkd-scene` give the three
    /// values by `Attribute::corners`.
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

    /// The point of the hit in scene units, computed in f64 from the triangle's corners and the f32 weights `u` and `v`. Because these
    /// are rounded, it may lie a little beside the ray; the point of [`Tracer::refine`](crate::Tracer::refine) is more exact.
    pub fn point(&self, corners: &[[f32; 3]; 3]) -> [f64; 3] {
        let [a, b, c] = corners.map(|corner| corner.map(f64::from));
        let (u, v) = (f64::from(self.u), f64::from(self.v));
        std::array::from_fn(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]))
    }
}
