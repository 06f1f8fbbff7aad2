//! The wide node's 256 bytes.
//!
//! ```text
//! bytes    what
//!   0..192 planes: for each axis 16 × u16 lower, then 16 × u16 upper, one lane a child
//! 192..204 low: f32 × 3, grid units
//! 204..216 steps: u32 × 3; the upper 9 bits are those of a power of two as f32, grid units a step of the planes;
//!          lower bits of the first: number of inner children; of the second: number of children; of the third: 0
//! 216..220 index of the first inner child; the others follow it
//! 220..224 where the leaves' bytes begin; each leaf at its lane's offset from there
//! 224..256 offsets: 16 × u16; 0 for inner children
//! ```
//! All little-endian. Inner children come first, then leaves; lanes behind them are 0. Grid units are those of the dense layout's planes
//! without their shift: on each axis, the scene lies in [0, 1]. A child's plane is `low + plane · step`. Both planes of a child are rounded
//! outwards, so its box holds all that it refers to.

use crate::geometry::Aabb;
use crate::layout::Planes;

/// Children of a node.
pub(crate) const LANES: usize = 16;
/// The bits of a step that are the power of two.
pub(crate) const STEP_BITS: u32 = 0xff80_0000;
/// The least step: 2⁻⁴⁰ of the scene, far below what rays tell apart, and far above the subnormal numbers.
const LEAST_STEP: i32 = -40;
/// Lower corners of nodes below this are 0.
const LEAST_LOW: f64 = 1.0 / (1u64 << 60) as f64;
const LAST: f64 = u16::MAX as f64;

/// A node as it is in memory and, on little-endian machines, in files.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
pub(crate) struct WideNode {
    /// Lower and upper planes of each axis, x first.
    pub(crate) planes: [[u16; LANES]; 6],
    pub(crate) low: [f32; 3],
    pub(crate) steps: [u32; 3],
    pub(crate) nodes: u32,
    pub(crate) leaves: u32,
    pub(crate) offsets: [u16; LANES],
}

const _: () = assert!(size_of::<WideNode>() == 256);

impl WideNode {
    /// A node of children with these boxes, in scene units; the first `inner` are inner nodes.
    pub(super) fn new(boxes: &[Aabb], inner: usize, grid: &Planes) -> Self {
        let mut node: Self = bytemuck::Zeroable::zeroed();
        for axis in 0..3 {
            let place = |x: f32| (f64::from(x) - f64::from(grid.low[axis])) * f64::from(grid.scale[axis]);
            let low = boxes.iter().map(|b| place(b.min[axis])).fold(f64::INFINITY, f64::min);
            let high = boxes.iter().map(|b| place(b.max[axis])).fold(f64::NEG_INFINITY, f64::max);
            let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
            // Never below 0, and never subnormal: such operands take a hundred cycles.
            let low = if low < LEAST_LOW { 0.0 } else { round_down(low) };
            let step = ((high - f64::from(low)) / LAST).log2().ceil().max(LEAST_STEP.into()) as i32;
            // Rounding of the logarithm may have made the step one power too small.
            let step = if (high - f64::from(low)) / f64::from(step).exp2() > LAST { step + 1 } else { step };
            let width = f64::from(step).exp2();
            let steps = |x: f64| (x - f64::from(low)) / width;
            for (lane, b) in boxes.iter().enumerate() {
                node.planes[2 * axis][lane] = steps(place(b.min[axis])).floor().clamp(0.0, LAST) as u16;
                node.planes[2 * axis + 1][lane] = steps(place(b.max[axis])).ceil().clamp(0.0, LAST) as u16;
            }
            node.low[axis] = low;
            node.steps[axis] = (width as f32).to_bits();
        }
        node.steps[0] |= inner as u32;
        node.steps[1] |= boxes.len() as u32;
        node
    }

    /// Children that are inner nodes.
    #[inline(always)]
    pub(crate) fn inner(&self) -> usize {
        (self.steps[0] & !STEP_BITS) as usize
    }

