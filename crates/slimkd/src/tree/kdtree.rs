//! The tree that users hold: its fields, how it is built, and what it reports about itself.

use super::statistics::TreeStatistics;
use super::{MemoryReport, pipeline, walk};
use crate::geometry::{Aabb, Hit, Ray, TriangleMesh};
use crate::job::Progress;
use crate::layout::{Encoded, EncodedTree, View};
use crate::options::{BuildError, BuildOptions};
use crate::query::Walk;
use crate::traverse::{Costed, RayCost};
use std::fmt;
use std::sync::Arc;

/// An SAH kd-tree over a mesh that it shares by [`Arc`]. It is immutable and `Send + Sync`: trace from any number of threads.
///
/// Queries are in the trait [`Tracer`](crate::Tracer).
///
/// ```
/// use slimkd::{BuildOptions, KdTree, Preset, Ray, Tracer, TriangleMesh};
/// use std::sync::Arc;
/// let mesh = Arc::new(TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?);
/// let tree = KdTree::build(Arc::clone(&mesh), &BuildOptions::from(Preset::Standard))?;
/// std::thread::scope(|scope| {
///     for x in [0.1, 0.4] {
///         let tree = &tree;
///         scope.spawn(move || assert!(tree.any(&Ray::new([x, 0.2, 1.0], [0.0, 0.0, -1.0]))));
///     }
/// });
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct KdTree {
    pub(crate) mesh: Arc<TriangleMesh>,
    pub(crate) options: BuildOptions,
    pub(crate) bounds: Aabb,
    pub(crate) encoded: Encoded,
    /// Depth of the deepest leaf; sizes the traversal stack.
    pub(crate) depth: u32,
    /// The number of degenerate triangles in the mesh.
    pub(crate) degenerate: u64,
}

impl KdTree {
    /// Builds a tree. Pass a mesh, or an `Arc` of one to keep sharing it. An empty mesh builds, and every ray misses it.
    ///
    /// # Errors
    /// - [`BuildError::InvalidOption`] for constants that are not positive and finite, [`BuildError::InvalidThreshold`] for thresholds
    ///   of [`BuildOptions::hoisting`] that are not between 0 and 1.
    /// - [`BuildError::TooLarge`] when the layout cannot address the tree, [`BuildError::TreeTooLarge`] when no tree fits
    ///   [`BuildOptions::max_tree`].
    /// - [`BuildError::BuildTooLarge`] when the build needs more than [`BuildOptions::max_build_bytes`],
    ///   [`BuildError::OutOfMemory`] when the machine has no memory left.
    /// - [`BuildError::Threads`] when the threads of [`BuildOptions::threads`] cannot be started.
    pub fn build(mesh: impl Into<Arc<TriangleMesh>>, options: &BuildOptions) -> Result<Self, BuildError> {
        Self::build_with_progress(mesh, options, &Progress::new())
    }

    /// Builds a tree as [`KdTree::build`] does, and reports to `progress`, which another thread can watch and cancel.
    ///
    /// # Errors
    /// Those of [`KdTree::build`], and [`BuildError::Cancelled`] soon after [`Progress::cancel`]: within 36 ms in measurements on
    /// 7.4 million triangles.
    pub fn build_with_progress(
        mesh: impl Into<Arc<TriangleMesh>>,
        options: &BuildOptions,
        progress: &Progress,
    ) -> Result<Self, BuildError> {
        pipeline::build(mesh.into(), options, progress)
    }

    /// The mesh that the tree was built over.
    pub fn mesh(&self) -> &Arc<TriangleMesh> {
        &self.mesh
    }

    /// The options that it was built with. `threads`, `max_tree` and `max_build_bytes` are always `None`, as a tree does not depend on
    /// them except through `byte_weight`, which holds the weight that `max_tree` led to.
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }

    /// The tree's size, exact to the byte.
    pub fn memory(&self) -> MemoryReport {
        MemoryReport::of(self)
    }

    /// The tree's shape in numbers. This walks the whole tree: O(nodes + references).
    pub fn statistics(&self) -> TreeStatistics {
        walk::statistics(self)
    }

    /// The number of references to each triangle of the mesh, in leaves and as T-references; 0 for degenerate triangles.
    pub fn references_per_triangle(&self) -> Vec<u32> {
        let mut counts = vec![0; self.mesh.len()];
        walk::for_each_reference(self, |id| counts[id as usize] += 1);
        counts
    }

    /// The closest hit, with the numbers of nodes and triangles that were visited to find it; these are the same on every machine.
    /// This is slower than [`Tracer::closest`](crate::Tracer::closest) and gives the same hit. An invalid ray visits nothing.
    pub fn cost(&self, ray: &Ray) -> (Option<Hit>, RayCost) {
        let mut sink = Costed::new(ray.t_max);
        self.walk(ray, &mut sink);
        sink.into_parts()
    }

    /// The tree's bytes, for kernels outside this crate, on a GPU for example.
    pub fn encoded(&self) -> EncodedTree<'_> {
        self.encoded.as_tree()
    }

    /// The depth of the deepest leaf; the root has depth 0.
    pub fn depth(&self) -> u32 {
        self.depth
    }

    pub(crate) fn view(&self) -> View<'_> {
        View::new(&self.encoded, &self.mesh)
    }
}

impl fmt::Debug for KdTree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KdTree")
            .field("preset", &self.options.preset)
            .field("mesh", &self.mesh)
            .field("bounds", &self.bounds)
            .field("depth", &self.depth)
            .finish_non_exhaustive()
    }
}
