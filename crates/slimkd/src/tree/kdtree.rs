//! The tree that users hold.

use super::statistics::TreeStatistics;
use super::{Encoded, LaneNodes, MemoryReport, Nodes, dense, plain, walk, with_nodes};
use crate::build::{Bound, BuildError, BuildOptions, Builder, Layout, Pace, Plan, Progress};
use crate::geometry::{Aabb, Ray, TriangleMesh};
use crate::reduce::{fit, hoist, prune};
use crate::traverse::{
    All, Any, AnyHits, Closest, ClosestHits, Hit, InstructionSet, PreparedRay, Sink, Stream, Traced,
    finish_strays, sort_hits, traverse,
};
use std::sync::Arc;

/// Triangles from which on one more thread pays: measured on three built-in scenes of 2,500 to 64,000 triangles, where two
/// threads are as fast as one up to 4,000, and 1.4 to 1.7 times as fast from 8,000 on.
const TRIANGLES_A_THREAD: usize = 2048;
/// Passes over a tree's nodes that move the progress, about: of pruning, for one weight or some; and of encoding with the walk
/// behind it.
const LOOPS_OF_PRUNING: usize = 8;
const LOOPS_OF_ENCODING: usize = 3;
/// Batches below this go ray by ray: a stream is not worth setting up.
const LEAST_STREAM: usize = 16;

/// An SAH kd-tree over a mesh that it shares by [`Arc`]. Immutable, `Send + Sync`: trace from any number of threads.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, Preset, Ray, TriangleMesh};
/// use std::sync::Arc;
/// let mesh = Arc::new(TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?);
/// let tree = KdTree::build(Arc::clone(&mesh), &BuildOptions::from(Preset::Standard))?;
/// std::thread::scope(|scope| {
///     for x in [0.1, 0.4] {
///         scope.spawn(|| ());
///         assert!(tree.any_hit(&Ray::new([x, 0.2, 1.0], [0.0, 0.0, -1.0])));
///     }
/// });
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct KdTree {
    pub(super) mesh: Arc<TriangleMesh>,
    pub(super) options: BuildOptions,
    pub(super) bounds: Aabb,
    pub(super) encoded: Encoded,
    /// Depth of the deepest leaf; sizes the traversal stack.
    pub(super) depth: u32,
    pub(super) degenerate: u64,
    /// What batches are traced with; available.
    pub(super) instruction_set: InstructionSet,
}

impl KdTree {
    /// Builds a tree. Pass a mesh, or an `Arc` of one to keep sharing it. An empty mesh builds, and every ray misses.
    ///
    /// # Errors
    /// [`BuildError::TooLarge`] when a layout's field cannot address the tree, [`BuildError::InvalidOption`] for
    /// constants that are not positive and finite, [`BuildError::OutOfMemory`], and [`BuildError::BuildTooLarge`] where
    /// [`BuildOptions::max_build_bytes`] does not suffice.
    pub fn build(mesh: impl Into<Arc<TriangleMesh>>, options: &BuildOptions) -> Result<Self, BuildError> {
        Self::build_with_progress(mesh, options, &Progress::new())
    }

    /// The same, watched and cancellable from another thread.
    ///
    /// # Errors
    /// As [`KdTree::build`], and [`BuildError::Cancelled`] soon after the call: 36 ms at most where it was measured, on 7.4 million triangles.
    pub fn build_with_progress(
        mesh: impl Into<Arc<TriangleMesh>>,
        options: &BuildOptions,
        progress: &Progress,
    ) -> Result<Self, BuildError> {
        let mesh = mesh.into();
        options.validate()?;
        match options.threads {
            None => Self::build_here(mesh, options, progress),
            Some(threads) => rayon::ThreadPoolBuilder::new()
                .num_threads(threads.get().min(mesh.len() / TRIANGLES_A_THREAD).max(1))
                .build()
                .map_err(|error| BuildError::Threads(error.to_string()))?
                .install(|| Self::build_here(mesh, options, progress)),
        }
    }

