//! Splits references from the root down to pairs.

use super::object::{self, ObjectSplit, Place};
use super::reference::{Box4, Reference};
use super::spatial::{self, SpatialSplit};
use crate::geometry::Clipper;
use crate::job::Job;
use crate::job::memory::{push, room, stretch};
use crate::options::{BuildError, Splits};
use crate::plan::{BoxForest, BoxNode, BoxPlan, MOST};
use crate::threads;

/// Nodes of at most so many references are not split: collapsing puts such pairs together again anyway.
const LEAF: usize = 2;
/// Below this many references a node is built by one thread.
const SEQUENTIAL_BELOW: usize = 1 << 13;
/// From this many references on, a node's bins are filled by all threads, so many references at a time.
const SHARED_FROM: usize = 1 << 16;
const SHARE: usize = 1 << 13;
/// Fork and join at most this deep.
const PARALLEL_DEPTH: u32 = 40;
/// Planes are tried where both halves of the best division overlap in more than this part of the root's area (Stich et al. 2009 §4.5: α), and of
/// the node's. At their 10⁻⁵, and without the other, builds take a quarter longer, for 0.2 % less SAH cost at 2 % more bytes.
const OVERLAP: f64 = 1e-4;
const OWN_OVERLAP: f64 = 0.05;
/// What a part more may cost: a plane must be better than a division by this factor.
const GAIN: f64 = 0.97;

/// What all nodes share.
#[derive(Clone, Copy)]
pub(super) struct Shared<'a> {
    pub(super) job: &'a Job<'a>,
    pub(super) root_area: f64,
    pub(super) splits: Splits,
    /// The share of a triangle in the build's time.
    pub(super) share: f64,
}

/// A tree whose top was built by all threads.
pub(super) enum Grown {
    Part(BoxPlan),
    Inner { bounds: Box4, halves: Box<(Grown, Grown)> },
}

impl Grown {
    /// Appends it to a forest. Its depth is [`PARALLEL_DEPTH`] at most.
    pub(super) fn append_to(self, forest: &mut BoxForest) -> Result<(), BuildError> {
        let at = forest.top.len();
        match self {
            Self::Part(part) => {
                push(&mut forest.top, BoxNode::leaf(part.nodes[0].bounds, forest.parts.len() as u32, 1))?;
                push(&mut forest.parts, part)
            }
            Self::Inner { bounds, halves } => {
                push(&mut forest.top, BoxNode::inner(bounds.aabb()))?;
                let (left, right) = *halves;
                left.append_to(forest)?;
                let right_at = forest.top.len();
                forest.top[at].set_right(right_at);
                right.append_to(forest)
            }
        }
    }
}

/// What a node's references span: their boxes, and twice their centres.
fn span(references: &[Reference]) -> (Box4, Box4) {
    let (mut bounds, mut centers) = (Box4::EMPTY, Box4::EMPTY);
    for reference in references {
        bounds.include(&reference.0);
        centers.include_point(reference.centers());
    }
    (bounds, centers)
}

/// Room for one thread to divide nodes.
#[derive(Default)]
struct Room {
    clipper: Clipper,
    /// References that go left are the first ones; the others are what earlier nodes left there.
    left: Vec<Reference>,
}

/// What dividing a node came to.
struct Divided {
    /// References of the left side.
    left: usize,
    /// Triangles that were cut.
    cut: usize,
}

/// How a node is split.
enum Split {
    Leaf,
    Object(ObjectSplit),
    Spatial(SpatialSplit),
    /// By position, where all centres are one point.
    Halves,
}

