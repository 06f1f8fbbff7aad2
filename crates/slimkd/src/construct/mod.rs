//! From a mesh to a plan of the whole tree.
//!
//! ```text
//! triangles ─▶ grow/top: all threads split large nodes ─▶ subtrees: one thread each ─▶ joined plan
//!                    │                                        │
//!                    └── split/: the best plane of a node     └── pricing: what a byte costs, from a sample
//! ```
//!
//! Read `builder.rs` first: it has these steps in order.

pub(crate) mod boxes;
mod builder;
mod grow;
mod pace;
mod pricing;
mod split;
mod subtrees;

pub(crate) use builder::Builder;
pub(crate) use pace::Pace;
