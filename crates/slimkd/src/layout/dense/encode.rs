//! From a plan to dense bytes.
//!
//! Written from the back: a node's distance to its right child is known once its left subtree stands, and the plan's
//! preorder read backwards brings every child before its parent.

use super::leaf::{LeafCode, TRIANGLE_LIMIT};
use super::{Dense, PADDING, word};
use crate::geometry::Aabb;
use crate::job::Job;
use crate::job::memory::{filled, push, room};
use crate::options::{BuildError, Countable};
use crate::plan::{Plan, PlanNode};

/// Bytes that 32-bit addresses reach.
const BYTE_LIMIT: u64 = (1 << 32) - 1;
/// Left subtrees of fewer bytes leave their parent in the near form, which adds its own 4 to the distance.
const NEAR_LIMIT: u64 = (1 << word::DISTANCE_BITS) - 4;

/// Whether the grid of planes can hold the scale of a scene with these bounds.
pub(crate) fn holds(bounds: &Aabb) -> bool {
    word::grid(bounds).is_some()
}

/// Bytes of what [`encode`] writes.
pub(crate) fn size(plan: &Plan, job: &Job<'_>) -> Result<u64, BuildError> {
    check(Countable::Triangles, job.mesh.len() as u64, TRIANGLE_LIMIT)?;
    let code = LeafCode::new(job.mesh.len());
    let mut total = PADDING as u64;
    // Backwards, as in `encode`: of the subtrees on the stack, a node's left one is on top, its right one below.
    let mut subtrees: Vec<u64> = Vec::new();
    for (at, node) in plan.nodes.iter().enumerate().rev() {
        job.check_at(at)?;
        let (own, below) = match *node {
            PlanNode::Leaf { first, count } => {
                (code.size(&plan.references[first as usize..(first + count) as usize]), 0)
            }
            PlanNode::Inner { .. } => {
                let (left, right) = (subtrees.pop(), subtrees.pop());
                let (left, right) = left.zip(right).expect("a plan is a binary tree");
                (if left < NEAR_LIMIT { 4 } else { 8 }, left + right)
            }
        };
        total += own;
        check(Countable::Bytes, total, BYTE_LIMIT)?;
        push(&mut subtrees, own + below)?;
    }
    Ok(total)
}

/// Encodes a plan without T-references, in bounds that the grid [`holds`].
pub(crate) fn encode(plan: &Plan, bounds: &Aabb, job: &Job<'_>) -> Result<Dense, BuildError> {
    let triangles = job.mesh.len();
    check(Countable::Triangles, triangles as u64, TRIANGLE_LIMIT)?;
    let planes = word::grid(bounds).expect("bounds that the grid holds");
    let code = LeafCode::new(triangles);
    // Of every node, its first byte's distance from the end.
    let mut starts = filled(0u32, plan.nodes.len())?;
    let mut reversed: Vec<u8> = filled(0, PADDING)?;
    let mut index_bytes = 0;
    let mut bytes = Vec::new();
    for (at, node) in plan.nodes.iter().enumerate().rev() {
        job.check_at(at)?;
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
        check(Countable::Bytes, reversed.len() as u64, BYTE_LIMIT)?;
        starts[at] = reversed.len() as u32;
    }
    drop(starts);
    reversed.reverse();
    reversed.shrink_to_fit();
    Ok(Dense { bytes: reversed, index_bytes, code, planes })
}

impl Dense {
    /// From the bytes of a file, to be proved. `None` where no tree over these bounds has this layout.
    pub(crate) fn from_bytes(bytes: Vec<u8>, bounds: &Aabb, triangles: usize) -> Option<Self> {
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

fn check(what: Countable, needed: u64, limit: u64) -> Result<(), BuildError> {
    if needed <= limit { Ok(()) } else { Err(BuildError::TooLarge { what, needed, limit }) }
}
