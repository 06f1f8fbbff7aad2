//! Where an object stands: an orthogonal frame.

use super::math::sin_cos;
use glam::Vec3;

/// Right-handed orthogonal axes, possibly scaled, and an origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    x: Vec3,
    y: Vec3,
    z: Vec3,
    origin: Vec3,
}

impl Frame {
    pub(crate) const IDENTITY: Self = Self { x: Vec3::X, y: Vec3::Y, z: Vec3::Z, origin: Vec3::ZERO };

    /// Moved to `x, y, z`.
    pub(crate) fn at(x: f32, y: f32, z: f32) -> Self {
        Self { origin: Vec3::new(x, y, z), ..Self::IDENTITY }
    }

    /// Moved to `origin`.
    pub(crate) fn to(origin: Vec3) -> Self {
        Self { origin, ..Self::IDENTITY }
    }

    /// The frame at `origin` whose y axis points along `up`.
    pub(crate) fn upright(origin: Vec3, up: Vec3) -> Self {
        let y = up.normalize_or(Vec3::Y);
        let x = y.any_orthonormal_vector();
        Self { x, y, z: x.cross(y), origin }
    }

    /// Turned about its own y axis by `angle` radians (+z towards +x).
    #[must_use]
    pub(crate) fn turned(self, angle: f32) -> Self {
        let (s, c) = sin_cos(angle);
        Self { x: self.x * c - self.z * s, z: self.z * c + self.x * s, ..self }
    }

    /// Tilted about its own x axis by `angle` radians (+y towards +z).
    #[must_use]
    pub(crate) fn tilted(self, angle: f32) -> Self {
        let (s, c) = sin_cos(angle);
        Self { y: self.y * c + self.z * s, z: self.z * c - self.y * s, ..self }
    }

    /// Scaled along its own axes.
    #[must_use]
    pub(crate) fn scaled(self, x: f32, y: f32, z: f32) -> Self {
        Self { x: self.x * x, y: self.y * y, z: self.z * z, ..self }
    }

    /// `inner`, stated in this frame, in the outer one.
    pub(crate) fn then(&self, inner: &Self) -> Self {
        Self {
            x: self.vector(inner.x),
            y: self.vector(inner.y),
            z: self.vector(inner.z),
            origin: self.point(inner.origin),
        }
    }

    fn vector(&self, v: Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    pub(crate) fn point(&self, p: Vec3) -> Vec3 {
        self.origin + self.vector(p)
    }

    pub(crate) fn normal(&self, n: Vec3) -> Vec3 {
        let [x, y, z] = [self.x, self.y, self.z].map(Vec3::length_squared);
        (self.x * (n.x / x) + self.y * (n.y / y) + self.z * (n.z / z)).normalize_or(Vec3::Y)
    }
}
