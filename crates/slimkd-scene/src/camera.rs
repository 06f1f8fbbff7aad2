//! Pinhole cameras.

use glam::Vec3;

/// Which world axis points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum UpAxis {
    /// +x
    X,
    /// +y
    #[default]
    Y,
    /// +z
    Z,
}

impl UpAxis {
    /// The unit vector.
    pub fn vector(self) -> Vec3 {
        match self {
            Self::X => Vec3::X,
            Self::Y => Vec3::Y,
            Self::Z => Vec3::Z,
        }
    }
}

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands, scene units.
    pub eye: Vec3,
    /// What it looks at, scene units.
    pub target: Vec3,
    /// Roughly upwards; need not be perpendicular or of unit length.
    pub up: Vec3,
    /// Vertical field of view, degrees.
    pub fov: f32,
}
