//! From a pinhole camera to its primary rays.

use glam::{DVec3, Vec2, Vec3};
use slimkd::Ray;
use slimkd_scene::Camera;
use thiserror::Error;

/// Why a camera cannot take a picture.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum CameraError {
    /// A component is NaN or infinite: state finite numbers.
    #[error("the camera's eye, target, up and field of view must be finite; check its numbers")]
    NotFinite,
    /// Eye and target are the same point, or closer than their numbers can tell: move one of them.
    #[error("the camera's eye and target are the same point; move one of them")]
    NoDirection,
    /// The up vector has no length or points along the view: choose another one.
    #[error("the camera's up vector is zero or parallel to its view; choose another up axis")]
    UpParallel,
    /// The vertical field of view is too narrow or too wide: choose one from 0.01 to 179 degrees.
    #[error("the field of view is {0} degrees; it must lie between {MIN_FOV} and {MAX_FOV}")]
    FieldOfView(f32),
}

/// Narrowest vertical field of view, degrees: a pixel is then still wider than the rounding of a direction.
pub(crate) const MIN_FOV: f32 = 0.01;
/// Widest vertical field of view, degrees: tan(fov / 2) is still about 115.
pub(crate) const MAX_FOV: f32 = 179.0;
/// Smallest sine between view and up.
const MIN_SINE: f64 = 1e-5;

/// A camera made ready: an orthonormal frame, scaled to the picture. For whoever traces a picture's primary rays without
/// rendering it.
///
/// ```
/// use glam::{Vec2, Vec3};
/// use slimkd_render::PinholeFrame;
/// use slimkd_scene::Camera;
///
/// let camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, fov: 90.0 };
/// let frame = PinholeFrame::new(&camera, 16.0 / 9.0)?;
/// assert_eq!(frame.ray(Vec2::splat(0.5)).direction, [0.0, 0.0, -1.0]);
/// # Ok::<(), slimkd_render::CameraError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PinholeFrame {
    eye: Vec3,
    forward: DVec3,
    /// Half the picture's width and height at distance 1.
    right: DVec3,
    up: DVec3,
}

impl PinholeFrame {
    /// Checks the camera; `aspect` is width over height.
    pub fn new(camera: &Camera, aspect: f64) -> Result<Self, CameraError> {
        let finite = camera.eye.is_finite() && camera.target.is_finite() && camera.up.is_finite();
        if !finite || !camera.fov.is_finite() {
            return Err(CameraError::NotFinite);
        }
        if !(MIN_FOV..=MAX_FOV).contains(&camera.fov) {
            return Err(CameraError::FieldOfView(camera.fov));
        }
        let forward = camera.target.as_dvec3() - camera.eye.as_dvec3();
        let forward = forward.try_normalize().ok_or(CameraError::NoDirection)?;
        let up = camera.up.as_dvec3().try_normalize().ok_or(CameraError::UpParallel)?;
        let right = forward.cross(up);
        if right.length() < MIN_SINE {
            return Err(CameraError::UpParallel);
        }
        let right = right.normalize();
        let half_height = (f64::from(camera.fov).to_radians() / 2.0).tan();
        let up = right.cross(forward) * half_height;
        Ok(Self { eye: camera.eye, forward, right: right * (half_height * aspect), up })
    }

    /// Where it stands.
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// To the picture's middle at distance 1, and from there to its right and its upper edge.
    pub fn axes(&self) -> [DVec3; 3] {
        [self.forward, self.right, self.up]
    }

    /// The ray through `point` on the picture, of unit direction: (0, 0) is the upper left corner, (1, 1) the lower right.
    pub fn ray(&self, point: Vec2) -> Ray {
        let (x, y) = (f64::from(point.x) * 2.0 - 1.0, 1.0 - f64::from(point.y) * 2.0);
        let direction = (self.forward + self.right * x + self.up * y).normalize();
        Ray::new(self.eye, direction.as_vec3())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: Camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, fov: 90.0 };

    #[test]
    fn corners_and_centre() {
        let frame = PinholeFrame::new(&CAMERA, 2.0).unwrap();
        let direction = |x, y| Vec3::from(frame.ray(Vec2::new(x, y)).direction);
        assert!(direction(0.5, 0.5).abs_diff_eq(Vec3::NEG_Z, 1e-6));
        assert!(direction(0.0, 0.0).abs_diff_eq(Vec3::new(-2.0, 1.0, -1.0).normalize(), 1e-6));
        assert!(direction(1.0, 1.0).abs_diff_eq(Vec3::new(2.0, -1.0, -1.0).normalize(), 1e-6));
    }

    #[test]
    fn impossible_cameras_are_refused() {
        let error = |camera: Camera| PinholeFrame::new(&camera, 1.0).unwrap_err();
        assert_eq!(error(Camera { target: Vec3::ZERO, ..CAMERA }), CameraError::NoDirection);
        assert_eq!(error(Camera { up: Vec3::Z, ..CAMERA }), CameraError::UpParallel);
        assert_eq!(error(Camera { up: Vec3::ZERO, ..CAMERA }), CameraError::UpParallel);
        assert_eq!(error(Camera { up: Vec3::NAN, ..CAMERA }), CameraError::NotFinite);
        for fov in [0.0, -10.0, 180.0, 400.0] {
            assert_eq!(error(Camera { fov, ..CAMERA }), CameraError::FieldOfView(fov));
        }
        assert_eq!(error(Camera { fov: f32::INFINITY, ..CAMERA }), CameraError::NotFinite);
    }

    #[test]
    fn far_from_the_origin_and_tiny() {
        let eye = Vec3::splat(1e30);
        let frame = PinholeFrame::new(&Camera { eye, target: -eye, ..CAMERA }, 1.0).unwrap();
        assert!(frame.ray(Vec2::splat(0.5)).is_valid());
        let target = Vec3::new(0.0, 0.0, 1e-30);
        assert!(PinholeFrame::new(&Camera { target, ..CAMERA }, 1.0).is_ok());
    }
}
