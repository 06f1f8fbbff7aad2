//! The tree between building and encoding: nodes in depth-first order, leaves with their triangle ids.
//!
//! `right` and `first` count from the node array's and the reference array's start, so a subtree that was built on
//! its own is appended by shifting them.

mod boxes;
mod collapse;
mod price;
mod weight;
mod widen;
mod work;

pub(crate) use boxes::{BoxForest, BoxNode, BoxPlan};
pub(crate) use collapse::{Totals, UnitBytes, collapse, collapse_subtree};
pub(crate) use price::Price;
pub(crate) use weight::search_weight;
pub(crate) use widen::{Child, MOST, Widened, widen};
pub(crate) use work::{Part, Work};

use crate::job::memory::copied;
use crate::options::BuildError;

/// One node of a [`Plan`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PlanNode {
    /// The left child is the next node, the right one stands at `right`.
    Inner { axis: u8, split: f32, right: u32 },
    /// Triangle ids `references[first..first + count]`, ascending.
    Leaf { first: u32, count: u32 },
}

impl PlanNode {
    /// This node as it reads once so many other nodes and references stand before its subtree.
    pub(crate) fn shifted(self, nodes: u32, references: u32) -> Self {
        match self {
            Self::Inner { axis, split, right } => Self::Inner { axis, split, right: right + nodes },
            Self::Leaf { first, count } => Self::Leaf { first: first + references, count },
        }
    }
}

/// A whole tree before encoding. Never without a node.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Plan {
    pub(crate) nodes: Vec<PlanNode>,
    pub(crate) references: Vec<u32>,
    /// Triangles under each node before any hoisting; empty unless the reduction asks for it.
    pub(crate) counts: Vec<u32>,
    /// T-references as (node, triangle), ascending by node.
    pub(crate) hoisted: Vec<(u32, u32)>,
    /// The price at which the builder collapsed it, if it did.
    pub(crate) price: Option<Price>,
}

impl Plan {
    /// Bytes that it holds.
    pub(crate) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<PlanNode>()
            + (self.references.capacity() + self.counts.capacity()) * size_of::<u32>()
            + self.hoisted.capacity() * size_of::<(u32, u32)>()
    }

    /// A copy, or no memory for it.
    pub(crate) fn copied(&self) -> Result<Self, BuildError> {
        Ok(Self {
            nodes: copied(&self.nodes)?,
            references: copied(&self.references)?,
            counts: copied(&self.counts)?,
            hoisted: copied(&self.hoisted)?,
            price: self.price,
        })
    }

    /// Appends a subtree that was built on its own.
    pub(crate) fn append(&mut self, subtree: &Plan) {
        let (nodes, references) = (self.nodes.len() as u32, self.references.len() as u32);
        self.nodes.extend(subtree.nodes.iter().map(|node| node.shifted(nodes, references)));
        self.references.extend_from_slice(&subtree.references);
        self.counts.extend_from_slice(&subtree.counts);
        self.hoisted.extend(subtree.hoisted.iter().map(|&(node, triangle)| (node + nodes, triangle)));
    }
}
