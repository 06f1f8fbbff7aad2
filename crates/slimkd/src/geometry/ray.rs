//! Rays as users give them.

/// A ray `origin + t · direction` for t in `[t_min, t_max]`.
///
/// `t` counts in units of `direction`, which may have any length but 0. A ray with a NaN, an infinite origin or
/// direction, a zero direction, or `t_min > t_max` is invalid and misses everything. A triangle that the ray meets at a `t` too large
/// for f32 is not hit.
///
/// ```
/// let ray = slimkd::Ray::new([0.0, 0.0, -5.0], [0.0, 0.0, 2.0]).with_range(0.0, 10.0);
/// assert_eq!(ray.at(2.5), [0.0, 0.0, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ray {
    /// Where the ray starts, in scene units.
    pub origin: [f32; 3],
    /// The smallest `t` that counts as a hit (inclusive), in units of the direction. It may be negative.
    pub t_min: f32,
    /// Where the ray goes; any length but 0.
    pub direction: [f32; 3],
    /// The largest `t` that counts as a hit (inclusive), in units of the direction. It may be infinite.
    pub t_max: f32,
}

impl Ray {
    /// A ray over `[0, ∞]`. Anything that turns into `[f32; 3]` will do, so glam's and nalgebra's vectors too.
    pub fn new(origin: impl Into<[f32; 3]>, direction: impl Into<[f32; 3]>) -> Self {
        Self { origin: origin.into(), direction: direction.into(), t_min: 0.0, t_max: f32::INFINITY }
    }

    /// This ray with another range: hits count where `t_min ≤ t ≤ t_max`.
    #[must_use]
    pub fn with_range(mut self, t_min: f32, t_max: f32) -> Self {
        self.t_min = t_min;
        self.t_max = t_max;
        self
    }

    /// The point at `t`.
    pub fn at(&self, t: f32) -> [f32; 3] {
        std::array::from_fn(|k| self.origin[k] + t * self.direction[k])
    }

    /// False for rays that miss by definition.
    pub fn is_valid(&self) -> bool {
        self.origin.iter().chain(&self.direction).all(|x| x.is_finite())
            && self.direction.iter().any(|&x| x != 0.0)
            && self.t_min <= self.t_max
    }
}