impl Shared<'_> {
    fn choose(&self, references: &[Reference], bounds: &Box4, centers: &Box4, spare: usize) -> Split {
        if references.len() <= LEAF {
            return Split::Leaf;
        }
        if self.splits == Splits::Space {
            return self.choose_plane(references, bounds, centers, spare);
        }
        let object = divided(references, centers);
        if spare > 0 {
            let overlap = object.map_or(f64::INFINITY, |split| {
                let both = split.left.cut_to(&split.right);
                if both.is_empty() { 0.0 } else { both.half_area() }
            });
            if overlap > (OVERLAP * self.root_area).max(OWN_OVERLAP * bounds.half_area())
                && let Some(plane) = Self::plane(references, bounds)
                && object.is_none_or(|split| plane.cost < GAIN * split.cost)
            {
                return Split::Spatial(plane);
            }
        }
        object.map_or(Split::Halves, Split::Object)
    }

    /// A plane wherever one pays by the surface area heuristic of a kd-tree, which ends where cutting on makes more parts than it separates.
    fn choose_plane(&self, references: &[Reference], bounds: &Box4, centers: &Box4, spare: usize) -> Split {
        let sah = &self.job.options.sah;
        let (traversal, intersection) = (f64::from(sah.traversal), f64::from(sah.intersection));
        let count = references.len();
        let pays = |plane: &SpatialSplit| {
            let cut = (plane.left.count + plane.right.count) as usize - count;
            let area = bounds.half_area();
            cut <= spare && traversal * area + intersection * plane.cost < intersection * area * count as f64
        };
        match Self::plane(references, bounds).filter(pays) {
            Some(plane) => Split::Spatial(plane),
            None if count <= MOST => Split::Leaf,
            None => divided(references, centers).map_or(Split::Halves, Split::Object),
        }
    }

    /// The best plane.
    fn plane(references: &[Reference], bounds: &Box4) -> Option<SpatialSplit> {
        let grid = spatial::Bins::grid(bounds);
        if references.len() < SHARED_FROM {
            let mut bins = spatial::Bins::EMPTY;
            bins.add(&grid, references);
            return bins.best(&grid, references.len());
        }
        let bins = in_shares(
            references,
            || spatial::Bins::EMPTY,
            |bins, share| bins.add(&grid, share),
            spatial::Bins::join,
        );
        bins.best(&grid, references.len())
    }

    /// Divides the references from `start` on: those of the right side stay, those of the left side go to `room`. Either has fewer.
    fn divide(
        &self,
        split: &Split,
        references: &mut Vec<Reference>,
        start: usize,
        spare: usize,
        room: &mut Room,
    ) -> Result<Divided, BuildError> {
        let count = references.len() - start;
        let Room { clipper, left } = room;
        stretch(left, count)?;
        let own = &mut references[start..];
        let (left, cut) = match split {
            Split::Object(ObjectSplit { axis, place: Place::Bin(grid, bin), .. }) => {
                (partition(own, left, |_, one| grid.bin(*axis, one.center(*axis)) < *bin), 0)
            }
            Split::Object(ObjectSplit { axis, place: Place::Center(below), .. }) => {
                (partition(own, left, |_, one| one.center(*axis) < *below), 0)
            }
            // By position.
            Split::Halves | Split::Leaf => (partition(own, left, |at, _| at < count / 2), 0),
            Split::Spatial(plane) => {
                let unsplits = self.splits == Splits::Both;
                let cut = plane.cut(self.job.mesh, clipper, spare, unsplits);
                let (on_left, on_right, cut) = cut.divide(plane, own, left);
                references.truncate(start + on_right);
                return Ok(Divided { left: on_left, cut });
            }
        };
        references.truncate(start + count - left);
        Ok(Divided { left, cut })
    }

    /// Builds a node of many references on all threads.
    pub(super) fn grow(
        self,
        mut references: Vec<Reference>,
        spare: usize,
        depth: u32,
    ) -> Result<Grown, BuildError> {
        self.job.check()?;
        if references.len() < SEQUENTIAL_BELOW || depth >= PARALLEL_DEPTH {
            return Ok(Grown::Part(self.sequential(references, spare)?));
        }
        let (bounds, centers) = span(&references);
        let split = self.choose(&references, &bounds, &centers, spare);
        // Room for all on the left side, of which only what is needed is kept.
        let held = (references.capacity() + references.len()) * size_of::<Reference>();
        self.job.memory.take(references.len() * size_of::<Reference>())?;
        let mut room = Room::default();
        let divided = self.divide(&split, &mut references, 0, spare, &mut room)?;
        let Room { mut left, .. } = room;
        left.truncate(divided.left);
        left.shrink_to_fit();
        references.shrink_to_fit();
        self.job.memory.give(held - (left.capacity() + references.capacity()) * size_of::<Reference>());
        let (a, b) = shared(spare - divided.cut, left.len(), references.len());
        let (left, right) =
            threads::join(move || self.grow(left, a, depth + 1), move || self.grow(references, b, depth + 1));
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
        let share = self.share * references.len() as f64;
        let mut plan = BoxPlan::default();
        let mut sides = Room::default();
        let mut pending = vec![Pending { start: 0, spare, parent: None }];
        while let Some(Pending { start, spare, parent }) = pending.pop() {
            let at = plan.nodes.len();
            self.job.check_at(at)?;
            if let Some(parent) = parent {
                plan.nodes[parent].set_right(at);
            }
            let own = &references[start..];
            let (bounds, centers) = span(own);
            let split = self.choose(own, &bounds, &centers, spare);
            if let Split::Leaf = split {
                let first = plan.references.len() as u32;
                for reference in own {
                    push(&mut plan.references, reference.id())?;
                }
                push(&mut plan.nodes, BoxNode::leaf(bounds.aabb(), first, own.len() as u32))?;
                references.truncate(start);
                continue;
            }
            push(&mut plan.nodes, BoxNode::inner(bounds.aabb()))?;
            let divided = self.divide(&split, &mut references, start, spare, &mut sides)?;
            let middle = references.len();
            room(&mut references, divided.left)?;
            references.extend_from_slice(&sides.left[..divided.left]);
            let (a, b) = shared(spare - divided.cut, divided.left, middle - start);
            push(&mut pending, Pending { start, spare: b, parent: Some(at) })?;
            push(&mut pending, Pending { start: middle, spare: a, parent: None })?;
        }
        self.job.progress.advance(share);
        plan.shrink();
        self.job.memory.take(plan.bytes())?;
        self.job.memory.give(taken);
        Ok(plan)
    }
}

