//! From rays to hits.

mod arch;
mod brute_force;
mod filtered;
mod hit;
mod nearest;
mod prepared;
mod single;
mod sink;

pub use arch::{InstructionSet, UnknownInstructionSet};
pub use brute_force::BruteForce;
pub(crate) use filtered::Filtered;
pub use hit::Hit;
pub use nearest::ClosestPoint;
pub(crate) use nearest::{Search, search_tree};
pub(crate) use prepared::{Planes, PreparedRay};
pub(crate) use single::traverse;
pub(crate) use sink::{All, Any, Closest, Sink, sort_hits};
