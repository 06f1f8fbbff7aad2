//! A binary tree of boxes between building and collapsing it into wide nodes.

use crate::geometry::Aabb;

/// One node of a [`BoxPlan`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoxNode {
    /// What the subtree refers to, clipped to where it refers to it.
    pub(crate) bounds: Aabb,
    /// An inner node's right child, a leaf's first reference.
    at: u32,
    /// A leaf's references; 0 for an inner node, whose left child is the next node.
    count: u32,
}

impl BoxNode {
    /// An inner node whose right child is not known yet.
    pub(crate) fn inner(bounds: Aabb) -> Self {
        Self { bounds, at: 0, count: 0 }
    }

    pub(crate) fn leaf(bounds: Aabb, first: u32, count: u32) -> Self {
        debug_assert!(count > 0);
        Self { bounds, at: first, count }
    }

    /// Where an inner node's right child stands; `None` for a leaf.
    pub(crate) fn right(&self) -> Option<usize> {
        (self.count == 0).then_some(self.at as usize)
    }

    pub(crate) fn set_right(&mut self, right: usize) {
        self.at = right as u32;
    }

    /// A leaf's references; empty for an inner node.
    pub(crate) fn references(&self) -> std::ops::Range<usize> {
        let first = if self.count == 0 { 0 } else { self.at as usize };
        first..first + self.count as usize
    }
}

/// A whole tree of boxes in preorder. No node at all stands for no triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BoxPlan {
    pub(crate) nodes: Vec<BoxNode>,
    /// Triangle ids of the leaves, in their order: so those of any subtree stand together.
    pub(crate) references: Vec<u32>,
}

impl BoxPlan {
    /// Bytes that it holds.
    pub(crate) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<BoxNode>() + self.references.capacity() * size_of::<u32>()
    }

    /// Appends a subtree that was built on its own.
    pub(crate) fn append(&mut self, subtree: &Self) {
        let (nodes, references) = (self.nodes.len() as u32, self.references.len() as u32);
        self.nodes.extend(
            subtree.nodes.iter().map(|node| BoxNode {
                at: node.at + if node.count == 0 { nodes } else { references },
                ..*node
            }),
        );
        self.references.extend_from_slice(&subtree.references);
    }
}
