//! slimkd traces rays through large static triangle scenes with an SAH kd-tree that is as small as it is fast.
//!
//! ```
//! use slimkd::{BuildOptions, KdTree, Preset, Ray, Tracer, TriangleMesh};
//!
//! let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
//! let tree = KdTree::build(mesh, &BuildOptions::from(Preset::Standard))?;
//!
//! let ray = Ray::new([0.2, 0.2, 5.0], [0.0, 0.0, -1.0]);
//! let hit = tree.closest(&ray).expect("the ray points at the triangle");
//! assert_eq!((hit.triangle, hit.t), (0, 5.0));
//! assert!(tree.any(&ray));
//! println!("{} bytes of tree over {} of mesh", tree.memory().tree(), tree.memory().mesh);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Who owns what
//!
//! A [`KdTree`] shares its [`TriangleMesh`] by [`Arc`](std::sync::Arc): hand in a mesh, or an `Arc` to keep using it. Both are
//! immutable and `Send + Sync`, so any number of threads can trace at once. Nothing is copied from the mesh into the tree. Loading
//! files is the task of the crate `slimkd-scene`.
//!
//! # Asking
//!
//! All questions are in the trait [`Tracer`]: the verbs `closest`, `any`, `all`, `count`, `crossings`, `contains`, `visible` and
//! `nearest`.
//!
//! - One ray: `tree.closest(&ray)`.
//! - One ray with options: `tree.query().except(triangle).filter(&mut |hit| …).closest(&ray)`, see [`Query`].
//! - Many rays: `tree.batch().coherent().threads(0).closest(&rays, &mut hits)`, see [`Batch`]. Batches trace several times as
//!   fast as single rays. The hits are the same.
//! - What lies between two points: `tree.visible(a, b)`, many at a time `tree.batch().visible(&segments, &mut visible)`.
//! - A hit in f64, with its point, its unit normal and its side: `tree.refine(&ray, hit.triangle)`, see [`Tracer::refine`].
//! - The value at the hit of an attribute that the vertices have (a shading normal, a colour): [`Hit::interpolate`]. A mesh and a
//!   tree hold no attributes; keep them in arrays of your own, and find the three values by the triangle's vertex indices.
//!
//! # What a hit is
//!
//! A triangle's id is its position in the mesh. `t` counts in units of the ray's direction, which may have any length but 0;
//! a hit has `t_min ≤ t ≤ t_max`; triangles are two-sided. The test is watertight, and its answer does not depend on the
//! tree: every preset, kernel and thread count gives the same hit to the last bit, [`BruteForce`] too. Equal `t` goes to the
//! lowest id. Collinear triangles and those with a NaN or infinite corner keep their id and never hit.
//!
//! # Inside and outside
//!
//! [`Tracer::crossings`] counts how often a ray goes through the surface, exactly, and [`Tracer::contains`], [`Tracer::signed_distance`]
//! and [`Batch::occupancy`] rest on it. They mean something where the mesh is closed, which [`TriangleMesh::surface`] tells; for others there are
//! [`WindingNumbers`].
//!
//! # Ambient occlusion, shadows and other rays that start on a surface
//!
//! Leave out the triangle that a ray starts on, instead of moving `t_min`: no near hit is lost, and no ray of a batch is
//! traced twice. A shadow ray towards a light at a finite distance has the direction `light − start` and the range `[0, 1]`, since `t` counts in units of the
//! direction. The range includes 1: where the light is itself a triangle of the mesh, end the range a little earlier, or leave
//! that triangle out by [`Batch::filter`].
//!
//! ```
//! use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
//! # let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
//! # let tree = KdTree::build(TriangleMesh::new(corners, vec![[0, 1, 2], [3, 4, 5]])?, &BuildOptions::default())?;
//! let seen = tree.closest(&Ray::new([0.2, 0.2, 0.5], [0.0, 0.0, -1.0])).unwrap();
//! let start = [0.2, 0.2, 0.0];
//! let lights = [[0.2, 0.2, 9.0], [9.2, 0.2, 0.9], [-8.8, 0.2, 0.9]];
//! let rays = lights.map(|[x, y, z]| {
//!     let to_light = [x - start[0], y - start[1], z - start[2]];
//!     Ray::new(start, to_light).with_range(0.0, 1.0)
//! });
//! let except = [seen.triangle; 3]; // one for each ray; `u32::MAX` leaves out none
//! let mut occluded = [false; 3];
//! tree.batch().except(&except).threads(0).any(&rays, &mut occluded); // `threads(0)`: all threads
//! assert_eq!(occluded, [true, false, false]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Keeping a tree
//!
//! [`KdTree::save`] and [`KdTree::load`] keep a tree in a file, [`KdTree::write`] and [`KdTree::read`] in any stream, with or without
//! the mesh. Reading proves the whole file. [`OpenTree`] is ready at once over mapped bytes and checks each access instead; it needs
//! a file that was saved with its mesh. Attributes of the vertices are not saved.
//!
//! # How small, how fast
//!
//! A [`Preset`] is a named set of [`BuildOptions`]. [`Preset::Slim`], the default, is about as fast as [`Preset::Standard`] at an
//! eighth of its size and never takes more than 10 bytes a triangle; [`Preset::Tiny`] is smaller still. [`BuildOptions::max_tree`]
//! asks for a size. [`KdTree::memory`] gives the size of a tree, exact to the byte, and [`KdTree::statistics`] its shape in numbers.
//!
//! # Building
//!
//! A build runs on the current rayon pool or on [`BuildOptions::threads`] threads; the tree's bytes are the same. A
//! [`Progress`] tells another thread how far a build is, and cancels it. No option limits the tree's depth.
//!
//! # Vectors of other crates
//!
//! Points and directions are `[f32; 3]`, or anything that turns into it: glam's, nalgebra's and mint's types do. What comes back turns
//! into theirs by `.into()`. [`Ray`] and [`Hit`] are plain old data for `bytemuck`: a slice of rays has the bytes of a `rays.f32` file.
//!
//! # Features
//!
//! | feature | default | what it adds |
//! |---|---|---|
//! | `rayon` | yes | builds and batches on several threads; without it the crate builds for `wasm32-unknown-unknown` |
//! | `serde` | no | options, sizes, statistics, rays and hits as serde types |
//! | `counters` | no | [`Counters`] of what kernels do; tracing is slower |

