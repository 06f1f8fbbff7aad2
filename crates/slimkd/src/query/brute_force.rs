//! The oracle: every query by testing every triangle.

use super::{Walk, tracer};
use crate::geometry::{Aabb, Ray, TriangleMesh};
use crate::layout::Planes;
use crate::traverse::{ExactQuery, PreparedRay, Search, Sink};

/// Answers queries without a tree, in O(triangles). Every tree must give the answers that this gives, to the last bit.
///
/// ```
/// use slimkd::{BruteForce, BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let ray = Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]);
/// let oracle = BruteForce::new(&mesh);
/// assert_eq!(oracle.closest(&ray), KdTree::build(mesh.clone(), &BuildOptions::default())?.closest(&ray));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct BruteForce<'a> {
    mesh: &'a TriangleMesh,
    triangles: Vec<u32>,
    bounds: Aabb,
}

impl<'a> BruteForce<'a> {
    /// Collects the triangles of `mesh` that can be hit.
    pub fn new(mesh: &'a TriangleMesh) -> Self {
        let (triangles, bounds) = mesh.valid_triangles();
        Self { mesh, triangles, bounds }
    }

    fn offer_along<const Z: usize>(&self, ray: &PreparedRay, sink: &mut impl Sink) {
        for &id in &self.triangles {
            if sink.knows(id) {
                continue;
            }
            let found = ray.shear.intersect::<Z>(&self.mesh.corners(id));
            if ray.hand_over(found, id, sink) {
                return;
            }
        }
    }
}

tracer!(BruteForce<'_>);

impl Walk for BruteForce<'_> {
    fn extent(&self) -> Aabb {
        self.bounds
    }

    fn place(&self) -> [f64; 3] {
        self.mesh.origin()
    }

    fn triangle(&self, id: u32) -> Option<[[f32; 3]; 3]> {
        ((id as usize) < self.mesh.len()).then(|| self.mesh.corners(id))
    }

    fn walk(&self, ray: &Ray, sink: &mut impl Sink) {
        let Some(prepared) = PreparedRay::new(ray, &self.bounds, &Planes::WORLD) else { return };
        match prepared.shear.axes[2] {
            0 => self.offer_along::<0>(&prepared, sink),
            1 => self.offer_along::<1>(&prepared, sink),
            _ => self.offer_along::<2>(&prepared, sink),
        }
    }

    fn walk_exact(&self, query: &mut ExactQuery<'_>) {
        for &id in &self.triangles {
            if query.decide(&self.mesh.corners(id), id) == Some(true) {
                return;
            }
        }
    }

    fn search(&self, search: &mut Search<'_>) {
        self.triangles.iter().for_each(|&id| search.offer(&self.mesh.corners(id), id));
    }
}
