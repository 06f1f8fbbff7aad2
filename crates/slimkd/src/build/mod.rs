//! From a mesh to a plan of the tree: events → sweep → partition → recursion.

mod clip;
mod event;
mod options;
mod partition;
mod plan;
mod predict;
mod progress;
mod recursion;
mod sah;
mod sweep;

pub use options::{BuildError, BuildOptions, Clipping, Layout, Preset, SahConstants};
pub(crate) use plan::{Plan, PlanNode};
pub use progress::Progress;
pub(crate) use recursion::Builder;
