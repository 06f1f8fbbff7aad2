//! Proof that wide nodes that were read can be walked.

use super::node::STEP_BITS;
use super::{LANES, PADDING, Wide};
use crate::layout::runs::read_code;
use crate::layout::{Damage, damaged};

/// Proves that every node but the root is the child of exactly one node before it, that the leaves follow each other without gaps, that
/// every id names a triangle, ascending within a leaf, and that planes are finite numbers. Returns the depth of the deepest leaf.
pub(crate) fn validate(wide: &Wide, triangles: usize) -> Result<u32, Damage> {
    let Some(end) = wide.leaves.len().checked_sub(PADDING) else { return damaged("the leaves are missing") };
    if wide.leaves[end..] != [0; PADDING] {
        return damaged("bytes behind the last leaf");
    }
    if wide.nodes.is_empty() {
        return damaged("the nodes are missing");
    }
    let mut depths = Vec::new();
    depths.try_reserve_exact(wide.nodes.len()).map_err(|_| Damage("no memory to prove it".to_owned()))?;
    depths.resize(wide.nodes.len(), u32::MAX);
    depths[0] = 0;
    let (mut deepest, mut leaf_bytes) = (0, 0u64);
    for (at, node) in wide.nodes.iter().enumerate() {
        let (inner, children) = (node.inner(), node.children());
        if inner > children || children > LANES || (children == 0 && at > 0) {
            return damaged(format!("node {at} has {inner} inner children of {children}"));
        }
        let depth = depths[at];
        if depth == u32::MAX {
            return damaged(format!("node {at} is nobody's child"));
        }
        for axis in 0..3 {
            let step = f32::from_bits(node.steps[axis] & STEP_BITS);
            let is_sound = step.is_normal() && step > 0.0 && (0.0..=2.0).contains(&node.low[axis]);
            if !is_sound {
                return damaged(format!("node {at} has no planes"));
            }
        }
        for lane in 0..inner {
            match depths.get_mut(node.nodes as usize + lane) {
                Some(child) if *child == u32::MAX && node.nodes as usize + lane > at => *child = depth + 1,
                _ => return damaged(format!("child {lane} of node {at} is not its own")),
            }
        }
        if inner < children {
            deepest = deepest.max(depth + 1);
        }
        for lane in inner..children {
            let start = u64::from(node.leaves) + u64::from(node.offsets[lane]);
            let leaf = format!("leaf {lane} of node {at}");
            let Some(bytes) = leaf_of(wide, start, end, triangles) else {
                return damaged(format!("{leaf} is broken"));
            };
            leaf_bytes += bytes;
        }
    }
    if leaf_bytes != end as u64 {
        return damaged("its leaves are not as long as they say");
    }
    Ok(deepest)
}

/// Bytes of the leaf at `start`, if it is one.
fn leaf_of(wide: &Wide, start: u64, end: usize, triangles: usize) -> Option<u64> {
    let long = |at: u64| {
        let at = usize::try_from(at).ok()?;
        // Codes lie before the padding.
        let bytes = (at < end).then(|| wide.leaves.get(at..at + PADDING))??;
        Some(u64::from_le_bytes(bytes.try_into().ok()?))
    };
    let (first, count, header) = wide.code.header(long(start)?);
    let (mut at, mut left) = (start + u64::from(header), count - 1);
    let mut next = u64::from(first) + 1;
    while left > 0 {
        let (gap, run, size) = read_code(long(at)?);
        left = left.checked_sub(run)?;
        next += u64::from(gap) + u64::from(run);
        at += u64::from(size);
    }
    (next <= triangles as u64 && at <= end as u64).then_some(at - start)
}
