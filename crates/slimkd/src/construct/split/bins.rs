//! Which planes of a node can be the best: counts by bins bound what every plane costs, so that few have to be looked at.
//!
//! Sources: Hunt, Mark & Stoll 2006 and Shevtsov, Soupikov & Kapustin 2007 sample the heuristic at bin borders and settle for
//! an approximation; Wald & Havran 2006, equations 2–6, for the heuristic.
//!
//! Deviations
//! 1. Bins only bound. With L₀ triangles that begin before a bin and R₁ that end behind it, no plane in it is cheaper than
//!    one at the bin's ends with those counts; with L₁ and R₀, none is dearer. Whatever may still be the cheapest is
//!    gathered, sorted and swept: the split is the exact sweep's to the last bit, in O(n) instead of sorted lists.
//! 2. The bounds hold in floating point too: they evaluate the same expression on operands that are no larger (or no
//!    smaller), and rounding is monotonic.

use super::sah::{AxisSah, VoxelSah};
use super::sweep::{Event, Split, best_of, cheaper};
use crate::construct::grow::Fragment;
use crate::geometry::Aabb;
use crate::job::memory::{push, room};
use crate::options::BuildError;
use std::ops::RangeInclusive;

/// Most bins an axis: counts of all axes must stay in the first-level cache (24 KB of 32 to 48).
pub(crate) const MOST_BINS: usize = 1024;
/// Adding this leaves a number rounded to an integer in the mantissa's low bits: a conversion that costs an addition.
const TO_INTEGER: f32 = 8_388_608.0;
/// How far rounding may move a coordinate between bins, in bins: the real error is below 1e-3.
const SLACK: f64 = 0.01;
/// Bins that are bounded at a time: a register's worth of f64.
const LANES: usize = 4;

/// From a coordinate to its bin. Monotonic on each axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Binner {
    low: [f32; 4],
    /// Bins per scene unit; 0 where the voxel is flat or too large or small for f32: all is in bin 0 there.
    scale: [f32; 4],
    mask: u32,
    /// Scene units per bin.
    width: [f64; 3],
}

impl Binner {
    /// For about `count` triangles.
    fn new(voxel: &Aabb, count: usize) -> Self {
        let bins = (count / 2).next_power_of_two().clamp(16, MOST_BINS);
        let extent = voxel.extent();
        let (mut scale, mut width, mut low) = ([0.0; 4], [0.0; 3], [0.0; 4]);
        for k in 0..3 {
            low[k] = voxel.min[k];
            // The first and the last bin are half as wide, since bins are rounded to nearest.
            let bins_per_unit = ((bins - 1) as f64 / extent[k]) as f32;
            let usable = extent[k] < f64::from(f32::MAX) && bins_per_unit.is_normal();
            (scale[k], width[k]) = if usable {
                (bins_per_unit, extent[k] / (bins - 1) as f64)
            } else {
                (0.0, 2.0 * extent[k]) // half of it covers the voxel
            };
        }
        Self { low, scale, mask: bins as u32 - 1, width }
    }

    pub(crate) fn bins(&self) -> usize {
        self.mask as usize + 1
    }

    #[inline(always)]
    fn of(&self, corner: &[f32; 4]) -> [usize; 4] {
        std::array::from_fn(|k| self.on(k, corner[k]))
    }

    #[inline(always)]
    fn on(&self, axis: usize, x: f32) -> usize {
        let bin = (x - self.low[axis]) * self.scale[axis] + TO_INTEGER;
        (bin.to_bits() & self.mask) as usize & (MOST_BINS - 1)
    }

    fn edges(&self, axis: usize) -> Edges {
        Edges { low: self.low[axis].into(), width: self.width[axis] }
    }
}

/// Where the bins of one axis lie.
#[derive(Clone, Copy)]
struct Edges {
    low: f64,
    width: f64,
}

impl Edges {
    /// What contains the bins from one to another.
    fn range_of(&self, first: usize, last: usize) -> RangeInclusive<f32> {
        let (low, high) = (self.range(first as i32), self.range(last as i32));
        (low.0 as f32).next_down()..=(high.1 as f32).next_up()
    }

    /// A range that contains all coordinates in `bin`; it may reach beyond the voxel.
    #[inline(always)]
    fn range(&self, bin: i32) -> (f64, f64) {
        let bin = f64::from(bin);
        (self.low + (bin - (0.5 + SLACK)) * self.width, self.low + (bin + (0.5 + SLACK)) * self.width)
    }
}

/// Triangles that begin and end in each bin.
#[derive(Clone)]
pub(crate) struct Histogram {
    starts: [[i32; MOST_BINS]; 3],
    ends: [[i32; MOST_BINS]; 3],
}

impl Default for Histogram {
    fn default() -> Self {
        Self { starts: [[0; MOST_BINS]; 3], ends: [[0; MOST_BINS]; 3] }
    }
}