    fn build_here(
        mesh: Arc<TriangleMesh>,
        options: &BuildOptions,
        progress: &Progress,
    ) -> Result<Self, BuildError> {
        let pace = Pace::of(options, mesh.len(), rayon::current_num_threads());
        progress.begin(pace.scan);
        let none_left = BuildError::OutOfMemory { bytes: 4 * mesh.len() as u64 };
        let valid = mesh.valid_triangles_until(|| progress.is_cancelled());
        progress.check()?;
        let (triangles, bounds) = valid.ok_or(none_left)?;
        let degenerate = (mesh.len() - triangles.len()) as u64;
        let (layout, budget) = (options.layout, options.max_tree.map(|most| most.bytes(mesh.len())));
        let encode = |plan: &Plan| encode(plan, &bounds, mesh.len(), layout, progress);
        let encoded = |plan: &Plan| Ok(encode(plan)?.bytes());
        let bound = budget.map(|bytes| Bound { bytes, encoded: &encoded });
        let builder = Builder::new(&mesh, options, progress)?.within(bound);
        let plan = builder.build(&triangles, bounds, &pace)?;
        drop(triangles);
        progress.begin(pace.hoist);
        let plan = hoist(plan, bounds, &builder, options, pace.hoist)?;
        let nodes = plan.nodes.len();
        progress.begin_loops(pace.prune, LOOPS_OF_PRUNING * nodes);
        builder.memory.take(plan.bytes())?; // no layout takes more
        let mut tree_options =
            BuildOptions { threads: None, max_tree: None, max_build_bytes: None, ..options.clone() };
        let encoded = match budget {
            None => {
                let plan = prune(plan, bounds, options, &builder)?;
                progress.begin_loops(pace.encode, LOOPS_OF_ENCODING * plan.nodes.len());
                encode(&plan)?
            }
            Some(most) => {
                let sized = |plan: &Plan| {
                    let encoded = encode(plan)?;
                    let bytes = encoded.bytes();
                    Ok((encoded, bytes))
                };
                let (encoded, weight) = fit(&plan, bounds, &builder, options, most, sized)?;
                tree_options.collapse = true;
                tree_options.byte_weight = weight;
                progress.begin_loops(pace.encode, nodes);
                encoded
            }
        };
        drop(builder);
        let instruction_set = InstructionSet::best();
        let options = tree_options;
        let mut tree = Self { mesh, options, bounds, encoded, depth: 0, degenerate, instruction_set };
        tree.depth = walk::max_depth(&tree, progress)?;
        progress.finish();
        Ok(tree)
    }

    /// Offers every triangle that the ray may hit to `sink`, nearer voxels first. An invalid ray offers nothing.
    pub(super) fn offer_all(&self, ray: &Ray, sink: &mut impl Sink) {
        with_nodes!(self, nodes => {
            if let Some(prepared) = PreparedRay::new(ray, &self.bounds, &nodes.planes()) {
                traverse(nodes, self.depth, &prepared, sink);
            }
        });
    }

