//! From rays to hits.

mod arch;
mod brute_force;
mod cost;
mod counters;
mod filtered;
mod hit;
mod nearest;
mod packet;
mod prepared;
mod single;
mod sink;
mod stream;

pub(crate) use arch::Simd;
pub use arch::{InstructionSet, UnknownInstructionSet};
pub use brute_force::BruteForce;
pub(crate) use cost::Costed;
pub use cost::RayCost;
pub use counters::Counters;
pub(crate) use filtered::Filtered;
pub use hit::Hit;
pub use nearest::ClosestPoint;
pub(crate) use nearest::{Search, search_tree};
pub(crate) use packet::{AnyHits, ClosestHits, Traced, finish as finish_strays};
pub(crate) use prepared::{Planes, PreparedRay};
pub(crate) use single::traverse;
pub(crate) use sink::{All, Any, Closest, Sink, sort_hits};
pub(crate) use stream::Stream;
