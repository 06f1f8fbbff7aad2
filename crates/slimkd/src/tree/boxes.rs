//! Passes over a whole wide tree: counts and statistics. `walk.rs` has those over trees of planes.

use super::KdTree;
use super::statistics::{LeafReferences, NodeCounts, TreeStatistics};
use crate::geometry::Aabb;
use crate::layout::{Address, Ids, WideNode, WideView};

/// Calls `visit` for every node with its depth, parents before children.
pub(super) fn for_each_node(nodes: WideView<'_>, mut visit: impl FnMut(&WideNode, u32)) {
    let mut pending = vec![(Address::ROOT, 0)];
    while let Some((at, depth)) = pending.pop() {
        // SAFETY: the address is the root's or that of an inner child of a node of this tree.
        let node = unsafe { nodes.node(at) };
        visit(node, depth);
        for lane in (0..node.inner()).rev() {
            // SAFETY: the lane is that of an inner child.
            pending.push((unsafe { nodes.child(node, lane) }, depth + 1));
        }
    }
}

/// Calls `visit` with the ids of a leaf.
pub(super) fn with_ids<R>(
    nodes: WideView<'_>,
    node: &WideNode,
    lane: usize,
    visit: impl FnOnce(&[u32]) -> R,
) -> R {
    debug_assert!((node.inner()..node.children()).contains(&lane));
    let mut buffer = Ids::new();
    // SAFETY: the node comes from this tree, and the lane is that of a leaf.
    visit(unsafe { nodes.ids(node, lane, &mut buffer) })
}

/// Calls `visit` for every triangle id that a leaf names.
pub(super) fn for_each_reference(nodes: WideView<'_>, mut visit: impl FnMut(u32)) {
    for_each_node(nodes, |node, _| {
        for lane in node.inner()..node.children() {
            with_ids(nodes, node, lane, |ids| ids.iter().for_each(|&id| visit(id)));
        }
    });
}

pub(super) fn statistics(tree: &KdTree, view: WideView<'_>) -> TreeStatistics {
    let sah = &tree.options.sah;
    let (traversal, intersection) = (f64::from(sah.traversal), f64::from(sah.intersection));
    let mut nodes = NodeCounts::default();
    let mut references = LeafReferences::default();
    let mut leaf_depths = vec![0u64; tree.depth as usize + 1];
    let mut per_triangle = vec![0u32; tree.mesh.len()];
    let root_area = tree.bounds.surface_area();
    let mut cost = traversal * root_area;
    for_each_node(view, |node, depth| {
        nodes.inner += 1;
        for lane in 0..node.children() {
            let [min, max] = node.bounds(lane, view.grid()).map(|corner| corner.map(|x| x as f32));
            let area = Aabb { min, max }.surface_area();
            if lane < node.inner() {
                cost += area * traversal;
                continue;
            }
            let count = with_ids(view, node, lane, |ids| {
                ids.iter().for_each(|&id| per_triangle[id as usize] += 1);
                ids.len() as u64
            });
            nodes.leaf += 1;
            references.other += count;
            leaf_depths[depth as usize + 1] += 1;
            cost += area * intersection * count as f64;
        }
    });
    TreeStatistics {
        triangles: tree.mesh.len() as u64,
        degenerate: tree.degenerate,
        nodes,
        leaf_references: references,
        t_references: 0,
        max_depth: leaf_depths.iter().rposition(|&leaves| leaves > 0).unwrap_or(0) as u32,
        duplication: TreeStatistics::intervals(&per_triangle, tree.degenerate),
        leaf_depths,
        sah_cost: if root_area > 0.0 { cost / root_area } else { 0.0 },
    }
}
