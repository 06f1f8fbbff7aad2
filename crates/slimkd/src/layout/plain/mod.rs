//! The plain layout: the paper's 8-byte nodes and its two leaf modes.

mod checked;
mod encode;
mod lanes;
mod layout;
mod validate;
mod view;

pub(crate) use checked::CheckedPlain;
pub(crate) use encode::{encode, size};
pub(crate) use layout::Packed;
pub(crate) use validate::validate;
pub(crate) use view::PlainView;

/// The encoded tree: one array of nodes and T-references, and the leaves' indices in their two modes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Plain {
    pub(crate) nodes: Vec<Packed>,
    pub(crate) indices_4byte: Vec<u32>,
    pub(crate) indices_2byte: Vec<u16>,
}
