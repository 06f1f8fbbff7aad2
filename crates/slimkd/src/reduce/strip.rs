//! T-references without rebuilding: one top-down pass over the finished tree.
//!
//! Source: Choi, Chang & Ihm 2013 build every subtree anew after a pick and name avoiding that as future work.
//!
//! Deviation: the picked triangle is taken out of the leaves below, and the builder's leaf rule is applied again to
//! the counts that remain. Splits stay where they are. `docs/paper-tree.md` holds the comparison.

use super::measures::Picker;
use super::options::{Hoisting, WhenLeafRemains};
use super::work::Work;
use crate::build::memory::{filled, push};
use crate::build::{BuildError, Builder, Plan, PlanNode};
use crate::geometry::Aabb;

/// Nodes between two looks at whether the build was cancelled, in loops that do not move its progress.
const STRIDE: usize = 1 << 14;

/// Hoists at most one triangle a node, top-down.
pub(crate) fn hoist(
    mut plan: Plan,
    voxel: Aabb,
    hoisting: &Hoisting,
    builder: &Builder<'_>,
    share: f64,
) -> Result<Plan, BuildError> {
    let triangles = builder.mesh().len();
    let (each, mut moved) = (share / plan.nodes.len().max(1) as f64, 0);
    let mut pass = Pass {
        counts: std::mem::take(&mut plan.counts),
        most: most_leaves_of_one(&plan, triangles, builder)?,
        leaves: filled(0, plan.nodes.len())?,
        work: Work::new(plan, &voxel, builder)?,
        marks: Vec::new(),
        leaf_at_most: builder.options().leaf_at_most,
    };
    pass.count_leaves(0, builder)?;
    let mut picker = Picker::new(hoisting, triangles)?;
    let mut at = 0;
    for steps in 0.. {
        if at >= pass.work.plan.nodes.len() {
            break;
        }
        if steps % 64 == 0 {
            builder.check()?;
            builder.progress().advance(each * (at - moved) as f64);
            moved = at;
        }
        match pass.work.plan.nodes[at] {
            PlanNode::Leaf { .. } => at = pass.work.ends[at] as usize,
            PlanNode::Inner { .. } => {
                pass.visit(at, hoisting, &mut picker, builder)?;
                at += 1;
            }
        }
    }
    let Pass { work, .. } = pass; // the rest is freed before the result takes its room
    work.into_plan(builder)
}

/// Per node, the most leaves of the whole tree that hold one and the same triangle of this subtree: an upper bound
/// that rules most large subtrees out.
fn most_leaves_of_one(plan: &Plan, triangles: usize, builder: &Builder<'_>) -> Result<Vec<u32>, BuildError> {
    let mut per_triangle = filled(0u32, triangles)?;
    for (at, &id) in plan.references.iter().enumerate() {
        builder.check_at(at)?;
        per_triangle[id as usize] += 1;
    }
    let mut most = filled(0, plan.nodes.len())?;
    for at in (0..plan.nodes.len()).rev() {
        builder.check_at(at)?;
        most[at] = match plan.nodes[at] {
            PlanNode::Inner { right, .. } => most[at + 1].max(most[right as usize]),
            PlanNode::Leaf { first, count } => {
                let ids = &plan.references[first as usize..(first + count) as usize];
                ids.iter().map(|&id| per_triangle[id as usize]).max().unwrap_or(0)
            }
        };
    }
    Ok(most)
}

struct Pass {
    work: Work,
    /// Distinct triangles under each node.
    counts: Vec<u32>,
    /// Leaves under each node.
    leaves: Vec<u32>,
    /// See [`most_leaves_of_one`]; never updated, so it stays an upper bound.
    most: Vec<u32>,
    /// Scratch: nodes of one subtree that hold the picked triangle, ascending.
    marks: Vec<usize>,
    leaf_at_most: u32,
}