/// The best division into two sets; `None` where all centres are one point.
fn divided(references: &[Reference], centers: &Box4) -> Option<ObjectSplit> {
    if references.len() <= object::SWEPT {
        return object::sweep(references);
    }
    let grid = object::Bins::grid(centers);
    if references.len() < SHARED_FROM {
        let mut bins = object::Bins::EMPTY;
        bins.add(&grid, references);
        return bins.best(&grid);
    }
    let bins = in_shares(
        references,
        || object::Bins::EMPTY,
        |bins, share| bins.add(&grid, share),
        object::Bins::join,
    );
    bins.best(&grid)
}

/// Bins of many references, filled by all threads.
fn in_shares<B: Send>(
    references: &[Reference],
    empty: impl Fn() -> B + Sync + Send,
    add: impl Fn(&mut B, &[Reference]) + Sync + Send,
    join: impl Fn(&mut B, &B) + Sync + Send,
) -> B {
    let shares: Vec<&[Reference]> = references.chunks(SHARE).collect();
    let add_one = |mut bins: Box<B>, share: &&[Reference]| {
        add(&mut bins, share);
        Ok::<_, std::convert::Infallible>(bins)
    };
    let join = |mut bins: Box<B>, other: Box<B>| {
        join(&mut bins, &other);
        Ok(bins)
    };
    let Ok(bins) = threads::fold(&shares, || Box::new(empty()), add_one, join);
    bins.map_or_else(empty, |bins| *bins)
}

/// How many triangles each side may still cut.
fn shared(spare: usize, left: usize, right: usize) -> (usize, usize) {
    let part = (spare as u64 * left as u64 / (left + right).max(1) as u64) as usize;
    (part, spare - part)
}

/// Copies the references that go left to `left`, which has room for all, and moves the others to the front. Returns how many go left.
#[inline(always)]
fn partition(
    references: &mut [Reference],
    left: &mut [Reference],
    goes_left: impl Fn(usize, &Reference) -> bool,
) -> usize {
    // Without branches, which nobody could foresee: each is written to both sides, and stays on one.
    let (mut to_left, mut kept) = (0, 0);
    for at in 0..references.len() {
        let reference = references[at];
        let is_left = goes_left(at, &reference);
        left[to_left] = reference;
        references[kept] = reference;
        to_left += usize::from(is_left);
        kept += usize::from(!is_left);
    }
    to_left
}
