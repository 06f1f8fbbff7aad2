//! From a plan to dense bytes.
//!
//! Written from the back: a node's distance to its right child is known once its left subtree stands, and the plan's
//! preorder read backwards brings every child before its parent.

use super::leaf::{LeafCode, TRIANGLE_LIMIT};
use super::{Dense, PADDING, word};
use crate::build::memory::{filled, room};
use crate::build::{BuildError, Plan, PlanNode, Progress};
use crate::geometry::Aabb;

/// Bytes that 32-bit addresses reach.
const BYTE_LIMIT: u64 = (1 << 32) - 1;

/// Encodes a plan without T-references over `triangles` triangles; `None` where the grid cannot hold the scene's scale.
pub(in crate::tree) fn encode(
    plan: &Plan,
    bounds: &Aabb,
    triangles: usize,
    progress: &Progress,
) -> Result<Option<Dense>, BuildError> {
    check("triangles", triangles as u64, TRIANGLE_LIMIT)?;
    let Some(planes) = word::grid(bounds) else { return Ok(None) };
    let code = LeafCode::new(triangles);
    // Of every node, its first byte's distance from the end.
    let mut starts = filled(0u32, plan.nodes.len())?;
    let mut reversed: Vec<u8> = filled(0, PADDING)?;
    let mut index_bytes = 0;
    let mut bytes = Vec::new();
    for (at, node) in plan.nodes.iter().enumerate().rev() {
        progress.check_at(at)?;
        bytes.clear();
        match *node {
            PlanNode::Leaf { first, count } => {
                code.write(&mut bytes, &plan.references[first as usize..(first + count) as usize]);
                index_bytes += (bytes.len() as u64).saturating_sub(code.header_bytes.into());
            }
            PlanNode::Inner { axis, split, right } => {
                let left_bytes = starts[at + 1] - starts[right as usize];
                let inner = word::inner(axis, word::cell(&planes, axis.into(), split), 4 + left_bytes);
                bytes.extend_from_slice(&inner.to_le_bytes());
                if word::distance(inner) == 0 {
                    bytes.extend_from_slice(&(8 + left_bytes).to_le_bytes());
                }
            }
        }
        room(&mut reversed, bytes.len())?;
        reversed.extend(bytes.iter().rev());
        check("bytes", reversed.len() as u64, BYTE_LIMIT)?;
        starts[at] = reversed.len() as u32;
    }
    drop(starts);
    reversed.reverse();
    reversed.shrink_to_fit();
    Ok(Some(Dense { bytes: reversed, index_bytes, code, planes }))
}

impl Dense {
    /// From the bytes of a file, to be proved. `None` where no tree over these bounds has this layout.
    pub(in crate::tree) fn from_bytes(bytes: Vec<u8>, bounds: &Aabb, triangles: usize) -> Option<Self> {
        if !fits(bytes.len(), triangles) {
            return None;
        }
        Some(Self { bytes, index_bytes: 0, code: LeafCode::new(triangles), planes: word::grid(bounds)? })
    }
}

/// Whether addresses reach all bytes, and headers all triangles.
pub(super) fn fits(bytes: usize, triangles: usize) -> bool {
    triangles as u64 <= TRIANGLE_LIMIT && bytes as u64 <= BYTE_LIMIT
}

fn check(what: &'static str, needed: u64, limit: u64) -> Result<(), BuildError> {
    if needed <= limit { Ok(()) } else { Err(BuildError::TooLarge { what, needed, limit }) }
}
