//! Arithmetic that gives the same bits on every machine, and a small random number generator.
//!
//! `f32::sin` calls the platform's library, whose last bit differs from one to the next; IEEE 754 fixes only
//! `+ - * /` and the square root, so sine and cosine are polynomials here.

use glam::Vec3;
use std::f64::consts::FRAC_PI_2;

/// One full turn in radians.
pub(crate) const TURN: f32 = std::f32::consts::TAU;

/// Sine and cosine of `angle` (radians). Taylor series on [-π/4, π/4], error below 1e-11 before rounding to f32.
pub(crate) fn sin_cos(angle: f32) -> (f32, f32) {
    let angle = f64::from(angle);
    let quadrant = (angle / FRAC_PI_2).round();
    let x = angle - quadrant * FRAC_PI_2;
    let xx = x * x;
    let sin =
        x * (1.0 - xx / 6.0 * (1.0 - xx / 20.0 * (1.0 - xx / 42.0 * (1.0 - xx / 72.0 * (1.0 - xx / 110.0)))));
    let cos = 1.0 - xx / 2.0 * (1.0 - xx / 12.0 * (1.0 - xx / 30.0 * (1.0 - xx / 56.0 * (1.0 - xx / 90.0))));
    let (sin, cos) = match quadrant.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    };
    (sin as f32, cos as f32)
}

/// Sine of `angle` (radians).
pub(crate) fn sin(angle: f32) -> f32 {
    sin_cos(angle).0
}

/// Cosine of `angle` (radians).
pub(crate) fn cos(angle: f32) -> f32 {
    sin_cos(angle).1
}

/// The point of the unit circle in the plane y = 0 at `angle` (radians) from +x towards +z.
pub(crate) fn around(angle: f32) -> Vec3 {
    let (s, c) = sin_cos(angle);
    Vec3::new(c, 0.0, s)
}

/// The workspace's generator, with what scenes are made of.
#[derive(Clone, Debug)]
pub(crate) struct Rng(slimkd_util::Rng);

impl Rng {
    pub(crate) fn new(seed: u64) -> Self {
        Self(slimkd_util::Rng::new(seed))
    }

    /// A generator of its own, for one object: what the object draws does not disturb its neighbours.
    pub(crate) fn fork(&mut self) -> Self {
        Self(self.0.fork())
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f32 {
        self.0.unit()
    }

    /// Uniform in [low, high).
    pub(crate) fn range(&mut self, low: f32, high: f32) -> f32 {
        self.0.between(low, high)
    }

    /// Uniform in [-1, 1).
    pub(crate) fn signed(&mut self) -> f32 {
        self.range(-1.0, 1.0)
    }

    /// Uniform in 0..n; 0 for n = 0.
    pub(crate) fn below(&mut self, n: u32) -> u32 {
        ((u64::from(n) * (self.0.bits() >> 32)) >> 32) as u32
    }

    /// Uniform on the unit sphere.
    pub(crate) fn direction(&mut self) -> Vec3 {
        let y = self.signed();
        let r = (1.0 - y * y).max(0.0).sqrt();
        around(TURN * self.unit()) * r + Vec3::Y * y
    }

    /// Uniform in the box between two corners.
    pub(crate) fn point(&mut self, min: Vec3, max: Vec3) -> Vec3 {
        min + (max - min) * Vec3::new(self.unit(), self.unit(), self.unit())
    }
}

/// Smooth value noise in [-1, 1] with a period far beyond any scene; one unit is one lattice cell.
pub(crate) fn noise(p: Vec3) -> f32 {
    let cell = p.floor();
    let f = p - cell;
    let f = f * f * (Vec3::splat(3.0) - 2.0 * f);
    let at = |x: i32, y: i32, z: i32| {
        let [i, j, k] =
            [cell.x as i32 + x, cell.y as i32 + y, cell.z as i32 + z].map(|c| u64::from(c as u32));
        let mut rng = Rng::new(
            i.wrapping_mul(0x8DA6_B343) ^ j.wrapping_mul(0xD816_3841) ^ (k.wrapping_mul(0xCB1A_B31F) << 20),
        );
        rng.signed()
    };
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let plane = |z: i32| mix(mix(at(0, 0, z), at(1, 0, z), f.x), mix(at(0, 1, z), at(1, 1, z), f.x), f.y);
    mix(plane(0), plane(1), f.z)
}