    /// The nearest hit in `[t_min, t_max]`; equal t goes to the lowest id.
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut sink = Closest::new(ray.t_max);
        self.offer_all(ray, &mut sink);
        sink.into_hit()
    }

    /// Whether anything is hit in `[t_min, t_max]`. Cheaper than [`KdTree::closest_hit`]: it ends at the first hit.
    pub fn any_hit(&self, ray: &Ray) -> bool {
        let mut sink = Any { found: false, t_max: ray.t_max };
        self.offer_all(ray, &mut sink);
        sink.found
    }

    /// Every hit in `[t_min, t_max]`, sorted by (t, id), each triangle once.
    pub fn all_hits(&self, ray: &Ray) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.all_hits_into(ray, &mut hits);
        hits
    }

    /// [`KdTree::all_hits`] into a buffer that the caller reuses; what was in it is dropped.
    pub fn all_hits_into(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        let mut sink = All { hits, t_max: ray.t_max };
        self.offer_all(ray, &mut sink);
        sort_hits(hits);
    }

    /// Closest hits of a batch, in its order, which may be any: rays are traced side by side in SIMD lanes, each on its
    /// own way. For rays that go anywhere this is about twice as fast as one by one; the hits are the same to the
    /// last bit.
    ///
    /// Cut a large batch for several threads: pieces of 4096 rays are what the figures were measured with.
    ///
    /// ```
    /// use slimkd::{BuildOptions, KdTree, Ray, TriangleMesh};
    /// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let tree = KdTree::build(mesh, &BuildOptions::default())?;
    /// let rays: Vec<Ray> = (0..100).map(|i| Ray::new([0.01 * i as f32, 0.3, 1.0], [0.0, 0.0, -1.0])).collect();
    /// let mut hits = vec![None; rays.len()];
    /// tree.closest_hits(&rays, &mut hits);
    /// assert!(rays.iter().zip(hits).all(|(ray, hit)| hit == tree.closest_hit(ray)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit slot a ray");
        with_nodes!(self, nodes => {
            if rays.len() >= LEAST_STREAM && nodes.fit_lanes() {
                return self.instruction_set.run(self.stream(nodes, rays, hits));
            }
        });
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.closest_hit(ray));
    }

    /// Any-hit answers of a batch, in its order; as [`KdTree::closest_hits`].
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) {
        assert_eq!(rays.len(), hits.len(), "one answer slot a ray");
        with_nodes!(self, nodes => {
            if rays.len() >= LEAST_STREAM && nodes.fit_lanes() {
                return self.instruction_set.run(self.stream(nodes, rays, hits));
            }
        });
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.any_hit(ray));
    }

    /// [`KdTree::closest_hits`] for rays that go much the same way, such as a camera's: neighbours in the batch are
    /// traced together, 64 at a time, several times as fast as one by one. The hits are the same to the last bit.
    ///
    /// Order the batch so that neighbours are neighbours: an 8 × 8 tile of pixels after the other, not rows. Rays that
    /// turn out to go different ways cost time, never a hit.
    ///
    /// ```
    /// use slimkd::{BuildOptions, KdTree, Ray, TriangleMesh};
    /// let mesh = TriangleMesh::new(vec![[0.0; 3], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0]], vec![[0, 1, 2]])?;
    /// let tree = KdTree::build(mesh, &BuildOptions::default())?;
    /// let pixel = |i: usize| [(i % 8) as f32, (i / 8) as f32, -9.0];
    /// let rays: Vec<Ray> = (0..64).map(|i| Ray::new([0.0, 0.0, 9.0], pixel(i))).collect();
    /// let mut hits = vec![None; rays.len()];
    /// tree.closest_hits_coherent(&rays, &mut hits);
    /// assert!(rays.iter().zip(hits).all(|(ray, hit)| hit == tree.closest_hit(ray)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn closest_hits_coherent(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit slot a ray");
        let strays = with_nodes!(self, nodes => {
            let hits = &mut *hits;
            self.instruction_set.run(ClosestHits { tree: self.traced(nodes), rays, hits })
        });
        finish_strays(rays, hits, &strays, |rays, hits| self.closest_hits(rays, hits));
    }

    /// [`KdTree::any_hits`] for rays that go much the same way, such as those from neighbouring points to one light.
    /// As [`KdTree::closest_hits_coherent`].
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn any_hits_coherent(&self, rays: &[Ray], hits: &mut [bool]) {
        assert_eq!(rays.len(), hits.len(), "one answer slot a ray");
        let strays = with_nodes!(self, nodes => {
            let hits = &mut *hits;
            self.instruction_set.run(AnyHits { tree: self.traced(nodes), rays, hits })
        });
        finish_strays(rays, hits, &strays, |rays, hits| self.any_hits(rays, hits));
    }

    fn traced<N: Nodes>(&self, nodes: N) -> Traced<'_, N> {
        Traced { nodes, depth: self.depth, bounds: &self.bounds }
    }

    fn stream<'a, N, A>(&'a self, nodes: N, rays: &'a [Ray], answers: A) -> Stream<'a, N, A> {
        Stream { nodes, depth: self.depth, bounds: &self.bounds, rays, answers }
    }

    /// What batches are traced with: [`InstructionSet::best`] unless [`KdTree::set_instruction_set`] chose another.
    pub fn instruction_set(&self) -> InstructionSet {
        self.instruction_set
    }

    /// Chooses what batches are traced with; one that is not available becomes the best available one below. The hits
    /// are the same with all.
    pub fn set_instruction_set(&mut self, set: InstructionSet) {
        self.instruction_set = set.or_below();
    }

    /// The mesh that the tree was built over.
    pub fn mesh(&self) -> &Arc<TriangleMesh> {
        &self.mesh
    }

    /// Bounds of every triangle that can be hit; empty for a tree without one.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The options that it was built with; `threads` and `max_build_bytes` are always `None`, since they leave no trace in the
    /// tree.
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }

    /// Its size, exact to the byte.
    pub fn memory(&self) -> MemoryReport {
        let mesh = self.mesh.memory_bytes();
        match &self.encoded {
            Encoded::Plain(plain) => {
                let t_references = walk::t_references(self);
                MemoryReport {
                    nodes: 8 * (plain.nodes.len() as u64 - t_references),
                    t_references: 8 * t_references,
                    indices: 4 * plain.indices_4byte.len() as u64 + 2 * plain.indices_2byte.len() as u64,
                    mesh,
                    ..MemoryReport::default()
                }
            }
            Encoded::Dense(dense) => MemoryReport {
                nodes: dense.bytes.len() as u64 - dense.index_bytes - dense.padding(),
                indices: dense.index_bytes,
                other: dense.padding(),
                mesh,
                ..MemoryReport::default()
            },
        }
    }

    /// Its shape; walks the whole tree, O(nodes + references).
    pub fn statistics(&self) -> TreeStatistics {
        walk::statistics(self)
    }
}

/// The plan's bytes in the layout asked for; plain where the dense layout cannot hold it.
fn encode(
    plan: &Plan,
    bounds: &Aabb,
    triangles: usize,
    layout: Layout,
    progress: &Progress,
) -> Result<Encoded, BuildError> {
    if layout == Layout::Dense
        && plan.hoisted.is_empty()
        && let Some(dense) = dense::encode(plan, bounds, triangles, progress)?
    {
        return Ok(Encoded::Dense(dense));
    }
    Ok(Encoded::Plain(plain::encode(plan, layout != Layout::FourByte, progress)?))
}
