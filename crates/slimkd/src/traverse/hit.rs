//! What a query answers.

/// A ray-triangle intersection.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, Ray, TriangleMesh};
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let tree = KdTree::build(mesh, &BuildOptions::default())?;
/// let hit = tree.closest_hit(&Ray::new([0.25, 0.5, 3.0], [0.0, 0.0, -2.0])).unwrap();
/// assert_eq!((hit.t, hit.u, hit.v), (1.5, 0.25, 0.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
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