    /// The planes of one axis and side: lower and upper ones of x, of y, of z.
    ///
    /// # Safety
    /// There are six.
    #[inline(always)]
    pub(crate) unsafe fn plane(&self, which: u32) -> &[u16; LANES] {
        // SAFETY: the caller's promise.
        unsafe { self.planes.get_unchecked(which as usize) }
    }

    /// The lower corner and the steps, with a value behind each that means nothing: vectors of four.
    #[inline(always)]
    pub(crate) fn corner_and_steps(&self) -> ([f32; 4], [u32; 4]) {
        let words: &[u32; 64] = bytemuck::cast_ref(self);
        let four = |at: usize| [words[at], words[at + 1], words[at + 2], words[at + 3]];
        (bytemuck::cast(four(48)), four(51))
    }

    /// All children.
    #[inline(always)]
    pub(crate) fn children(&self) -> usize {
        (self.steps[1] & !STEP_BITS) as usize
    }

    /// A child's box, scene units, as exact as f64 is.
    pub(crate) fn bounds(&self, lane: usize, grid: &Planes) -> [[f64; 3]; 2] {
        let plane = |axis: usize, side: usize| {
            let step = f64::from(f32::from_bits(self.steps[axis] & STEP_BITS));
            let place = f64::from(self.low[axis]) + f64::from(self.planes[2 * axis + side][lane]) * step;
            place * f64::from(grid.unscale[axis]) + f64::from(grid.low[axis])
        };
        [0, 1].map(|side| std::array::from_fn(|axis| plane(axis, side)))
    }

    /// Little-endian bytes to the machine's order, or back.
    pub(crate) fn swapped(mut self) -> Self {
        let shorts = self.planes.as_flattened_mut().iter_mut().chain(&mut self.offsets);
        shorts.for_each(|x| *x = x.swap_bytes());
        self.low = self.low.map(|x| f32::from_bits(x.to_bits().swap_bytes()));
        self.steps = self.steps.map(u32::swap_bytes);
        (self.nodes, self.leaves) = (self.nodes.swap_bytes(), self.leaves.swap_bytes());
        self
    }
}

fn round_down(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::wide::grid;

    #[test]
    fn boxes_hold_what_they_were_made_of() {
        let mut state = 1u64;
        let mut unit = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f32 / (1u64 << 24) as f32
        };
        for (low, extent) in [(0.0f32, 1.0f32), (-3.0, 7.0), (5e6, 1e3), (1e-20, 1e-20), (-1e30, 2e30)] {
            let scene = Aabb { min: [low; 3], max: [low + extent; 3] };
            let grid = grid(&scene).unwrap();
            for _ in 0..200 {
                // Nodes of all sizes, some boxes flat.
                let (at, size) = ([unit(), unit(), unit()], unit().powi(8));
                let boxes: Vec<Aabb> = (0..1 + (unit() * 15.99) as usize)
                    .map(|_| {
                        let mut own = Aabb::EMPTY;
                        for _ in 0..2 {
                            let point: [f32; 3] = std::array::from_fn(|k| at[k] + size * unit());
                            own.include(std::array::from_fn(|k| low + extent * point[k].min(1.0)));
                        }
                        if unit() < 0.3 { Aabb { max: own.min, ..own } } else { own }
                    })
                    .collect();
                let node = WideNode::new(&boxes, boxes.len() / 2, &grid);
                assert_eq!((node.inner(), node.children()), (boxes.len() / 2, boxes.len()));
                for (lane, own) in boxes.iter().enumerate() {
                    let [min, max] = node.bounds(lane, &grid);
                    for k in 0..3 {
                        let nearly = 1e-15 * f64::from(low.abs() + extent);
                        assert!(min[k] <= f64::from(own.min[k]) + nearly, "{own:?} {min:?}");
                        assert!(max[k] >= f64::from(own.max[k]) - nearly, "{own:?} {max:?}");
                    }
                }
                assert_eq!(node.swapped().swapped(), node);
            }
        }
    }
}
