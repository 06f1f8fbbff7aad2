//! From a mesh to a plan of the tree: fragments → search → partition → recursion.

mod bins;
mod clip;
mod fork;
mod fragment;
pub(crate) mod memory;
mod options;
mod pace;
mod pairs;
mod partition;
mod plan;
mod predict;
mod price;
mod progress;
mod recursion;
mod sah;
mod search;
mod subtrees;
mod sweep;

pub(crate) use clip::Polygon;
pub use options::{BuildError, BuildOptions, Clipping, Layout, Preset, SahConstants, Sweep, TreeBudget};
pub(crate) use pace::Pace;
pub(crate) use plan::{Plan, PlanNode};
pub(crate) use price::Bound;
pub use progress::Progress;
pub(crate) use recursion::Builder;
