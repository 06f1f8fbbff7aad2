//! Proof that a wide tree lacks no triangle: the boxes of the leaves that name it cover it. `complete.rs` proves the same of trees of
//! planes, and says what a proof is for.
//!
//! A ray comes to a leaf wherever it runs through the boxes of all nodes above it and through the leaf's own. So a leaf answers for the
//! part of space that all these boxes share. From each triangle these parts are taken away, one leaf after the other; nothing may
//! be left but strips narrower than what rounding makes of a cut.

use super::complete::{CompletenessError, Measure, NEAR, STEPS};
use super::{KdTree, boxes};
use crate::geometry::{Polygon, TriangleMesh};
use crate::job::Progress;
use crate::layout::{Address, WideView};
use std::ops::Range;

/// A box, f64: lower and upper corner.
type Part = [[f64; 3]; 2];

/// What leaves answer for, and which triangles they name.
struct Listing {
    /// The part of space of each leaf.
    parts: Vec<Part>,
    /// Where each triangle's leaves begin; those of the last end with the array.
    starts: Vec<usize>,
    leaves: Vec<u32>,
}

pub(super) fn check(
    tree: &KdTree,
    nodes: WideView<'_>,
    progress: &Progress,
) -> Result<(), CompletenessError> {
    progress.begin(1.0);
    let listing = Listing::of(nodes, tree.mesh.len())?;
    let (valid, _) = tree.mesh.valid_triangles();
    let size = tree.encoded.bytes() / 8 + listing.leaves.len() as u64 + valid.len() as u64;
    let mut left = STEPS * size;
    // What decoding a plane and cutting at it may round by.
    let largest = |k: usize| f64::from(tree.bounds.min[k].abs().max(tree.bounds.max[k].abs()));
    let reach = [0, 1, 2].map(|k| NEAR * largest(k));
    let share = 1024.0 / valid.len().max(1) as f64;
    for (at, &triangle) in valid.iter().enumerate() {
        if at.is_multiple_of(1024) {
            progress.check().map_err(|_| CompletenessError::Cancelled)?;
            progress.advance(share);
        }
        match listing.covers(&tree.mesh, triangle, &reach, &mut left) {
            Some(true) => {}
            Some(false) => return Err(CompletenessError::Missing { triangle }),
            None => return Err(CompletenessError::TooLong),
        }
    }
    progress.finish();
    Ok(())
}

impl Listing {
    fn of(nodes: WideView<'_>, triangles: usize) -> Result<Self, CompletenessError> {
        let none = |bytes: usize| CompletenessError::OutOfMemory { bytes: bytes as u64 };
        let mut listing = Self { parts: Vec::new(), starts: Vec::new(), leaves: Vec::new() };
        let (mut leaves, mut references) = (0, 0);
        boxes::for_each_node(nodes, |node, _| leaves += node.children() - node.inner());
        boxes::for_each_reference(nodes, |_| references += 1);
        listing.parts.try_reserve_exact(leaves).map_err(|_| none(leaves * size_of::<Part>()))?;
        listing.starts.try_reserve_exact(triangles + 1).map_err(|_| none(8 * triangles))?;
        listing.leaves.try_reserve_exact(references).map_err(|_| none(4 * references))?;
        listing.starts.resize(triangles + 1, 0);
        listing.leaves.resize(references, 0);
        // Leaves in one order, with the part of each; and how many name a triangle.
        let mut named: Vec<Range<usize>> = Vec::new();
        let mut ids: Vec<u32> = Vec::new();
        let everywhere = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
        let mut pending = vec![(Address::ROOT, everywhere)];
        while let Some((at, part)) = pending.pop() {
            // SAFETY: the address is the root's or that of an inner child of a node of this tree.
            let node = unsafe { nodes.node(at) };
            for lane in 0..node.children() {
                let [low, high] = node.bounds(lane, nodes.grid());
                let own = [
                    std::array::from_fn(|k| low[k].max(part[0][k])),
                    std::array::from_fn(|k| high[k].min(part[1][k])),
                ];
                if lane < node.inner() {
                    // SAFETY: the lane is that of an inner child.
                    pending.push((unsafe { nodes.child(node, lane) }, own));
                    continue;
                }
                listing.parts.push(own);
                let first = ids.len();
                boxes::with_ids(nodes, node, lane, |of_leaf| ids.extend_from_slice(of_leaf));
                named.push(first..ids.len());
            }
        }
        for &id in &ids {
            listing.starts[id as usize + 1] += 1;
        }
        for id in 0..triangles {
            listing.starts[id + 1] += listing.starts[id];
        }
        let mut next = listing.starts.clone();
        for (leaf, range) in named.into_iter().enumerate() {
            for &id in &ids[range] {
                listing.leaves[next[id as usize]] = leaf as u32;
                next[id as usize] += 1;
            }
        }
        Ok(listing)
    }

    /// Whether the parts of the leaves that name a triangle cover it; `None` once `steps` are used up.
    fn covers(&self, mesh: &TriangleMesh, triangle: u32, reach: &[f64; 3], steps: &mut u64) -> Option<bool> {
        let whole = Polygon::new(&mesh.corners(triangle));
        let measure = Measure::of(&whole);
        let (mut pieces, mut rest) = (vec![whole], Vec::new());
        for &leaf in &self.leaves[self.starts[triangle as usize]..self.starts[triangle as usize + 1]] {
            for piece in pieces.drain(..) {
                *steps = steps.checked_sub(1)?;
                subtract(piece, &self.parts[leaf as usize], reach, &measure, &mut rest);
            }
            std::mem::swap(&mut pieces, &mut rest);
            if pieces.is_empty() {
                return Some(true);
            }
        }
        Some(pieces.iter().all(|piece| measure.is_narrow(piece)))
    }
}

/// Adds to `rest` what of a piece lies outside a box.
fn subtract(mut piece: Polygon, part: &Part, reach: &[f64; 3], measure: &Measure, rest: &mut Vec<Polygon>) {
    for axis in 0..3 {
        for (position, sign) in [(part[0][axis] - reach[axis], 1.0), (part[1][axis] + reach[axis], -1.0)] {
            let mut outside = piece;
            piece.clip(axis, position, -sign, &mut outside);
            if !measure.is_narrow(&outside) {
                // Cutting six times more adds six corners, so pieces are kept small.
                rest.extend(outside.fan());
            }
            let before = piece;
            before.clip(axis, position, sign, &mut piece);
        }
    }
}
