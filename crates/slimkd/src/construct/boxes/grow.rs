//! Splits references from the root down to pairs.

use super::object::{self, ObjectSplit};
use super::reference::{Box4, Reference};
use super::spatial;
use crate::geometry::Clipper;
use crate::job::Job;
use crate::job::memory::push;
use crate::options::BuildError;
use crate::plan::{BoxNode, BoxPlan};
use crate::threads;

/// Nodes of at most so many references are not split: collapsing puts such pairs together again anyway.
const LEAF: usize = 2;
/// Below this many references a node is built by one thread.
const SEQUENTIAL_BELOW: usize = 1 << 13;
/// Fork and join at most this deep.
const PARALLEL_DEPTH: u32 = 40;
/// Planes are tried where both halves of the best division overlap in more than this part of the root's area (Stich et al. 2009, α).
const OVERLAP: f64 = 1e-5;
/// What a part more may cost: a plane must be better than a division by this factor.
const GAIN: f64 = 0.97;

/// What all nodes share.
#[derive(Clone, Copy)]
pub(super) struct Shared<'a> {
    pub(super) job: &'a Job<'a>,
    pub(super) root_area: f64,
    /// Whether triangles may be cut at planes.
    pub(super) cuts: bool,
}

/// A tree whose top was built by all threads.
pub(super) enum Grown {
    Part(BoxPlan),
    Inner { bounds: Box4, halves: Box<(Grown, Grown)> },
}

impl Grown {
    /// Bytes of a plan with all of it, nodes and references.
    fn counts(&self) -> (usize, usize) {
        match self {
            Self::Part(part) => (part.nodes.len(), part.references.len()),
            Self::Inner { halves, .. } => {
                let ((a, b), (c, d)) = (halves.0.counts(), halves.1.counts());
                (a + c + 1, b + d)
            }
        }
    }

    /// Puts it together, and frees the parts on the way.
    pub(super) fn joined(self, job: &Job<'_>) -> Result<BoxPlan, BuildError> {
        let (nodes, references) = self.counts();
        job.memory.take(nodes * size_of::<BoxNode>() + 4 * references)?;
        let mut plan = BoxPlan {
            nodes: crate::job::memory::with_room(nodes)?,
            references: crate::job::memory::with_room(references)?,
        };
        self.append_to(&mut plan);
        Ok(plan)
    }

    /// Its depth is [`PARALLEL_DEPTH`] at most.
    fn append_to(self, plan: &mut BoxPlan) {
        match self {
            Self::Part(part) => plan.append(&part),
            Self::Inner { bounds, halves } => {
                let at = plan.nodes.len();
                plan.nodes.push(BoxNode::inner(bounds.aabb()));
                let (left, right) = *halves;
                left.append_to(plan);
                let right_at = plan.nodes.len();
                plan.nodes[at].set_right(right_at);
                right.append_to(plan);
            }
        }
    }
}

/// What a node's references span: their boxes, and twice their centres.
fn span(references: &[Reference]) -> (Box4, Box4) {
    let (mut bounds, mut centers) = (Box4::EMPTY, Box4::EMPTY);
    for Reference(part) in references {
        bounds.include(part);
        let mut center = [0.0; 4];
        for k in 0..4 {
            center[k] = part.min[k] + part.max[k];
        }
        centers.include_point(center);
    }
    (bounds, centers)
}

/// Both sides of a node that is divided, and room to cut triangles.
#[derive(Default)]
struct Sides {
    clipper: Clipper,
    left: Vec<Reference>,
    right: Vec<Reference>,
}

/// How a node is split.
enum Split {
    Leaf,
    Object(ObjectSplit),
    Spatial(spatial::SpatialSplit),
    /// By position, where all centres are one point.
    Halves,
}

