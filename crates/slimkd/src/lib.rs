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

pub mod build;
pub mod geometry;
pub mod reduce;
pub mod traverse;
pub mod tree;

pub use build::{BuildError, BuildOptions, Clipping, Preset, Progress, SahConstants};
pub use geometry::{Aabb, MeshError, Ray, TriangleMesh};
pub use reduce::{CountedLeaves, HoistAlgorithm, Hoisting, OccupancyBase, WhenLeafRemains};
pub use traverse::{BruteForce, Hit};
pub use tree::{FileError, KdTree, MemoryReport, TreeStatistics};
