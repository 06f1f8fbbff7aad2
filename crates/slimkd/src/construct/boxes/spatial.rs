//! The best plane to cut a node's references at, where that is better than any division of them.
//!
//! Source: Stich, Friedrich & Dietrich 2009, *Spatial Splits in Bounding Volume Hierarchies*, §4.
//!
//! Deviations
//! 1. A triangle is cut at all planes between bins at once, by walking its three edges. Bins only choose the plane.
//! 2. The cut itself is `geometry/clip.rs`'s, whose boxes are rounded outwards: together, they hold the whole part.

use super::reference::{Box4, Reference};
use crate::geometry::{Clipper, TriangleMesh};

const BINS: usize = 16;

/// A plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpatialSplit {
    /// Sum over both sides of half the surface area times references.
    pub(super) cost: f64,
    pub(super) axis: usize,
    pub(super) plane: f32,
    left: Side,
    right: Side,
}

#[derive(Clone, Copy, Debug)]
struct Side {
    bounds: Box4,
    count: u32,
}

struct Bins {
    boxes: [Box4; BINS],
    /// References that begin and that end in a bin.
    entries: [u32; BINS],
    exits: [u32; BINS],
}

/// The planes between bins of one axis.
#[derive(Clone, Copy)]
struct Grid {
    low: f32,
    width: f32,
    scale: f32,
}

impl Grid {
    fn of(bounds: &Box4, axis: usize) -> Option<Self> {
        let extent = bounds.max[axis] - bounds.min[axis];
        let (width, scale) = (extent / BINS as f32, BINS as f32 / extent);
        (extent > 0.0 && width > f32::MIN_POSITIVE && scale.is_finite()).then_some(Self {
            low: bounds.min[axis],
            width,
            scale,
        })
    }

    #[inline(always)]
    fn bin(&self, x: f32) -> usize {
        (((x - self.low) * self.scale) as usize).min(BINS - 1)
    }

    /// The plane below a bin.
    #[inline(always)]
    fn plane(&self, bin: usize) -> f32 {
        self.low + self.width * bin as f32
    }
}

/// The best plane; `None` where none separates anything.
pub(super) fn best(mesh: &TriangleMesh, references: &[Reference], bounds: &Box4) -> Option<SpatialSplit> {
    let mut best: Option<SpatialSplit> = None;
    for axis in 0..3 {
        let Some(grid) = Grid::of(bounds, axis) else { continue };
        let mut bins = Bins { boxes: [Box4::EMPTY; BINS], entries: [0; BINS], exits: [0; BINS] };
        for reference in references {
            let Reference(part) = reference;
            let (first, last) = (grid.bin(part.min[axis]), grid.bin(part.max[axis]));
            bins.entries[first] += 1;
            bins.exits[last] += 1;
            if first == last {
                bins.boxes[first].include(part);
            } else {
                chop(&mesh.corners(reference.id()), part, axis, &grid, first, last, &mut bins.boxes);
            }
        }
        let mut rights = [Side { bounds: Box4::EMPTY, count: 0 }; BINS];
        let mut right = Side { bounds: Box4::EMPTY, count: 0 };
        for at in (1..BINS).rev() {
            right.bounds.include(&bins.boxes[at]);
            right.count += bins.exits[at];
            rights[at] = right;
        }
        let mut left = Side { bounds: Box4::EMPTY, count: 0 };
        for at in 1..BINS {
            left.bounds.include(&bins.boxes[at - 1]);
            left.count += bins.entries[at - 1];
            let right = rights[at];
            if left.count == 0 || right.count == 0 {
                continue;
            }
            let cost = left.bounds.half_area() * f64::from(left.count)
                + right.bounds.half_area() * f64::from(right.count);
            if best.as_ref().is_none_or(|best| cost < best.cost) {
                best = Some(SpatialSplit { cost, axis, plane: grid.plane(at), left, right });
            }
        }
    }
    best
}