impl Pass {
    fn visit(
        &mut self,
        at: usize,
        hoisting: &Hoisting,
        picker: &mut Picker<'_>,
        builder: &Builder<'_>,
    ) -> Result<(), BuildError> {
        if f64::from(self.most[at]) <= f64::from(hoisting.frequency) * self.least_denominator(at, hoisting) {
            return Ok(());
        }
        let Some(picked) = picker.pick(&self.work, at, builder)? else { return Ok(()) };
        if self.counts[at] - 1 <= self.leaf_at_most {
            match hoisting.when_leaf_remains {
                WhenLeafRemains::MakeLeaf => {
                    let ids = self.work.distinct(at);
                    self.work.make_leaf(at, &ids)?;
                }
                WhenLeafRemains::DropPick => {}
            }
            return Ok(());
        }
        push(&mut self.work.plan.hoisted, (at as u32, picked))?;
        self.strip(at, picked, builder)
    }

    /// The fewest leaves that the frequency measure may divide by.
    fn least_denominator(&self, at: usize, hoisting: &Hoisting) -> f64 {
        match hoisting.leaves {
            super::CountedLeaves::All => f64::from(self.leaves[at]),
            super::CountedLeaves::NotEmpty => 0.0,
        }
    }

    /// Takes `picked` out of the subtree at `at` and ends what the leaf rule ends now.
    fn strip(&mut self, at: usize, picked: u32, builder: &Builder<'_>) -> Result<(), BuildError> {
        self.mark(at, picked, builder)?;
        let mut cut = false;
        for i in 0..self.marks.len() {
            let node = self.marks[i];
            self.counts[node] -= 1;
        }
        let mut i = 0;
        while i < self.marks.len() {
            let node = self.marks[i];
            i += 1;
            if let PlanNode::Inner { .. } = self.work.plan.nodes[node]
                && self.counts[node] <= self.leaf_at_most
            {
                let ids = self.work.distinct(node);
                self.work.make_leaf(node, &ids)?;
                cut = true;
                while self.marks.get(i).is_some_and(|&below| below < self.work.ends[node] as usize) {
                    i += 1;
                }
            }
        }
        if cut {
            self.count_leaves(at, builder)?;
        }
        Ok(())
    }

    /// Removes `picked` from the leaves under `at`; `marks` becomes the nodes that held it, ascending.
    fn mark(&mut self, at: usize, picked: u32, builder: &Builder<'_>) -> Result<(), BuildError> {
        self.marks.clear();
        let end = self.work.ends[at] as usize;
        // The path from `at` down to the node at hand, and how much of it is marked already.
        let mut path: Vec<usize> = Vec::new();
        let mut marked = 0;
        let mut node = at;
        while node < end {
            if node.is_multiple_of(STRIDE) {
                builder.check()?;
            }
            while path.last().is_some_and(|&parent| self.work.ends[parent] as usize <= node) {
                path.pop();
            }
            marked = marked.min(path.len());
            path.push(node);
            match self.work.plan.nodes[node] {
                PlanNode::Inner { .. } => node += 1,
                PlanNode::Leaf { first, count } => {
                    let ids = &mut self.work.plan.references[first as usize..(first + count) as usize];
                    if let Ok(found) = ids.binary_search(&picked) {
                        ids[found..].rotate_left(1);
                        self.work.plan.nodes[node] = PlanNode::Leaf { first, count: count - 1 };
                        self.marks.extend_from_slice(&path[marked..]);
                        marked = path.len();
                    }
                    node = self.work.ends[node] as usize;
                }
            }
        }
        Ok(())
    }

    /// Recounts the leaves of the subtree at `at`.
    fn count_leaves(&mut self, at: usize, builder: &Builder<'_>) -> Result<(), BuildError> {
        // From the back, so that children come first; what lies under a cut is counted in vain.
        for node in (at..self.work.ends[at] as usize).rev() {
            if node.is_multiple_of(STRIDE) {
                builder.check()?;
            }
            self.leaves[node] = match self.work.plan.nodes[node] {
                PlanNode::Inner { right, .. } => self.leaves[node + 1] + self.leaves[right as usize],
                PlanNode::Leaf { .. } => 1,
            };
        }
        Ok(())
    }
}
