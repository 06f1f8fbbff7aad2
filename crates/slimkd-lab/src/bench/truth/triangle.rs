//! One triangle in a ray's frame, in f64.

use super::CORNER;
use slimkd::{Aabb, Ray};

/// What rounding t to f32 may add, relative.
const ROUNDED: f64 = 4.0 / (1u64 << 24) as f64;

/// What boxes are widened by, in what corners may move.
const WIDEN: f64 = 4.0;

/// The frame in which a ray runs along z.
pub(super) struct Frame {
    pub(super) origin: [f64; 3],
    pub(super) direction: [f64; 3],
    /// 1 over it, +∞ over both zeros.
    pub(super) inverse: [f64; 3],
    /// The origin above and below by what widens boxes: beyond what corners may move and f64 rounds.
    pub(super) above: [f64; 3],
    pub(super) below: [f64; 3],
    pub(super) t_min: f64,
    pub(super) t_max: f64,
    axes: [usize; 3],
    slope: [f64; 2],
    /// How far a corner may be from where it is computed, scene units.
    pub(super) corner: f64,
}

/// A triangle that is hit, perhaps.
pub(super) struct Possible {
    /// It is.
    pub(super) certain: bool,
    /// The interval that t lies in.
    pub(super) first: f64,
    pub(super) last: f64,
}

impl Frame {
    pub(super) fn new(ray: &Ray, bounds: &Aabb) -> Self {
        let (origin, direction) = (ray.origin.map(f64::from), ray.direction.map(f64::from));
        let longest = |k: &usize| direction[*k].abs();
        let z = (0..3).max_by(|a, b| longest(a).total_cmp(&longest(b))).unwrap_or(2);
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let mut reach = 0.0f64;
        for k in 0..3 {
            let (low, high) = (f64::from(bounds.min[k]) - origin[k], f64::from(bounds.max[k]) - origin[k]);
            reach = reach.max(low.abs()).max(high.abs());
        }
        let corner = CORNER * reach;
        Self {
            origin,
            direction,
            inverse: direction.map(|d| if d == 0.0 { f64::INFINITY } else { 1.0 / d }),
            above: origin.map(|x| x + WIDEN * corner),
            below: origin.map(|x| x - WIDEN * corner),
            t_min: ray.t_min.into(),
            t_max: ray.t_max.into(),
            axes: [x, y, z],
            slope: [direction[x] / direction[z], direction[y] / direction[z]],
            corner,
        }
    }

    /// Whether and where the ray's line may hit a triangle.
    pub(super) fn candidate(&self, corners: &[[f32; 3]; 3]) -> Option<Possible> {
        let [kx, ky, kz] = self.axes;
        let seen = |[x, y, z]: [f64; 3]| [x - self.slope[0] * z, y - self.slope[1] * z, z];
        let at = |corner: &[f32; 3], k: usize| f64::from(corner[k]) - self.origin[k];
        let seen = |corner| seen([at(corner, kx), at(corner, ky), at(corner, kz)]);
        let [a, b, c] = [seen(&corners[0]), seen(&corners[1]), seen(&corners[2])];
        // All on one side, and not near: most triangles.
        let far = 2.0 * self.corner;
        for k in 0..2 {
            let (low, high) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
            if low > far || high < -far {
                return None;
            }
        }
        let weights = [cross(c, b), cross(a, c), cross(b, a)];
        let area = weights.iter().sum::<f64>();
        let inside = weights.iter().all(|&w| w > 0.0) || weights.iter().all(|&w| w < 0.0);
        let distance = distance(b, c).min(distance(c, a)).min(distance(a, b));
        if !inside && distance > self.corner {
            return None;
        }
        let depth = self.direction[kz];
        let certain = inside && distance > self.corner;
        let (low, high) = if certain {
            let z = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) / area;
            // The plane's slope in this frame turns an error sideways into one along the ray.
            let steep = |i: usize| {
                let j = 1 - i;
                let (e, f) = (sub(b, a), sub(c, a));
                (e[2] * f[j] - f[2] * e[j]) / (e[i] * f[j] - f[i] * e[j])
            };
            let error = self.corner * (1.0 + steep(0).abs() + steep(1).abs());
            let (lowest, highest) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
            ((z - error).max(lowest - self.corner), (z + error).min(highest + self.corner))
        } else {
            (a[2].min(b[2]).min(c[2]) - self.corner, a[2].max(b[2]).max(c[2]) + self.corner)
        };
        let (first, last) =
            if depth > 0.0 { (low / depth, high / depth) } else { (high / depth, low / depth) };
        Some(Possible { certain, first: first - ROUNDED * first.abs(), last: last + ROUNDED * last.abs() })
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// Twice the area of the triangle of two points and the origin.
fn cross(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// From the origin to a segment, in the plane.
fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let e = sub(b, a);
    let square = e[0] * e[0] + e[1] * e[1];
    let at = if square > 0.0 { (-(a[0] * e[0] + a[1] * e[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    let (x, y) = (a[0] + at * e[0], a[1] + at * e[1]);
    // Squares of what f32 holds are far from the ends of f64.
    (x * x + y * y).sqrt()
}
