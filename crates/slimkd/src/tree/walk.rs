//! Walks over the encoded tree: depth, statistics, validation.

use super::encode::Encoded;
use super::layout::{Node, Packed};
use super::statistics::{LeafReferences, NodeCounts, TreeStatistics};
use super::{FileError, KdTree};
use crate::geometry::Aabb;

/// A node that a walk visits.
struct Visit {
    index: u32,
    depth: u32,
    voxel: Aabb,
}

/// Calls `visit` for every node, parents before children. The nodes must be sound.
fn for_each(encoded: &Encoded, root: Aabb, mut visit: impl FnMut(&Visit, Packed)) {
    let mut pending = vec![Visit { index: 0, depth: 0, voxel: root }];
    while let Some(at) = pending.pop() {
        let node = encoded.nodes[at.index as usize];
        visit(&at, node);
        if !node.is_leaf() {
            let (left, right) = at.voxel.split(node.axis(), node.split());
            let (children, depth) = (node.pointer(), at.depth + 1);
            pending.push(Visit { index: children + 1, depth, voxel: right });
            pending.push(Visit { index: children, depth, voxel: left });
        }
    }
}

/// Depth of the deepest leaf.
pub(super) fn max_depth(encoded: &Encoded) -> u32 {
    let mut deepest = 0;
    for_each(encoded, Aabb::EMPTY, |at, _| deepest = deepest.max(at.depth));
    deepest
}

/// How many T-references there are. Every node but the root is one of a pair, so the rest of the array is theirs.
pub(super) fn t_references(encoded: &Encoded) -> u64 {
    let (mut inner, mut leaves) = (0, 0);
    for_each(encoded, Aabb::EMPTY, |_, node| *if node.is_leaf() { &mut leaves } else { &mut inner } += 1);
    encoded.nodes.len() as u64 - inner - leaves
}

/// Ids of a leaf.
fn leaf_ids(encoded: &Encoded, node: Packed) -> impl Iterator<Item = u32> + '_ {
    let first = node.pointer() as usize;
    let (narrow, wide, upper) = if node.is_2byte() {
        (&encoded.indices_2byte[first..][..node.count_2byte() as usize], &[][..], node.upper())
    } else {
        (&[][..], &encoded.indices_4byte[first..][..node.count_4byte() as usize], 0)
    };
    narrow.iter().map(move |&lower| upper | u32::from(lower)).chain(wide.iter().copied())
}

pub(super) fn statistics(tree: &KdTree) -> TreeStatistics {
    let encoded = &tree.encoded;
    let (traversal, intersection) =
        (f64::from(tree.options.sah.traversal), f64::from(tree.options.sah.intersection));
    let mut nodes = NodeCounts::default();
    let mut references = LeafReferences::default();
    let mut t_references = 0;
    let mut leaf_depths = vec![0u64; tree.depth as usize + 1];
    let mut per_triangle = vec![0u32; tree.mesh.len()];
    let mut cost = 0.0;
    for_each(encoded, tree.bounds, |at, node| {
        let area = at.voxel.surface_area();
        if node.is_leaf() {
            let mut count = 0;
            for id in leaf_ids(encoded, node) {
                per_triangle[id as usize] += 1;
                count += 1;
            }
            nodes.leaf += 1;
            nodes.empty_leaf += u64::from(count == 0);
            *if node.is_2byte() { &mut references.two_byte } else { &mut references.four_byte } += count;
            leaf_depths[at.depth as usize] += 1;
            cost += area * intersection * count as f64;
        } else {
            cost += area * traversal;
            if node.has_t_reference() {
                let id = encoded.nodes[node.pointer() as usize + 2].triangle();
                per_triangle[id as usize] += 1;
                nodes.t_inner += 1;
                t_references += 1;
                cost += area * intersection;
            } else {
                nodes.inner += 1;
            }
        }
    });
    let mut duplication = vec![0u64; TreeStatistics::DUPLICATION_INTERVALS.len()];
    for &count in &per_triangle {
        let interval = TreeStatistics::DUPLICATION_INTERVALS.partition_point(|&(_, last)| last < count);
        duplication[interval] += 1;
    }
    duplication[0] -= tree.degenerate; // they are not in the tree by design
    let root_area = tree.bounds.surface_area();
    TreeStatistics {
        triangles: tree.mesh.len() as u64,
        degenerate: tree.degenerate,
        nodes,
        leaf_references: references,
        t_references,
        max_depth: tree.depth,
        leaf_depths,
        duplication,
        sah_cost: if root_area > 0.0 { cost / root_area } else { 0.0 },
    }
}

fn damaged<T>(what: &str) -> Result<T, FileError> {
    Err(FileError::Damaged(what.into()))
}

/// Proves that every pointer of a tree that was read leads somewhere, every id names a triangle, and every node is
/// reached exactly once. Returns the depth.
pub(super) fn validate(encoded: &Encoded, triangles: usize) -> Result<u32, FileError> {
    let mut reached = 0;
    let mut deepest = 0;
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
                if first as usize + count as usize > encoded.indices_4byte.len() {
                    return damaged("a leaf's indices lie outside");
                }
            }
            Node::Leaf2 { first, count, upper } => {
                match encoded.indices_2byte.get(first as usize..first as usize + count as usize) {
                    Some(ids) => ids.iter().try_for_each(|&lower| check_id(upper | u32::from(lower)))?,
                    None => return damaged("a leaf's indices lie outside"),
                }
            }
        }
    }
    if reached == encoded.nodes.len() { Ok(deepest) } else { damaged("nodes are shared or left over") }
}

/// Calls `visit` for every triangle id that a leaf or an inner node of a sound tree names.
pub(super) fn for_each_reference(encoded: &Encoded, mut visit: impl FnMut(u32)) {
    for_each(encoded, Aabb::EMPTY, |_, node| {
        if node.is_leaf() {
            leaf_ids(encoded, node).for_each(&mut visit);
        } else if node.has_t_reference() {
            visit(encoded.nodes[node.pointer() as usize + 2].triangle());
        }
    });
}