// Elsewhere there are no lanes, and their kernels are not called.
#![cfg_attr(not(any(target_arch = "x86_64", target_arch = "aarch64")), allow(dead_code))]

#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

mod construct;
mod file;
mod geometry;
mod job;
mod layout;
mod options;
mod plan;
mod query;
mod reduce;
mod simd;
mod threads;
mod traverse;
mod tree;

#[doc(inline)]
pub use file::{FileError, OpenTree};
#[doc(inline)]
pub use geometry::{Aabb, Hit, HitF64, MeshError, Ray, RayF64, RefinedHit, Surface, TriangleMesh};
#[doc(inline)]
pub use job::Progress;
#[doc(inline)]
pub use layout::EncodedTree;
#[doc(inline)]
pub use options::{
    BuildError, BuildOptions, Clipping, Countable, HoistAlgorithm, Hoisting, Layout, Preset, SahConstants,
    Splits, TreeBudget, UnknownName,
};
#[doc(inline)]
pub use query::{
    Batch, BatchHits, BruteForce, Crossings, Grid, HitColumns, Hits, Query, RayColumns, Rays, Segment,
    Tracer, WindingNumbers,
};
#[doc(inline)]
pub use simd::{InstructionSet, UnknownInstructionSet};
#[doc(inline)]
pub use traverse::{Counters, NearestPoint, RayCost};
#[doc(inline)]
pub use tree::{CompletenessError, KdTree, LeafReferences, MemoryReport, NodeCounts, TreeStatistics};