impl Histogram {
    pub(crate) fn clear(&mut self, bins: usize) {
        for axis in 0..3 {
            self.starts[axis][..bins].fill(0);
            self.ends[axis][..bins].fill(0);
        }
    }

    pub(crate) fn count(&mut self, fragments: &[Fragment], binner: &Binner) {
        for fragment in fragments {
            let (low, high) = (binner.of(&fragment.low), binner.of(&fragment.high));
            for axis in 0..3 {
                self.starts[axis][low[axis]] += 1;
                self.ends[axis][high[axis]] += 1;
            }
        }
    }

    pub(crate) fn add(&mut self, other: &Self, bins: usize) {
        for axis in 0..3 {
            for bin in 0..bins {
                self.starts[axis][bin] += other.starts[axis][bin];
                self.ends[axis][bin] += other.ends[axis][bin];
            }
        }
    }
}

/// What is known of the bins of one axis.
struct Bins {
    /// Triangles that begin before a bin.
    left: [i32; MOST_BINS],
    /// Triangles that end in it or behind it.
    right: [i32; MOST_BINS],
    /// No plane in it is cheaper; infinite where there is none.
    least: [f64; MOST_BINS],
    /// None is dearer; infinite where there is none for sure.
    most: [f64; MOST_BINS],
    /// Whether it may hold the best plane.
    open: [bool; MOST_BINS],
}

impl Bins {
    const NONE: Self = Self {
        left: [0; MOST_BINS],
        right: [0; MOST_BINS],
        least: [0.0; MOST_BINS],
        most: [0.0; MOST_BINS],
        open: [false; MOST_BINS],
    };
}

/// The search for one node's best split. All buffers are reused from node to node.
pub(crate) struct Search {
    binner: Binner,
    pub(crate) histogram: Histogram,
    bins: [Bins; 3],
    /// What contains all open bins, by axis.
    open_ranges: [Option<RangeInclusive<f32>>; 3],
}

/// Events in the bins that may hold the best plane, by axis, strictly inside the voxel; and how many triangles begin, and
/// how many end, on its lower face.
#[derive(Clone, Default)]
pub(crate) struct Candidates {
    pub(crate) events: [Vec<Event>; 3],
    starts_on_face: [i32; 3],
    ends_on_face: [i32; 3],
}

impl Candidates {
    pub(crate) fn clear(&mut self) {
        self.events.iter_mut().for_each(Vec::clear);
        (self.starts_on_face, self.ends_on_face) = ([0; 3], [0; 3]);
    }

    pub(crate) fn append(&mut self, mut other: Self) -> Result<(), BuildError> {
        for axis in 0..3 {
            room(&mut self.events[axis], other.events[axis].len())?;
            self.events[axis].append(&mut other.events[axis]);
            self.starts_on_face[axis] += other.starts_on_face[axis];
            self.ends_on_face[axis] += other.ends_on_face[axis];
        }
        Ok(())
    }
}

impl Default for Search {
    fn default() -> Self {
        Self {
            binner: Binner { low: [0.0; 4], scale: [0.0; 4], mask: 0, width: [0.0; 3] },
            histogram: Histogram::default(),
            bins: [Bins::NONE; 3],
            open_ranges: [None, None, None],
        }
    }
}

impl Search {
    /// Begins with a node of `count` triangles: next, fill [`Search::histogram`] by the binner that this returns.
    pub(crate) fn begin(&mut self, voxel: &Aabb, count: usize) -> Binner {
        self.binner = Binner::new(voxel, count);
        self.histogram.clear(self.binner.bins());
        self.binner
    }

