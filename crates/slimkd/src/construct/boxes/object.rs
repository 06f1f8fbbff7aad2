//! The best way to divide a node's references into two sets: by the surface area heuristic over bins of their centres.
//!
//! Source: Wald 2007, *On fast Construction of SAH-based Bounding Volume Hierarchies*.

use super::reference::{Box4, Reference};

/// Bins an axis.
const BINS: usize = 32;
/// Nodes of at most so many references are swept reference by reference instead.
pub(super) const SWEPT: usize = 12;

/// A division of a node's references.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectSplit {
    /// Sum over both sides of half the surface area times references.
    pub(super) cost: f64,
    pub(super) axis: usize,
    /// References whose centre's place is below go left.
    pub(super) below: f32,
    pub(super) left: Box4,
    pub(super) right: Box4,
}

/// The boxes and counts of one axis's bins.
struct Bins {
    boxes: [Box4; BINS],
    counts: [u32; BINS],
}

/// The best division by centres; `None` where all centres are one point. `centers` are the bounds of twice the centres.
pub(super) fn best(references: &[Reference], centers: &Box4) -> Option<ObjectSplit> {
    if references.len() <= SWEPT { sweep(references) } else { bin(references, centers) }
}

/// The bin of a centre.
#[inline(always)]
fn bin_of(center: f32, low: f32, scale: f32) -> usize {
    (((center - low) * scale) as usize).min(BINS - 1)
}

fn bin(references: &[Reference], centers: &Box4) -> Option<ObjectSplit> {
    let mut axes = [0, 1, 2].map(|_| Bins { boxes: [Box4::EMPTY; BINS], counts: [0; BINS] });
    let low = [0, 1, 2].map(|k| centers.min[k]);
    let scale = [0, 1, 2].map(|k| {
        let extent = centers.max[k] - centers.min[k];
        let scale = BINS as f32 * 0.9999 / extent;
        if extent > 0.0 && scale.is_finite() { scale } else { 0.0 }
    });
    for reference in references {
        for k in 0..3 {
            let at = bin_of(reference.center(k), low[k], scale[k]);
            axes[k].boxes[at].include(&reference.0);
            axes[k].counts[at] += 1;
        }
    }
    let mut best: Option<ObjectSplit> = None;
    for (axis, bins) in axes.iter().enumerate().filter(|(axis, _)| scale[*axis] > 0.0) {
        // From the right, then from the left with the costs of both sides.
        let mut rights = [(0.0, 0u32); BINS];
        let (mut right, mut count) = (Box4::EMPTY, 0);
        for at in (1..BINS).rev() {
            right.include(&bins.boxes[at]);
            count += bins.counts[at];
            rights[at] = (right.half_area(), count);
        }
        let (mut left, mut count) = (Box4::EMPTY, 0);
        for at in 1..BINS {
            if bins.counts[at - 1] > 0 {
                left.include(&bins.boxes[at - 1]);
                count += bins.counts[at - 1];
            } else if at > 1 {
                continue; // the same division as the one before
            }
            let (area, others) = rights[at];
            if count == 0 || others == 0 {
                continue;
            }
            let cost = left.half_area() * f64::from(count) + area * f64::from(others);
            if best.is_none_or(|best| cost < best.cost) {
                let mut right = Box4::EMPTY;
                bins.boxes[at..].iter().for_each(|other| right.include(other));
                best = Some(ObjectSplit { cost, axis, below: at as f32, left, right });
            }
        }
    }
    // Bins become a place among centres: the least centre of the bins on the right.
    best.map(|split| {
        let at = split.below as usize;
        let on_right = references
            .iter()
            .map(|reference| reference.center(split.axis))
            .filter(|&center| bin_of(center, low[split.axis], scale[split.axis]) >= at);
        ObjectSplit { below: on_right.fold(f32::INFINITY, f32::min), ..split }
    })
}

fn sweep(references: &[Reference]) -> Option<ObjectSplit> {
    let count = references.len();
    let mut best: Option<ObjectSplit> = None;
    for axis in 0..3 {
        let mut order = [0u8; SWEPT];
        for (at, place) in order[..count].iter_mut().enumerate() {
            *place = at as u8;
        }
        let order = &mut order[..count];
        let center = |at: u8| references[usize::from(at)].center(axis);
        for i in 1..count {
            let mut j = i;
            while j > 0 && center(order[j]) < center(order[j - 1]) {
                order.swap(j, j - 1);
                j -= 1;
            }
        }
        let mut rights = [Box4::EMPTY; SWEPT];
        let mut right = Box4::EMPTY;
        for at in (1..count).rev() {
            right.include(&references[usize::from(order[at])].0);
            rights[at] = right;
        }
        let mut left = Box4::EMPTY;
        for at in 1..count {
            left.include(&references[usize::from(order[at - 1])].0);
            let below = center(order[at]);
            if center(order[at - 1]) == below {
                continue; // equal centres stay together
            }
            let cost = left.half_area() * at as f64 + rights[at].half_area() * (count - at) as f64;
            if best.is_none_or(|best| cost < best.cost) {
                best = Some(ObjectSplit { cost, axis, below, left, right: rights[at] });
            }
        }
    }
    best
}
