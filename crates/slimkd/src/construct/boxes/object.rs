//! The best way to divide a node's references into two sets: by the surface area heuristic over bins of their centres.
//!
//! Source: Wald 2007, *On fast Construction of SAH-based Bounding Volume Hierarchies*.

use super::reference::{Box4, Grid, Reference};

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
    pub(super) place: Place,
    pub(super) left: Box4,
    pub(super) right: Box4,
}

/// Which references go left.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// Those whose centre's bin is below.
    Bin(Grid, u32),
    /// Those whose centre is below, twice.
    Center(f32),
}

/// The boxes and counts of all axes' bins.
pub(super) struct Bins {
    boxes: [[Box4; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Bins {
    pub(super) const EMPTY: Self = Self { boxes: [[Box4::EMPTY; BINS]; 3], counts: [[0; BINS]; 3] };

    pub(super) fn add(&mut self, grid: &Grid, references: &[Reference]) {
        for reference in references {
            let bins = grid.bins(&reference.centers());
            for k in 0..3 {
                let at = bins[k] as usize % BINS;
                self.boxes[k][at].include(&reference.0);
                self.counts[k][at] += 1;
            }
        }
    }

    pub(super) fn join(&mut self, other: &Self) {
        for k in 0..3 {
            for at in 0..BINS {
                self.boxes[k][at].include(&other.boxes[k][at]);
                self.counts[k][at] += other.counts[k][at];
            }
        }
    }

    pub(super) fn grid(centers: &Box4) -> Grid {
        Grid::new(centers, BINS)
    }

    /// The best division; `None` where all centres are one point.
    pub(super) fn best(&self, grid: &Grid) -> Option<ObjectSplit> {
        let mut best: Option<(f64, usize, usize)> = None;
        for axis in (0..3).filter(|&axis| grid.has(axis)) {
            let (boxes, counts) = (&self.boxes[axis], &self.counts[axis]);
            // From the right, then from the left with the costs of both sides.
            let mut rights = [0.0; BINS];
            let (mut right, mut count) = (Box4::EMPTY, 0);
            for at in (1..BINS).rev() {
                right.include(&boxes[at]);
                count += counts[at];
                rights[at] = right.half_area() * f64::from(count);
            }
            let all = count + counts[0];
            let (mut left, mut count) = (Box4::EMPTY, 0);
            for at in 1..BINS {
                left.include(&boxes[at - 1]);
                count += counts[at - 1];
                let cost = left.half_area() * f64::from(count) + rights[at];
                // An empty bin does not make another division.
                if counts[at - 1] > 0 && count < all && best.is_none_or(|(best, ..)| cost < best) {
                    best = Some((cost, axis, at));
                }
            }
        }
        best.map(|(cost, axis, at)| {
            let (mut left, mut right) = (Box4::EMPTY, Box4::EMPTY);
            self.boxes[axis][..at].iter().for_each(|part| left.include(part));
            self.boxes[axis][at..].iter().for_each(|part| right.include(part));
            ObjectSplit { cost, axis, place: Place::Bin(*grid, at as u32), left, right }
        })
    }
}

/// The best division of at most [`SWEPT`] references.
pub(super) fn sweep(references: &[Reference]) -> Option<ObjectSplit> {
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
                best = Some(ObjectSplit { cost, axis, place: Place::Center(below), left, right: rights[at] });
            }
        }
    }
    best
}
