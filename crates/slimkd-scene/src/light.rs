//! Lights without area.

use glam::Vec3;

/// A light. Colours are linear sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Shines from a point; irradiance at distance d is `intensity / d²` (scene units).
    Point {
        /// Where it is, scene units.
        position: Vec3,
        /// Radiant intensity.
        intensity: Vec3,
    },
    /// Shines from infinitely far.
    Directional {
        /// The direction in which the light travels; any length but 0.
        direction: Vec3,
        /// Irradiance on a surface that faces the light.
        irradiance: Vec3,
    },
}
