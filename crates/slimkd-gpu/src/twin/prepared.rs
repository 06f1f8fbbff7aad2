//! What a ray carries, and the triangle test: the first half of `shaders/walk.wgsl` in Rust.
//!
//! Differences from the CPU's kernels, and their reason
//! 1. WGSL has no f64. The CPU decides by exact signs of edge functions; here the same signs come from f32 where it can
//!    tell and else from the exact products in integers. t, u, v come from sums of two floats (48 bits).
//! 2. GPUs divide with an error of 2.5 units in the last place; the ray's slopes are divided in integers instead, since
//!    with them the sheared corners, and so the signs, are the CPU's to the bit.
//! 3. Split planes are slabs of twice the CPU's half-width (2⁻¹⁸ of the reach): room for contracted sums and inexact
//!    reciprocals, which can only cost a visit.
//! 4. Infinite t ends at the largest float, since WGSL may assume that there is no infinity. Rays that start beyond 10¹⁸
//!    units or extents visit every node.

use super::exact::{Double, add, divide, minus, quotient, sign_of_difference, times, two_product};
use crate::image::Params;
use slimkd::{Hit, Ray};

const SLACK: f32 = 1.0 / (1 << 18) as f32;
const PARALLEL: f32 = 1.0 / (1u64 << 60) as f32;
const WILD: f32 = 1e18;

pub(super) struct Prepared {
    origin: [f32; 3],
    /// World axes that play x, y, z.
    axes: [usize; 3],
    slope: [f32; 2],
    depth: f32,
    pub(super) start: [f32; 3],
    pub(super) inverse: [f32; 3],
    pub(super) slack: [f32; 3],
    pub(super) enter: f32,
    pub(super) exit: f32,
    pub(super) t_min: f32,
    pub(super) t_max: f32,
    pub(super) scale: f32,
    pub(super) wild: bool,
}

impl Prepared {
    /// `None` for a ray that is invalid or passes the scene by.
    pub(super) fn new(ray: &Ray, params: &Params) -> Option<Self> {
        if !ray.is_valid() || params.triangle_count == 0 {
            return None;
        }
        let (o, d) = (ray.origin, ray.direction);
        let [x, y, z] = d.map(f32::abs);
        let axis = if x > y {
            if x > z { 0 } else { 2 }
        } else if y > z {
            1
        } else {
            2
        };
        let axes = [(axis + 1) % 3, (axis + 2) % 3, axis];
        let slope = [divide(d[axes[0]], d[axis]), divide(d[axes[1]], d[axis])];
        let power = (d[axis].abs().to_bits() & 0x7f80_0000).clamp(1 << 23, 253 << 23);
        let (scale, unscale) = (f32::from_bits(power), f32::from_bits((254 << 23) - power));
        let reach = (0..3).fold(0.0f32, |reach, k| {
            reach.max((params.bounds_min[k] - o[k]).abs()).max((params.bounds_max[k] - o[k]).abs())
        });
        let tame = |k: usize| reach < WILD && reach * params.scale[k] < WILD && params.unscale[k] < WILD;
        let wild = !(tame(0) && tame(1) && tame(2));
        let (t_min, t_max) = (ray.t_min.clamp(f32::MIN, f32::MAX), ray.t_max.clamp(f32::MIN, f32::MAX));
        let (mut enter, mut exit) = (t_min * scale, t_max * scale);
        let (mut start, mut inverse, mut slack) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for k in 0..3 {
            let along = d[k] * unscale;
            let along = if along.abs() < PARALLEL { PARALLEL.copysign(d[k]) } else { along };
            let one_over = 1.0 / along;
            let width = (SLACK * reach + params.cell[k]) * one_over.abs();
            let low = (params.bounds_min[k] - o[k]) * one_over;
            let high = (params.bounds_max[k] - o[k]) * one_over;
            enter = enter.max(low.min(high) - width);
            exit = exit.min(low.max(high) + width);
            start[k] = (o[k] - params.low[k]) * params.scale[k] + params.low[3];
            inverse[k] = one_over * params.unscale[k];
            slack[k] = width;
        }
        if wild {
            (enter, exit) = (f32::MIN, f32::MAX);
        }
        let depth = d[axis];
        (t_min <= t_max && enter <= exit).then_some(Self {
            origin: o,
            axes,
            slope,
            depth,
            start,
            inverse,
            slack,
            enter,
            exit,
            t_min,
            t_max,
            scale,
            wild,
        })
    }

    fn shear(&self, corner: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = self.axes.map(|k| corner[k] - self.origin[k]);
        [x - self.slope[0] * z, y - self.slope[1] * z, z]
    }

    /// The hit of a triangle, wherever its t lies.
    pub(super) fn intersect(&self, corners: [[f32; 3]; 3], triangle: u32) -> Option<Hit> {
        let [a, b, c] = corners.map(|corner| self.shear(corner));
        let sign = |p: [f32; 3], q: [f32; 3]| sign_of_difference(p[0], q[1], p[1], q[0]);
        let (u, v, w) = (sign(c, b), sign(a, c), sign(b, a));
        if u * v < 0 || u * w < 0 || v * w < 0 || (u, v, w) == (0, 0, 0) {
            return None;
        }
        let largest = [a, b, c].iter().fold(0.0f32, |most, p| most.max(p[0].abs()).max(p[1].abs()));
        let by = f32::from_bits((254 << 23) - (largest.to_bits() & 0x7f80_0000).clamp(1 << 23, 253 << 23));
        let area = |p: [f32; 3], q: [f32; 3]| -> Double {
            add(two_product(p[0] * by, q[1] * by), minus(two_product(p[1] * by, q[0] * by)))
        };
        let (wa, wb, wc) = (area(c, b), area(a, c), area(b, a));
        let whole = add(add(wa, wb), wc);
        if whole.high == 0.0 {
            return None;
        }
        let along = add(add(times(wa, a[2]), times(wb, b[2])), times(wc, c[2]));
        let t = quotient(along, times(whole, self.depth));
        Some(Hit { t, u: quotient(wb, whole), v: quotient(wc, whole), triangle })
    }
}