impl Shared<'_> {
    fn choose(&self, references: &[Reference], bounds: &Box4, centers: &Box4, spare: usize) -> Split {
        if references.len() <= LEAF {
            return Split::Leaf;
        }
        let object = object::best(references, centers);
        if self.cuts && spare > 0 {
            let overlap = object.map_or(f64::INFINITY, |split| {
                let mut both = Box4::EMPTY;
                for k in 0..3 {
                    both.min[k] = split.left.min[k].max(split.right.min[k]);
                    both.max[k] = split.left.max[k].min(split.right.max[k]);
                }
                if (0..3).all(|k| both.min[k] <= both.max[k]) { both.half_area() } else { 0.0 }
            });
            if overlap > OVERLAP * self.root_area
                && let Some(plane) = spatial::best(self.job.mesh, references, bounds)
                && object.is_none_or(|split| plane.cost < GAIN * split.cost)
            {
                return Split::Spatial(plane);
            }
        }
        object.map_or(Split::Halves, Split::Object)
    }

    /// Divides a node's references; `false` where `split` does not.
    fn divide(
        &self,
        split: &Split,
        references: impl ExactSizeIterator<Item = Reference>,
        spare: usize,
        clipper: &mut Clipper,
        (left, right): (&mut Vec<Reference>, &mut Vec<Reference>),
    ) -> usize {
        match split {
            Split::Leaf => 0,
            Split::Object(ObjectSplit { axis, below, .. }) => {
                for reference in references {
                    if reference.center(*axis) < *below {
                        left.push(reference)
                    } else {
                        right.push(reference)
                    }
                }
                0
            }
            Split::Spatial(plane) => plane.cut(self.job.mesh, clipper, references, spare, left, right),
            Split::Halves => {
                let half = references.len() / 2;
                for (at, reference) in references.enumerate() {
                    if at < half { left.push(reference) } else { right.push(reference) }
                }
                0
            }
        }
    }

    /// Both sides of a node, and how many parts each may still be cut into. `None` for a leaf.
    fn halves(
        &self,
        references: &[Reference],
        bounds: &Box4,
        centers: &Box4,
        spare: usize,
        sides: &mut Sides,
    ) -> Option<(usize, usize)> {
        let Sides { clipper, left, right } = sides;
        let mut split = self.choose(references, bounds, centers, spare);
        loop {
            if matches!(split, Split::Leaf) {
                return None;
            }
            left.clear();
            right.clear();
            let used = self.divide(&split, references.iter().copied(), spare, clipper, (left, right));
            let (a, b, all) = (left.len(), right.len(), references.len());
            if a > 0 && b > 0 && a < all && b < all {
                let spare = spare - used;
                let part = (spare as u64 * a as u64 / (a + b) as u64) as usize;
                return Some((part, spare - part));
            }
            // A plane that separates nothing after all, or a division whose bins rounded together.
            split = match split {
                Split::Spatial(_) => object::best(references, centers).map_or(Split::Halves, Split::Object),
                _ => Split::Halves,
            };
        }
    }

    /// Builds a node of many references on all threads.
    pub(super) fn grow(
        self,
        references: Vec<Reference>,
        spare: usize,
        depth: u32,
    ) -> Result<Grown, BuildError> {
        self.job.check()?;
        if references.len() < SEQUENTIAL_BELOW || depth >= PARALLEL_DEPTH {
            return Ok(Grown::Part(self.sequential(references, spare)?));
        }
        let (bounds, centers) = span(&references);
        let mut sides = Sides::default();
        let spares = self.halves(&references, &bounds, &centers, spare, &mut sides);
        let Some((a, b)) = spares else { return Ok(Grown::Part(self.sequential(references, spare)?)) };
        let Sides { left, right, .. } = sides;
        self.job.memory.take((left.capacity() + right.capacity()) * size_of::<Reference>())?;
        self.job.memory.give(references.capacity() * size_of::<Reference>());
        drop(references);
        let (left, right) =
            threads::join(move || self.grow(left, a, depth + 1), move || self.grow(right, b, depth + 1));
        Ok(Grown::Inner { bounds, halves: Box::new((left?, right?)) })
    }

    /// Builds a subtree on this thread. Of the references, each node's are the last ones while it is split: its left side is built
    /// first, and lies behind its right side.
    fn sequential(self, mut references: Vec<Reference>, spare: usize) -> Result<BoxPlan, BuildError> {
        /// A node to build: its references begin at `start`; `parent` waits for it as its right child.
        struct Pending {
            start: usize,
            spare: usize,
            parent: Option<usize>,
        }
        let taken = references.capacity() * size_of::<Reference>();
        let mut plan = BoxPlan::default();
        let mut sides = Sides::default();
        let mut pending = vec![Pending { start: 0, spare, parent: None }];
        while let Some(Pending { start, spare, parent }) = pending.pop() {
            let at = plan.nodes.len();
            self.job.check_at(at)?;
            if let Some(parent) = parent {
                plan.nodes[parent].set_right(at);
            }
            let own = &references[start..];
            let (bounds, centers) = span(own);
            match self.halves(own, &bounds, &centers, spare, &mut sides) {
                None => {
                    let first = plan.references.len() as u32;
                    for reference in own {
                        push(&mut plan.references, reference.id())?;
                    }
                    push(&mut plan.nodes, BoxNode::leaf(bounds.aabb(), first, own.len() as u32))?;
                    references.truncate(start);
                }
                Some((a, b)) => {
                    push(&mut plan.nodes, BoxNode::inner(bounds.aabb()))?;
                    references.truncate(start);
                    references.extend_from_slice(&sides.right);
                    let middle = references.len();
                    references.extend_from_slice(&sides.left);
                    push(&mut pending, Pending { start, spare: b, parent: Some(at) })?;
                    push(&mut pending, Pending { start: middle, spare: a, parent: None })?;
                }
            }
        }
        self.job.memory.take(plan.bytes())?;
        self.job.memory.give(taken);
        Ok(plan)
    }
}
