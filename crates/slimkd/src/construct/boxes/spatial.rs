//! The best plane to cut a node's references at, where that is better than any division of them.
//!
//! Source: Stich, Friedrich & Dietrich 2009, *Spatial Splits in Bounding Volume Hierarchies*, §4.
//!
//! Deviations
//! 1. What a bin holds of a triangle is bounded by the box of its reference, cut at the bin's planes, not by the cut triangle: bins only choose
//!    the plane. On five scenes, that costs 0.3 % of SAH cost in the median and 0.5 % at most, and takes half the time.
//! 2. The cut itself is `geometry/clip.rs`'s, whose boxes are rounded outwards: together, they hold the whole part.
//! 3. A plane must leave something whole on each side, so that both sides have fewer references than the node.

use super::reference::{Box4, Grid, Reference};
use crate::geometry::{Aabb, Clipper, TriangleMesh};

/// Bins an axis: with 16, SAH costs are up to 1 % higher, and builds 15 to 25 % faster.
const BINS: usize = 32;

/// A plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpatialSplit {
    /// Sum over both sides of half the surface area times references.
    pub(super) cost: f64,
    pub(super) axis: usize,
    grid: Grid,
    /// The first bin on its right.
    bin: u32,
    pub(super) left: Side,
    pub(super) right: Side,
}

/// What lies on a side of a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) bounds: Box4,
    pub(super) count: u32,
}

/// The boxes of all axes' bins, and how many references begin and end in each.
pub(super) struct Bins {
    boxes: [[Box4; BINS]; 3],
    entries: [[u32; BINS]; 3],
    exits: [[u32; BINS]; 3],
}

impl Bins {
    pub(super) const EMPTY: Self =
        Self { boxes: [[Box4::EMPTY; BINS]; 3], entries: [[0; BINS]; 3], exits: [[0; BINS]; 3] };

    pub(super) fn grid(bounds: &Box4) -> Grid {
        Grid::new(bounds, BINS)
    }

    pub(super) fn add(&mut self, grid: &Grid, references: &[Reference]) {
        for reference in references {
            let Reference(part) = reference;
            let (first, last) = (grid.bins(&part.min), grid.bins(&part.max));
            for k in 0..3 {
                let (first, last) = (first[k] as usize % BINS, last[k] as usize % BINS);
                self.entries[k][first] += 1;
                self.exits[k][last] += 1;
                if first == last {
                    self.boxes[k][first].include(part);
                } else {
                    chop(part, k, grid, &mut self.boxes[k][first..=last], first);
                }
            }
        }
    }

    pub(super) fn join(&mut self, other: &Self) {
        for k in 0..3 {
            for at in 0..BINS {
                self.boxes[k][at].include(&other.boxes[k][at]);
                self.entries[k][at] += other.entries[k][at];
                self.exits[k][at] += other.exits[k][at];
            }
        }
    }

    /// The best plane; `None` where none separates anything.
    pub(super) fn best(&self, grid: &Grid, references: usize) -> Option<SpatialSplit> {
        let mut best: Option<SpatialSplit> = None;
        for axis in (0..3).filter(|&axis| grid.has(axis)) {
            let boxes = &self.boxes[axis];
            let mut rights = [Side { bounds: Box4::EMPTY, count: 0 }; BINS];
            let mut right = Side { bounds: Box4::EMPTY, count: 0 };
            for at in (1..BINS).rev() {
                right.bounds.include(&boxes[at]);
                right.count += self.exits[axis][at];
                rights[at] = right;
            }
            let mut left = Side { bounds: Box4::EMPTY, count: 0 };
            for at in 1..BINS {
                left.bounds.include(&boxes[at - 1]);
                left.count += self.entries[axis][at - 1];
                let right = rights[at];
                let whole = |side: Side| (side.count as usize) < references;
                if !whole(left) || !whole(right) {
                    continue;
                }
                let cost = left.bounds.half_area() * f64::from(left.count)
                    + right.bounds.half_area() * f64::from(right.count);
                if best.as_ref().is_none_or(|best| cost < best.cost) {
                    best = Some(SpatialSplit { cost, axis, grid: *grid, bin: at as u32, left, right });
                }
            }
        }
        best
    }
}

/// Adds what lies between planes of a reference's box to the boxes of its bins; `first` is the first of these.
#[inline(always)]
fn chop(part: &Box4, axis: usize, grid: &Grid, bins: &mut [Box4], first: usize) {
    let last = bins.len() - 1;
    let mut own = *part;
    for (at, bin) in bins.iter_mut().enumerate() {
        own.max[axis] = if at == last { part.max[axis] } else { grid.plane(axis, first + at + 1) };
        bin.include(&own);
        own.min[axis] = own.max[axis];
    }
}

