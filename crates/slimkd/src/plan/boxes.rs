//! A binary tree of boxes between building and collapsing it into wide nodes.

use crate::geometry::Aabb;

/// One node of a tree of boxes.
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

/// A subtree in preorder.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BoxPlan {
    pub(crate) nodes: Vec<BoxNode>,
    /// Triangle ids of the leaves, in their order: so those of any subtree stand together.
    pub(crate) references: Vec<u32>,
}

impl BoxPlan {
    /// Gives back what it grew by and did not need.
    pub(crate) fn shrink(&mut self) {
        self.nodes.shrink_to_fit();
        self.references.shrink_to_fit();
    }

    /// Bytes that it holds.
    pub(crate) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<BoxNode>() + self.references.capacity() * size_of::<u32>()
    }
}

/// A whole tree as its threads made it: a top, and the subtrees below, each of which was built and is collapsed by one thread.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BoxForest {
    /// In preorder. What a leaf refers to is one of `parts`. No node at all stands for no triangle.
    pub(crate) top: Vec<BoxNode>,
    /// In the order of the top's leaves; none is empty.
    pub(crate) parts: Vec<BoxPlan>,
}

impl BoxForest {
    /// The bounds of all.
    pub(crate) fn bounds(&self) -> Aabb {
        self.top.first().map_or(Aabb::EMPTY, |root| root.bounds)
    }

    /// Bytes that its parts hold.
    pub(crate) fn bytes(&self) -> usize {
        self.parts.iter().map(BoxPlan::bytes).sum()
    }

    /// Nodes of all parts.
    pub(crate) fn nodes(&self) -> usize {
        self.parts.iter().map(|part| part.nodes.len()).sum()
    }
}
