//! Proof that dense bytes that were read can be walked.

use super::{Dense, PADDING, word};
use crate::layout::runs::read_code;
use crate::layout::{Damage, damaged};

/// Proves that the bytes are exactly one tree in preorder, that every id names a triangle, ascending within a leaf, and
/// that every distance leads to the right child. Returns the depth, and counts the index bytes.
pub(crate) fn validate(dense: &mut Dense, triangles: usize) -> Result<u32, Damage> {
    let Some(end) = dense.bytes.len().checked_sub(PADDING) else { return damaged("the nodes are missing") };
    if dense.bytes[end..] != [0; PADDING] {
        return damaged("bytes behind the last node");
    }
    let mut deepest = 0;
    let mut index_bytes = 0;
    let mut at = 0;
    // Where the right children of the nodes above must begin, with their depth.
    let mut rights: Vec<(u64, u32)> = Vec::new();
    let mut depth = 0;
    loop {
        if at >= end {
            return damaged("a node is missing");
        }
        let word = u32_at(&dense.bytes, at);
        if word & word::LEAF != word::LEAF {
            let near = word::distance(word);
            let (size, distance) = if near == 0 { (8, u32_at(&dense.bytes, at + 4)) } else { (4, near) };
            depth += 1;
            rights.push((at as u64 + u64::from(distance), depth));
            at += size;
            continue;
        }
        deepest = deepest.max(depth);
        let (next, codes) = leaf(dense, at, end, triangles)?;
        index_bytes += codes;
        at = next;
        match rights.pop() {
            Some((right, right_depth)) if right == at as u64 => depth = right_depth,
            Some(_) => return damaged("a right child stands elsewhere"),
            None if at == end => break,
            None => return damaged("bytes behind the last node"),
        }
    }
    dense.index_bytes = index_bytes;
    Ok(deepest)
}

/// The end of the leaf at `at`, and its index bytes.
fn leaf(dense: &Dense, at: usize, end: usize, triangles: usize) -> Result<(usize, u64), Damage> {
    let bytes = &dense.bytes;
    let leaf = dense.code.leaf(at as u32, u32_at(bytes, at), |at| {
        // Behind the end: a count that no leaf can have.
        bytes
            .get(at as usize..at as usize + 4)
            .map_or(u32::MAX, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
    });
    if leaf.left == 0 {
        return if bytes[at] == word::LEAF as u8 {
            Ok((at + 1, 0))
        } else {
            damaged("an empty leaf is not one")
        };
    }
    let mut codes = leaf.codes as usize;
    let (mut next, mut left) = (u64::from(leaf.next) + 1, leaf.left - 1);
    while left > 0 {
        if codes >= end {
            return damaged("a leaf does not end");
        }
        let (gap, run, size) = read_code(u64_at(bytes, codes));
        if run > left {
            return damaged("a leaf holds more triangles than it says");
        }
        next += u64::from(gap) + u64::from(run);
        if next > triangles as u64 {
            return damaged("an id names no triangle");
        }
        left -= run;
        codes += size as usize;
    }
    if next > triangles as u64 {
        return damaged("an id names no triangle");
    }
    if codes > end {
        return damaged("a leaf does not end");
    }
    Ok((codes, (codes - at) as u64 - u64::from(dense.code.header_bytes)))
}

/// `at` must lie before the padding.
fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u64_at(bytes, at) as u32
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut word = [0; 8];
    let piece = &bytes[at..(at + 8).min(bytes.len())];
    word[..piece.len()].copy_from_slice(piece);
    u64::from_le_bytes(word)
}
