//! The encoded tree as sections, and back. A new part of [`Encoded`] gets a kind and one line in each function.

use super::super::encode::Encoded;
use super::FileError;
use super::bytes::{Section, le_bytes};
use super::table::Kind;
use std::borrow::Cow;
use std::io::Read;

const NODES: Kind = Kind(Kind::TREE.0);
const INDICES_4BYTE: Kind = Kind(Kind::TREE.0 + 1);
const INDICES_2BYTE: Kind = Kind(Kind::TREE.0 + 2);

/// Kind and bytes of every part that is not empty, kinds ascending.
pub(super) fn put(encoded: &Encoded) -> impl Iterator<Item = (Kind, Cow<'_, [u8]>)> {
    [
        (NODES, le_bytes(&encoded.nodes)),
        (INDICES_4BYTE, le_bytes(&encoded.indices_4byte)),
        (INDICES_2BYTE, le_bytes(&encoded.indices_2byte)),
    ]
    .into_iter()
    .filter(|(_, bytes)| !bytes.is_empty())
}

/// Reads a section into its part.
pub(super) fn take(encoded: &mut Encoded, section: Section<'_, impl Read>) -> Result<(), FileError> {
    let kind = section.entry().kind;
    if section.entry().length == 0 {
        return super::damaged(format!("section {} is empty", kind.0));
    }
    match kind {
        NODES => encoded.nodes = section.read()?,
        INDICES_4BYTE => encoded.indices_4byte = section.read()?,
        INDICES_2BYTE => encoded.indices_2byte = section.read()?,
        Kind(other) => return Err(FileError::UnknownSection(other)),
    }
    Ok(())
}