/// Adds the parts of a triangle between planes to their bins, cut to the box of its reference.
fn chop(
    corners: &[[f32; 3]; 3],
    part: &Box4,
    axis: usize,
    grid: &Grid,
    first: usize,
    last: usize,
    boxes: &mut [Box4; BINS],
) {
    let mut parts = [Box4::EMPTY; BINS];
    let point = |p: [f32; 3]| [p[0], p[1], p[2], 0.0];
    for i in 0..3 {
        let (a, b) = (point(corners[i]), point(corners[(i + 1) % 3]));
        let (a, b) = if a[axis] <= b[axis] { (a, b) } else { (b, a) };
        let (low, high) = (grid.bin(a[axis]), grid.bin(b[axis]));
        if (first..=last).contains(&low) {
            parts[low].include_point(a);
        }
        if (first..=last).contains(&high) {
            parts[high].include_point(b);
        }
        let inverse = 1.0 / (b[axis] - a[axis]);
        for at in low.max(first) + 1..=high.min(last) {
            let plane = grid.plane(at);
            let s = ((plane - a[axis]) * inverse).clamp(0.0, 1.0);
            let mut on_plane = [0, 1, 2, 3].map(|k| a[k] + s * (b[k] - a[k]));
            on_plane[axis] = plane;
            parts[at - 1].include_point(on_plane);
            parts[at].include_point(on_plane);
        }
        // Where the reference's box begins or ends inside the edge, the bins at its ends have their whole side there.
        if low < first && high >= first {
            parts[first].include_point(at_plane(&a, &b, axis, part.min[axis], inverse));
        }
        if high > last && low <= last {
            parts[last].include_point(at_plane(&a, &b, axis, part.max[axis], inverse));
        }
    }
    for at in first..=last {
        let cut = &mut parts[at];
        for k in 0..3 {
            cut.min[k] = cut.min[k].max(part.min[k]);
            cut.max[k] = cut.max[k].min(part.max[k]);
        }
        if (0..3).all(|k| cut.min[k] <= cut.max[k]) {
            boxes[at].include(cut);
        }
    }
}

fn at_plane(a: &[f32; 4], b: &[f32; 4], axis: usize, plane: f32, inverse: f32) -> [f32; 4] {
    let s = ((plane - a[axis]) * inverse).clamp(0.0, 1.0);
    let mut point = [0, 1, 2, 3].map(|k| a[k] + s * (b[k] - a[k]));
    point[axis] = plane;
    point
}

impl SpatialSplit {
    /// Cuts references: what lies left of the plane to the end of `left`, what lies right of it to the end of `right`. A triangle goes
    /// whole to one side where that is cheaper, and where `spare` allows no more parts; returns how many were cut.
    pub(super) fn cut(
        &self,
        mesh: &TriangleMesh,
        clipper: &mut Clipper,
        references: impl Iterator<Item = Reference>,
        mut spare: usize,
        left: &mut Vec<Reference>,
        right: &mut Vec<Reference>,
    ) -> usize {
        let Self { axis, plane, .. } = *self;
        let (mut on_left, mut on_right) = (self.left, self.right);
        let mut parts = 0;
        for reference in references {
            let Reference(part) = reference;
            if part.max[axis] <= plane {
                left.push(reference);
                continue;
            }
            if part.min[axis] >= plane {
                right.push(reference);
                continue;
            }
            // "Reference unsplitting": the cost with the triangle on both sides, and whole on either.
            let (with_left, with_right) = (on_left.bounds.union(&part), on_right.bounds.union(&part));
            let (l, r) = (f64::from(on_left.count), f64::from(on_right.count));
            let both = on_left.bounds.half_area() * l + on_right.bounds.half_area() * r;
            let only_left = with_left.half_area() * l + on_right.bounds.half_area() * (r - 1.0);
            let only_right = on_left.bounds.half_area() * (l - 1.0) + with_right.half_area() * r;
            if spare > 0 && both < only_left && both < only_right {
                let bounds = part.aabb();
                let id = reference.id();
                match clipper.split_bounds(&mesh.corners(id), &bounds, axis, plane) {
                    (Some(a), Some(b)) => {
                        left.push(Reference::new(&a, id));
                        right.push(Reference::new(&b, id));
                        (spare, parts) = (spare - 1, parts + 1);
                    }
                    (Some(a), None) => left.push(Reference::new(&a, id)),
                    (None, Some(b)) => right.push(Reference::new(&b, id)),
                    (None, None) => left.push(reference),
                }
            } else if only_left <= only_right {
                (on_left.bounds, on_right.count) = (with_left, on_right.count.saturating_sub(1));
                left.push(reference);
            } else {
                (on_right.bounds, on_left.count) = (with_right, on_left.count.saturating_sub(1));
                right.push(reference);
            }
        }
        parts
    }
}
