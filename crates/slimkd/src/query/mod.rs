//! What users ask: one interface for everything that can be traced.
//!
//! | file | what |
//! |---|---|
//! | `tracer.rs` | [`Tracer`]: the verbs, for one ray; read this first |
//! | `single.rs` | [`Query`]: one ray or point, with an excluded triangle and a filter |
//! | `batch.rs` | [`Batch`]: many rays, in any order or coherent, on one thread or on several |
//! | `crossings.rs` | [`Crossings`]: how often a ray crosses the surface, exactly |
//! | `inside.rs` | inside and outside: points, [`Grid`]s, distances with a sign |
//! | `winding.rs` | [`WindingNumbers`]: inside and outside of meshes with holes |
//! | `segments.rs` | [`Segment`]: what lies between two points |
//! | `rays.rs` | rays and hits as slices of structures or as columns |
//! | `walk.rs` | what a tree must be able to do so that it is a [`Tracer`] |
//! | `brute_force.rs` | [`BruteForce`]: the oracle that every tree must agree with |

mod batch;
mod brute_force;
mod crossings;
mod inside;
mod rays;
mod segments;
mod single;
mod tracer;
mod walk;
mod winding;

pub(crate) use batch::BatchJob;
pub use batch::{Batch, BatchHits};
pub use brute_force::BruteForce;
pub use crossings::Crossings;
pub use inside::Grid;
pub use rays::{HitColumns, Hits, RayColumns, Rays};
pub use segments::Segment;
pub use single::Query;
pub use tracer::Tracer;
pub(crate) use walk::{Walk, tracer};
pub use winding::WindingNumbers;