    /// Opens the bins that may hold the best plane.
    pub(crate) fn open(&mut self, sah: &VoxelSah, count: i32) {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the instruction set was just found to be there.
            return unsafe { self.open_avx2(sah, count) };
        }
        self.open_anywhere(sah, count);
    }

    /// The same code for wider registers.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn open_avx2(&mut self, sah: &VoxelSah, count: i32) {
        self.open_anywhere(sah, count);
    }

    #[inline(always)]
    fn open_anywhere(&mut self, sah: &VoxelSah, count: i32) {
        let bins = self.binner.bins().min(MOST_BINS);
        for axis in 0..3 {
            let (starts, ends) = (&self.histogram.starts[axis][..bins], &self.histogram.ends[axis][..bins]);
            let Bins { left, right, .. } = &mut self.bins[axis];
            let (left, right) = (&mut left[..bins], &mut right[..bins]);
            let (mut begun, mut not_ended) = (0, count);
            for bin in 0..bins {
                (left[bin], right[bin]) = (begun, not_ended);
                begun += starts[bin];
                not_ended -= ends[bin];
            }
        }
        self.open_what_may_be_best(sah, bins);
    }

    #[inline(always)]
    fn open_what_may_be_best(&mut self, sah: &VoxelSah, bins: usize) {
        let mut best = f64::INFINITY;
        for axis in 0..3 {
            let (starts, ends) = (&self.histogram.starts[axis][..bins], &self.histogram.ends[axis][..bins]);
            let Bins { left, right, least, most, .. } = &mut self.bins[axis];
            let (left, right) = (&left[..bins], &right[..bins]);
            let (sah, edges) = (sah.on(axis), self.binner.edges(axis));
            bound_bins(&mut least[..bins], &mut most[..bins], [starts, ends, left, right], sah, edges);
            // What is in the outermost bins may lie on the voxel's faces, where no plane is.
            (most[0], most[bins - 1]) = (f64::INFINITY, f64::INFINITY);
            best = best.min(least_of(&most[..bins]));
        }
        for axis in 0..3 {
            let Bins { least, open, .. } = &mut self.bins[axis];
            for (open, &least) in open[..bins].iter_mut().zip(&least[..bins]) {
                *open = (least <= best) & (least < f64::INFINITY);
            }
            let first = open[..bins].iter().position(|&open| open);
            let last = open[..bins].iter().rposition(|&open| open);
            let edges = self.binner.edges(axis);
            self.open_ranges[axis] = first.zip(last).map(|(first, last)| edges.range_of(first, last));
        }
    }

    /// Adds what lies in the open bins.
    pub(crate) fn gather(
        &self,
        fragments: &[Fragment],
        voxel: &Aabb,
        out: &mut Candidates,
    ) -> Result<(), BuildError> {
        for axis in 0..3 {
            let Some(open) = &self.open_ranges[axis] else { continue };
            let (least, most) = (voxel.min[axis], voxel.max[axis]);
            let (bins, events) = (&self.bins[axis], &mut out.events[axis]);
            for fragment in fragments {
                let (low, high) = (fragment.low[axis], fragment.high[axis]);
                // Almost all are out of range: the bins are looked at for the others alone.
                if open.contains(&low) && bins.open[self.binner.on(axis, low)] {
                    if low <= least {
                        out.starts_on_face[axis] += 1;
                        out.ends_on_face[axis] += i32::from(high <= least);
                    } else if low < most {
                        push(events, Event::low(low, high))?;
                    }
                }
                if open.contains(&high) && bins.open[self.binner.on(axis, high)] && low < high && high < most
                {
                    push(events, Event::high(high))?;
                }
            }
        }
        Ok(())
    }

    /// Sweeps the candidates.
    pub(crate) fn sweep(&self, candidates: &mut Candidates, sah: &VoxelSah, count: i32) -> Option<Split> {
        let mut best = None;
        for axis in 0..3 {
            let events = &mut candidates.events[axis];
            events.sort_unstable();
            let mut rest = &events[..];
            while let Some(first) = rest.first() {
                let bin_of = |event: &Event| self.binner.on(axis, event.position());
                let at = bin_of(first);
                let (here, behind) = rest.split_at(rest.partition_point(|event| bin_of(event) <= at));
                let (left, right) = match at {
                    0 => (candidates.starts_on_face[axis], count - candidates.ends_on_face[axis]),
                    _ => (self.bins[axis].left[at], self.bins[axis].right[at]),
                };
                best = cheaper(best, best_of(here, axis, sah, left, right));
                rest = behind;
            }
        }
        best
    }
}

/// The least of costs, whose number is a multiple of [`LANES`].
#[inline(always)]
fn least_of(costs: &[f64]) -> f64 {
    let mut least = [f64::INFINITY; LANES];
    for costs in costs.as_chunks::<LANES>().0 {
        for lane in 0..LANES {
            least[lane] = if costs[lane] < least[lane] { costs[lane] } else { least[lane] };
        }
    }
    least.into_iter().fold(f64::INFINITY, f64::min)
}

/// Per bin, a cost that no plane in it is below and one that none is above; infinite where there is none. `counts` are
/// starts, ends, left and right. Plain loops over arrays, with choices instead of branches: the compiler fills registers.
#[inline(always)]
fn bound_bins(least: &mut [f64], most: &mut [f64], counts: [&[i32]; 4], sah: AxisSah, edges: Edges) {
    let bins = least.len().min(most.len()).min(counts[0].len());
    let bins = counts.iter().fold(bins, |bins, counts| bins.min(counts.len()));
    let (least, most) = (&mut least[..bins], &mut most[..bins]);
    let [starts, ends, left, right] = counts.map(|counts| &counts[..bins]);
    for bin in 0..bins {
        least[bin] = sah.least(edges.range(bin as i32), left[bin], right[bin] - ends[bin]);
    }
    for bin in 0..bins {
        most[bin] = sah.most(edges.range(bin as i32), left[bin] + starts[bin], right[bin]);
    }
    for bin in 0..bins {
        let none = starts[bin] | ends[bin] == 0;
        least[bin] = if none { f64::INFINITY } else { least[bin] };
        most[bin] = if none { f64::INFINITY } else { most[bin] };
    }
}