/// Where the references of a node that is cut go.
pub(super) struct Cut<'a> {
    mesh: &'a TriangleMesh,
    clipper: &'a mut Clipper,
    /// Triangles that may still be cut.
    spare: usize,
    /// Whether triangles may go whole to one side.
    unsplits: bool,
    on_left: Side,
    on_right: Side,
}

/// What lies on the left of a plane, and what on its right; never neither.
type Halves = (Option<Reference>, Option<Reference>);

impl SpatialSplit {
    fn plane(&self) -> f32 {
        self.grid.plane(self.axis, self.bin as usize)
    }

    /// Whether a reference lies left of the plane, and whether right of it; neither where it lies across.
    #[inline(always)]
    fn sides(&self, reference: &Reference) -> (bool, bool) {
        let Reference(part) = reference;
        let first = self.grid.bin(self.axis, part.min[self.axis]);
        let last = self.grid.bin(self.axis, part.max[self.axis]);
        (last < self.bin, first >= self.bin)
    }

    pub(super) fn cut<'a>(
        &self,
        mesh: &'a TriangleMesh,
        clipper: &'a mut Clipper,
        spare: usize,
        unsplits: bool,
    ) -> Cut<'a> {
        Cut { mesh, clipper, spare, unsplits, on_left: self.left, on_right: self.right }
    }
}

impl Cut<'_> {
    /// Copies what goes left to `left`, which has room for all, and moves what goes right to the front. Returns how many go left and right,
    /// and how many triangles were cut.
    pub(super) fn divide(
        mut self,
        split: &SpatialSplit,
        references: &mut [Reference],
        left: &mut [Reference],
    ) -> (usize, usize, usize) {
        let before = self.spare;
        let (mut to_left, mut kept) = (0, 0);
        for at in 0..references.len() {
            let own = references[at];
            let (is_left, is_right) = split.sides(&own);
            if is_left || is_right {
                // Without branches, which nobody could foresee: it is written to both sides, and stays on one.
                left[to_left] = own;
                references[kept] = own;
                to_left += usize::from(is_left);
                kept += usize::from(is_right);
                continue;
            }
            let (on_left, on_right) = self.halves(split, own);
            if let Some(own) = on_left {
                left[to_left] = own;
                to_left += 1;
            }
            if let Some(own) = on_right {
                references[kept] = own;
                kept += 1;
            }
        }
        (to_left, kept, before - self.spare)
    }

    /// Of a reference across the plane, what goes left and what goes right. A triangle goes whole to one side where that is cheaper,
    /// and where no more may be cut.
    fn halves(&mut self, split: &SpatialSplit, reference: Reference) -> Halves {
        if !self.unsplits {
            return self.parts(split, reference);
        }
        let Reference(part) = reference;
        let Self { on_left, on_right, .. } = self;
        // "Reference unsplitting": the cost with the triangle on both sides, and whole on either.
        let (with_left, with_right) = (on_left.bounds.union(&part), on_right.bounds.union(&part));
        let (l, r) = (f64::from(on_left.count), f64::from(on_right.count));
        let (own_left, own_right) = (on_left.bounds.half_area(), on_right.bounds.half_area());
        let both = own_left * l + own_right * r;
        let only_left = with_left.half_area() * l + own_right * (r - 1.0);
        let only_right = own_left * (l - 1.0) + with_right.half_area() * r;
        if self.spare > 0 && both < only_left && both < only_right {
            return self.parts(split, reference);
        }
        if only_left <= only_right {
            (on_left.bounds, on_right.count) = (with_left, on_right.count.saturating_sub(1));
            (Some(reference), None)
        } else {
            (on_right.bounds, on_left.count) = (with_right, on_left.count.saturating_sub(1));
            (None, Some(reference))
        }
    }

    /// The parts on both sides of the plane.
    fn parts(&mut self, split: &SpatialSplit, reference: Reference) -> Halves {
        let (bounds, id) = (reference.0.aabb(), reference.id());
        // Bins round, so the plane may lie beside a box that ends in the bins on both sides of it.
        let (axis, plane) = (split.axis, split.plane());
        let plane = plane.clamp(bounds.min[axis], bounds.max[axis]);
        let parts = self.clipper.split_bounds(&self.mesh.corners(id), &bounds, axis, plane);
        if let (Some(_), Some(_)) = parts {
            self.spare = self.spare.saturating_sub(1);
        }
        let new = |part: Option<Aabb>| part.map(|bounds| Reference::new(&bounds, id));
        (new(parts.0), new(parts.1))
    }
}
