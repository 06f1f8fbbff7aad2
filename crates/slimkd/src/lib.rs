//! slimkd traces rays through large static triangle scenes with an SAH kd-tree that is as small as it is fast.
//!
//! ```
//! use slimkd::{BuildOptions, KdTree, Preset, Ray, TriangleMesh};
//!
//! let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
//! let tree = KdTree::build(mesh, &BuildOptions::from(Preset::Standard))?;
//!
//! let ray = Ray::new([0.2, 0.2, 5.0], [0.0, 0.0, -1.0]);
//! let hit = tree.closest_hit(&ray).expect("the ray points at the triangle");
//! assert_eq!((hit.triangle, hit.t), (0, 5.0));
//! assert!(tree.any_hit(&ray));
//! println!("{} bytes of tree over {} of mesh", tree.memory().tree(), tree.memory().mesh);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Who owns what
//!
//! A [`KdTree`] shares its [`TriangleMesh`] by [`Arc`](std::sync::Arc): hand in a mesh, or an `Arc` to keep using it. Both are
//! immutable and `Send + Sync`: trace from any number of threads at once. Nothing is copied from the mesh into the tree.
//!
//! # What a hit is
//!
//! A triangle's id is its position in the mesh. `t` counts in units of the ray's direction, which may have any length but 0;
//! a hit has `t_min ≤ t ≤ t_max`; triangles are two-sided. The test is watertight, and its answer does not depend on the
//! tree: every preset and thread count gives the same hit to the last bit, [`BruteForce`] too. Equal `t` goes to the
//! lowest id. Collinear triangles and those with a NaN or infinite corner keep their id and never hit.
//!
//! # Beyond the nearest hit
//!
//! [`KdTree::any_hit`], [`KdTree::all_hits`]; with a filter, a mask or without the triangle that a ray starts on
//! ([`KdTree::closest_hit_where`], [`KdTree::closest_hit_except`]); the nearest point of the mesh
//! ([`KdTree::closest_point`]); t, u, v in f64 ([`TriangleMesh::refine`]).
//!
//! # Keeping a tree
//!
//! [`KdTree::save`] and [`KdTree::load`], or [`KdTree::write`] and [`KdTree::read`] for any stream, with or without the
//! mesh. Reading proves the whole file; [`OpenTree`] is ready at once over mapped bytes and checks each access.
//!
//! # How small, how fast
//!
//! [`Preset`] names points of one [`BuildOptions`]: [`Preset::Slim`], the default, is about as fast as [`Preset::Standard`] at an
//! eighth of its size and never takes more than 10 bytes a triangle; [`Preset::Tiny`] is smaller still. [`BuildOptions::max_tree`]
//! asks for a size. [`KdTree::memory`] says what a tree takes, exact to the byte; [`KdTree::statistics`] what it looks like.
//!
//! Batches trace faster than single rays: [`KdTree::closest_hits`] and [`KdTree::any_hits`] in any order,
//! [`KdTree::closest_hits_coherent`] and [`KdTree::any_hits_coherent`] where neighbours go the same way. The hits are the same.
//!
//! # Building
//!
//! Builds run on the current rayon pool or on [`BuildOptions::threads`] threads; the tree's bytes are the same. A
//! [`Progress`] tells another thread how far a build is, and cancels it. Depth is bounded only by the scene.

#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

pub mod build;
pub mod geometry;
pub mod reduce;
pub mod traverse;
pub mod tree;

pub use build::{
    BuildError, BuildOptions, Clipping, Layout, Preset, Progress, SahConstants, Sweep, TreeBudget,
};
pub use geometry::{Aabb, MeshError, Ray, RefinedHit, TriangleMesh};
pub use reduce::{CountedLeaves, HoistAlgorithm, Hoisting, OccupancyBase, WhenLeafRemains};
pub use traverse::{BruteForce, ClosestPoint, Counters, Hit, InstructionSet, RayCost};
pub use tree::{CompletenessError, EncodedTree, FileError, KdTree, MemoryReport, OpenTree, TreeStatistics};
