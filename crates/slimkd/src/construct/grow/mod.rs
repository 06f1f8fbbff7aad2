//! Nodes become their children: read `subtree.rs` first; `top.rs` does the same to large nodes, with all threads.

mod fragment;
mod partition;
mod subtree;
mod top;

pub(super) use fragment::{Fragment, TRIANGLE_LIMIT};
pub(super) use top::{Limits, Task, Top, sequential_below};
