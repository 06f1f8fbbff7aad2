//! The encoded tree as sections, and back. A new part of [`Encoded`] gets a kind and one line in each function.

use super::FileError;
use super::bytes::{Section, le_bytes};
use super::table::Kind;
use crate::geometry::Aabb;
use crate::layout::Encoded;
use crate::layout::WideNode;
use crate::layout::dense::{self, Dense};
use crate::layout::plain::{self, Plain};
use crate::layout::wide::{self, Wide};
use std::borrow::Cow;
use std::io::Read;

pub(super) const NODES: Kind = Kind(Kind::TREE.0);
pub(super) const INDICES_4BYTE: Kind = Kind(Kind::TREE.0 + 1);
pub(super) const INDICES_2BYTE: Kind = Kind(Kind::TREE.0 + 2);
pub(super) const DENSE: Kind = Kind(Kind::TREE.0 + 3);
pub(super) const WIDE_NODES: Kind = Kind(Kind::TREE.0 + 4);
pub(super) const WIDE_LEAVES: Kind = Kind(Kind::TREE.0 + 5);

/// Parts of a tree of either layout, as they come.
#[derive(Default)]
pub(super) struct Parts {
    plain: Plain,
    dense: Vec<u8>,
    wide_nodes: Vec<WideNode>,
    wide_leaves: Vec<u8>,
}

/// Kind and bytes of every part that is not empty, kinds ascending.
pub(super) fn put(encoded: &Encoded) -> impl Iterator<Item = (Kind, Cow<'_, [u8]>)> {
    let parts: Vec<(Kind, Cow<'_, [u8]>)> = match encoded {
        Encoded::Plain(plain) => vec![
            (NODES, le_bytes(&plain.nodes)),
            (INDICES_4BYTE, le_bytes(&plain.indices_4byte)),
            (INDICES_2BYTE, le_bytes(&plain.indices_2byte)),
        ],
        Encoded::Dense(dense) => vec![(DENSE, Cow::Borrowed(&dense.bytes))],
        Encoded::Wide(wide) => {
            vec![(WIDE_NODES, le_bytes(&wide.nodes)), (WIDE_LEAVES, Cow::Borrowed(&wide.leaves))]
        }
    };
    parts.into_iter().filter(|(_, bytes)| !bytes.is_empty())
}

/// Reads a section into its part.
pub(super) fn take(parts: &mut Parts, section: Section<'_, impl Read>) -> Result<(), FileError> {
    let kind = section.entry().kind;
    if section.entry().length == 0 {
        return super::damaged(format!("section {} is empty", kind.0));
    }
    match kind {
        NODES => parts.plain.nodes = section.read()?,
        INDICES_4BYTE => parts.plain.indices_4byte = section.read()?,
        INDICES_2BYTE => parts.plain.indices_2byte = section.read()?,
        DENSE => parts.dense = section.read()?,
        WIDE_NODES => parts.wide_nodes = section.read()?,
        WIDE_LEAVES => parts.wide_leaves = section.read()?,
        Kind(other) => return Err(FileError::UnknownSection(other)),
    }
    Ok(())
}

impl Parts {
    /// The tree over a mesh of `triangles` triangles, with its depth, once it is proved.
    pub(super) fn prove(self, bounds: &Aabb, triangles: usize) -> Result<(Encoded, u32), FileError> {
        let Self { plain, dense, wide_nodes, wide_leaves } = self;
        let has =
            [plain != Plain::default(), !dense.is_empty(), !wide_nodes.is_empty() || !wide_leaves.is_empty()];
        match has {
            [_, false, false] => {
                let depth = plain::validate(&plain, triangles)?;
                return Ok((Encoded::Plain(plain), depth));
            }
            [false, true, false] => {
                if let Some(mut dense) = Dense::from_bytes(dense, bounds, triangles) {
                    let depth = dense::validate(&mut dense, triangles)?;
                    return Ok((Encoded::Dense(dense), depth));
                }
            }
            [false, false, true] => {
                if let Some(wide) = Wide::from_parts(wide_nodes, wide_leaves, bounds, triangles) {
                    let depth = wide::validate(&wide, triangles)?;
                    return Ok((Encoded::Wide(wide), depth));
                }
            }
            _ => {}
        }
        super::damaged("its layout does not fit the mesh")
    }
}
