//! How a tree is written as bytes, and read again. Read `nodes.rs` first: it is what walks and kernels see of any layout.
//!
//! | folder | layout |
//! |---|---|
//! | `plain/` | 8-byte nodes, 4 or 2 bytes a reference: the paper's; every bit in `plain/layout.rs` |
//! | `dense/` | 4-byte nodes, byte-coded leaves: ours; every bit in `dense/word.rs` and `dense/leaf.rs` |
//! | `wide/` | nodes of 16 child boxes, byte-coded leaves: ours; every bit in `wide/node.rs` and `wide/leaf.rs` |
//!
//! Each has an encoder, a proof of untrusted bytes (`validate.rs`), unchecked reads of what was proved (`view.rs`, `lanes.rs`) and
//! checked reads of what was not (`checked.rs`).

pub(crate) mod checked;
pub(crate) mod dense;
mod encoded;
mod lanes;
mod mesh;
mod nodes;
pub(crate) mod plain;
mod planes;
mod runs;
mod view;
pub(crate) mod wide;

pub use encoded::EncodedTree;
pub(crate) use encoded::{Encoded, encode, size};
pub(crate) use lanes::{LaneNodes, LaneStep};
pub(crate) use mesh::MeshView;
pub(crate) use nodes::{Address, Ids, Inner, LeafMode, MOST_IDS, Nodes, SPILL, Step};
pub(crate) use planes::Planes;
pub(crate) use view::{View, with_nodes};
pub(crate) use wide::{LANES, STEP_BITS, WideNode, WideNodes, WideView};

/// What is wrong with the bytes of a tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Damage(pub(crate) String);

pub(crate) fn damaged<T>(what: impl Into<String>) -> Result<T, Damage> {
    Err(Damage(what.into()))
}
