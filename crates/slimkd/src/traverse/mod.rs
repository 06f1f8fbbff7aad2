//! From rays to hits.

mod arch;
mod brute_force;
mod hit;
mod prepared;
mod single;
mod sink;

pub use arch::{InstructionSet, UnknownInstructionSet};
pub use brute_force::BruteForce;
pub use hit::Hit;
pub(crate) use prepared::{Planes, PreparedRay};
pub(crate) use single::traverse;
pub(crate) use sink::{All, Any, Closest, Sink};
