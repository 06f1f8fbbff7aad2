//! One top-down pass over a tree, or over a part of it.

use super::super::measures::Picker;
use crate::job::Job;
use crate::job::memory::{copied, filled, push, with_room};
use crate::options::BuildError;
use crate::options::Hoisting;
use crate::plan::Work;
use crate::plan::{Plan, PlanNode};

/// Nodes between two looks at whether the build was cancelled, in loops that do not move its progress.
const STRIDE: usize = 1 << 14;

/// A tree on its way to T-references.
pub(super) struct Pass {
    pub(super) work: Work,
    /// Distinct triangles under each node.
    counts: Vec<u32>,
    /// Leaves under each node.
    leaves: Vec<u32>,
    /// See [`most_leaves_of_one`](super::most_leaves_of_one); never updated, so it stays an upper bound.
    most: Vec<u32>,
    /// Scratch: nodes of one subtree that hold the picked triangle, ascending.
    marks: Vec<usize>,
    leaf_at_most: u32,
}

impl Pass {
    /// `counts` and `most` are per node.
    pub(super) fn new(
        work: Work,
        counts: Vec<u32>,
        most: Vec<u32>,
        job: &Job<'_>,
    ) -> Result<Self, BuildError> {
        let leaves = filled(0, most.len())?;
        let leaf_at_most = job.options.leaf_at_most;
        let mut pass = Self { work, counts, leaves, most, marks: Vec::new(), leaf_at_most };
        pass.count_leaves(0, job)?;
        Ok(pass)
    }

    /// The subtree at `root` alone, whose nodes are `nodes`.
    pub(super) fn part(&self, root: usize, nodes: &[PlanNode]) -> Result<Self, BuildError> {
        let range = root..root + nodes.len();
        let held = nodes
            .iter()
            .map(|node| if let PlanNode::Leaf { count, .. } = *node { count as usize } else { 0 });
        let mut plan = Plan { nodes: copied(nodes)?, references: with_room(held.sum())?, ..Plan::default() };
        for node in &mut plan.nodes {
            match node {
                PlanNode::Inner { right, .. } => *right -= root as u32,
                PlanNode::Leaf { first, count } => {
                    let ids = self.work.ids(*first, *count);
                    *first = plan.references.len() as u32;
                    plan.references.extend_from_slice(ids);
                }
            }
        }
        let mut ends = copied(&self.work.ends[range.clone()])?;
        ends.iter_mut().for_each(|end| *end -= root as u32);
        Ok(Self {
            work: Work { plan, ends, areas: copied(&self.work.areas[range.clone()])? },
            counts: copied(&self.counts[range.clone()])?,
            leaves: copied(&self.leaves[range.clone()])?,
            most: copied(&self.most[range])?,
            marks: Vec::new(),
            leaf_at_most: self.leaf_at_most,
        })
    }

    /// Hoists at most one triangle a node, but for subtrees of at most `leave` nodes: these are left, and returned, ascending.
    /// Moves the progress by `each` a node.
    pub(super) fn run(
        &mut self,
        hoisting: &Hoisting,
        picker: &mut Picker<'_>,
        job: &Job<'_>,
        leave: usize,
        each: f64,
    ) -> Result<Vec<usize>, BuildError> {
        let (mut at, mut visited, mut left) = (0, 0, Vec::new());
        for steps in 0.. {
            if at >= self.work.plan.nodes.len() {
                break;
            }
            if steps % 64 == 63 {
                job.check()?;
                job.progress.advance(each * f64::from(visited));
                visited = 0;
            }
            let end = self.work.ends[at] as usize;
            match self.work.plan.nodes[at] {
                PlanNode::Leaf { .. } => {
                    visited += (end - at) as u32;
                    at = end;
                }
                PlanNode::Inner { .. } if end - at <= leave => {
                    push(&mut left, at)?;
                    at = end;
                }
                PlanNode::Inner { .. } => {
                    self.visit(at, hoisting, picker, job)?;
                    visited += 1;
                    at += 1;
                }
            }
        }
        job.progress.advance(each * f64::from(visited));
        Ok(left)
    }

    fn visit(
        &mut self,
        at: usize,
        hoisting: &Hoisting,
        picker: &mut Picker<'_>,
        job: &Job<'_>,
    ) -> Result<(), BuildError> {
        if f64::from(self.most[at]) <= f64::from(hoisting.frequency) * f64::from(self.leaves[at]) {
            return Ok(());
        }
        let Some(picked) = picker.pick(&self.work, at, job)? else { return Ok(()) };
        if self.counts[at] - 1 <= self.leaf_at_most {
            // Where only a leaf would remain, the node becomes a leaf of all its triangles, the picked one included.
            let ids = self.work.distinct(at);
            return self.work.make_leaf(at, &ids);
        }
        push(&mut self.work.plan.hoisted, (at as u32, picked))?;
        self.strip(at, picked, job)
    }

    /// Takes `picked` out of the subtree at `at` and ends what the leaf rule ends now.
    fn strip(&mut self, at: usize, picked: u32, job: &Job<'_>) -> Result<(), BuildError> {
        self.mark(at, picked, job)?;
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
            self.count_leaves(at, job)?;
        }
        Ok(())
    }

    /// Removes `picked` from the leaves under `at`; `marks` becomes the nodes that held it, ascending.
    fn mark(&mut self, at: usize, picked: u32, job: &Job<'_>) -> Result<(), BuildError> {
        self.marks.clear();
        let end = self.work.ends[at] as usize;
        // The path from `at` down to the node at hand, and how much of it is marked already.
        let mut path: Vec<usize> = Vec::new();
        let mut marked = 0;
        let mut node = at;
        while node < end {
            if node.is_multiple_of(STRIDE) {
                job.check()?;
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
    fn count_leaves(&mut self, at: usize, job: &Job<'_>) -> Result<(), BuildError> {
        // From the back, so that children come first; what lies under a cut is counted in vain.
        for node in (at..self.work.ends[at] as usize).rev() {
            if node.is_multiple_of(STRIDE) {
                job.check()?;
            }
            self.leaves[node] = match self.work.plan.nodes[node] {
                PlanNode::Inner { right, .. } => self.leaves[node + 1] + self.leaves[right as usize],
                PlanNode::Leaf { .. } => 1,
            };
        }
        Ok(())
    }
}
