//! Passes over a whole encoded tree of either layout: depth, counts, statistics.

use super::KdTree;
use super::statistics::{LeafReferences, NodeCounts, TreeStatistics};
use crate::geometry::Aabb;
use crate::job::Progress;
use crate::layout::{Address, Inner, Nodes, Step, with_nodes};
use crate::options::BuildError;

/// A node that a walk visits.
pub(super) struct Visit {
    pub(super) address: Address,
    depth: u32,
    voxel: Aabb,
}

/// Calls `visit` for every node, parents before children.
pub(super) fn for_each<N: Nodes>(nodes: N, root: Aabb, mut visit: impl FnMut(&Visit, Step<N::Leaf>)) {
    let planes = nodes.planes();
    let mut pending = vec![Visit { address: Address::ROOT, depth: 0, voxel: root }];
    while let Some(at) = pending.pop() {
        // SAFETY: the address is the root's or that of a child of a node of this tree.
        let node = unsafe { nodes.node(at.address) };
        visit(&at, node);
        if let Step::Inner(inner) = node {
            let (left, right) = at.voxel.split(inner.axis, planes.world(inner.axis, inner.split));
            let depth = at.depth + 1;
            pending.push(Visit { address: inner.right(), depth, voxel: right });
            pending.push(Visit { address: inner.left(), depth, voxel: left });
        }
    }
}

/// Depth of the deepest leaf.
pub(super) fn max_depth(tree: &KdTree, progress: &Progress) -> Result<u32, BuildError> {
    with_nodes!(tree, nodes => {
        let (mut deepest, mut visited) = (0, 0);
        let mut pending = vec![(Address::ROOT, 0)];
        while let Some((address, depth)) = pending.pop() {
            progress.check_at(visited)?;
            visited += 1;
            deepest = deepest.max(depth);
            // SAFETY: the address is the root's or that of a child of a node of this tree.
            if let Step::Inner(inner) = unsafe { nodes.node(address) } {
                pending.extend([(inner.right(), depth + 1), (inner.left(), depth + 1)]);
            }
        }
        Ok(deepest)
    }, _wide => Ok(tree.depth))
}

/// How many T-references there are.
pub(super) fn t_references(tree: &KdTree) -> u64 {
    let mut count = 0;
    with_nodes!(tree, nodes => for_each(nodes, Aabb::EMPTY, |_, node| {
        count += u64::from(matches!(node, Step::Inner(Inner { t_reference: Some(_), .. })));
    }), _wide => {});
    count
}

pub(super) fn statistics(tree: &KdTree) -> TreeStatistics {
    with_nodes!(tree, nodes => statistics_of(tree, nodes), wide => super::boxes::statistics(tree, wide))
}

fn statistics_of<N: Nodes>(tree: &KdTree, view: N) -> TreeStatistics {
    let (traversal, intersection) =
        (f64::from(tree.options.sah.traversal), f64::from(tree.options.sah.intersection));
    let mut nodes = NodeCounts::default();
    let mut references = LeafReferences::default();
    let mut t_references = 0;
    let mut leaf_depths = vec![0u64; tree.depth as usize + 1];
    let mut per_triangle = vec![0u32; tree.mesh.len()];
    let mut cost = 0.0;
    for_each(view, tree.bounds, |at, node| {
        let area = at.voxel.surface_area();
        match node {
            Step::Leaf(leaf) => {
                let mut count = 0;
                let count_one = |id| {
                    per_triangle[id as usize] += 1;
                    count += 1;
                };
                // SAFETY: the leaf comes from this tree.
                unsafe { view.for_each(leaf, count_one) };
                nodes.leaf += 1;
                nodes.empty_leaf += u64::from(count == 0);
                *references.of(N::mode(leaf)) += count;
                leaf_depths[at.depth as usize] += 1;
                cost += area * intersection * count as f64;
            }
            Step::Inner(Inner { t_reference, .. }) => {
                cost += area * traversal;
                if let Some(id) = t_reference {
                    per_triangle[id as usize] += 1;
                    nodes.t_inner += 1;
                    t_references += 1;
                    cost += area * intersection;
                } else {
                    nodes.inner += 1;
                }
            }
        }
    });
    let root_area = tree.bounds.surface_area();
    TreeStatistics {
        triangles: tree.mesh.len() as u64,
        degenerate: tree.degenerate,
        nodes,
        leaf_references: references,
        t_references,
        max_depth: tree.depth,
        leaf_depths,
        duplication: TreeStatistics::intervals(&per_triangle, tree.degenerate),
        sah_cost: if root_area > 0.0 { cost / root_area } else { 0.0 },
    }
}

/// Calls `visit` for every triangle id that a leaf or an inner node names.
pub(crate) fn for_each_reference(tree: &KdTree, mut visit: impl FnMut(u32)) {
    with_nodes!(tree, nodes => for_each(nodes, Aabb::EMPTY, |_, node| match node {
        // SAFETY: the leaf comes from this tree.
        Step::Leaf(leaf) => unsafe { nodes.for_each(leaf, &mut visit) },
        Step::Inner(Inner { t_reference, .. }) => t_reference.into_iter().for_each(&mut visit),
    }), wide => super::boxes::for_each_reference(wide, visit));
}
