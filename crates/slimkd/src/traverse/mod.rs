//! From rays to hits. Read `single.rs` first: all other kernels compute the same, faster.
//!
//! | file | what |
//! |---|---|
//! | `prepared.rs` | what a ray carries, and the proof that no hit is lost at a split plane |
//! | `single.rs` | the walk of one ray |
//! | `wide/` | wide nodes: the walk of one ray, streams, coherent groups |
//! | `sink.rs`, `conditions.rs` | what a query does with hits, and which of them count |
//! | `stream/` | batches in any order: a ray in each lane |
//! | `packet/` | coherent batches: 64 rays share one walk |
//! | `exact.rs` | queries that decide each triangle exactly, in f64 |
//! | `nearest.rs` | the nearest point |
//! | `cost.rs`, `counters.rs` | what one ray costs in a tree; what kernels do, counted |

mod conditions;
mod cost;
mod counters;
mod exact;
mod nearest;
mod packet;
mod prepared;
mod single;
mod sink;
mod stream;
mod wide;

pub(crate) use conditions::{Conditions, RayConditions};
pub(crate) use cost::Costed;
pub use cost::RayCost;
pub use counters::Counters;
pub(crate) use exact::{Crossing, ExactQuery, traverse_exactly, traverse_wide_exactly};
pub use nearest::NearestPoint;
pub(crate) use nearest::{Search, search_tree, search_wide};
pub(crate) use packet::{AnyHits, ClosestHits, Grouped, finish as finish_strays};
pub(crate) use prepared::PreparedRay;
pub(crate) use single::traverse;
pub(crate) use sink::{Any, Closest, Filtered, First, Sink};
pub(crate) use stream::Stream;
pub(crate) use wide::{WideBatch, WideWalk, walk_in_f64};

use crate::geometry::Aabb;

/// Batches below this go ray by ray: a stream is not worth setting up.
pub(crate) const LEAST_STREAM: usize = 16;

/// A tree as every kernel needs it.
#[derive(Clone, Copy)]
pub(crate) struct Traced<'a, N> {
    pub(crate) nodes: N,
    /// Depth of the deepest leaf: it bounds the stack.
    pub(crate) depth: u32,
    pub(crate) bounds: &'a Aabb,
}
