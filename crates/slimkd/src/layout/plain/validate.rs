//! Proof that a plain tree that was read can be walked.

use super::Plain;
use super::layout::Node;
use crate::layout::{Damage, damaged};

/// Proves that every pointer of a tree that was read leads somewhere, every id names a triangle, and every node is
/// reached exactly once. Returns the depth.
pub(crate) fn validate(encoded: &Plain, triangles: usize) -> Result<u32, Damage> {
    let mut reached = 0;
    let mut deepest = 0;
    // Each index belongs to one leaf: so reading all leaves takes no longer than the file is.
    let (mut wide, mut narrow) = (0, 0);
    let check_id =
        |id: u32| if (id as usize) < triangles { Ok(()) } else { damaged("an id names no triangle") };
    encoded.indices_4byte.iter().try_for_each(|&id| check_id(id))?;
    let mut pending = vec![(0u32, 0u32)];
    while let Some((index, depth)) = pending.pop() {
        let Some(node) = encoded.nodes.get(index as usize) else { return damaged("a child lies outside") };
        reached += 1;
        deepest = deepest.max(depth);
        match node.decode()? {
            Node::Inner { children, t_reference, .. } => {
                if children <= index || reached > encoded.nodes.len() {
                    return damaged("a child stands before its parent");
                }
                if t_reference {
                    reached += 1;
                    match encoded.nodes.get(children as usize + 2) {
                        Some(slot) if slot.0 >> 32 == 0 => check_id(slot.triangle())?,
                        _ => return damaged("a T-reference is not one"),
                    }
                }
                pending.extend([(children + 1, depth + 1), (children, depth + 1)]);
            }
            Node::Leaf4 { first, count } => {
                wide += count as usize;
                if first as usize + count as usize > encoded.indices_4byte.len() {
                    return damaged("a leaf's indices lie outside");
                }
            }
            Node::Leaf2 { first, count, upper } => {
                narrow += count as usize;
                if narrow > encoded.indices_2byte.len() {
                    break;
                }
                match encoded.indices_2byte.get(first as usize..first as usize + count as usize) {
                    Some(ids) => ids.iter().try_for_each(|&lower| check_id(upper | u32::from(lower)))?,
                    None => return damaged("a leaf's indices lie outside"),
                }
            }
        }
    }
    if (wide, narrow) != (encoded.indices_4byte.len(), encoded.indices_2byte.len()) {
        return damaged("leaves share indices, or leave some over");
    }
    if reached == encoded.nodes.len() { Ok(deepest) } else { damaged("nodes are shared or left over") }
}
