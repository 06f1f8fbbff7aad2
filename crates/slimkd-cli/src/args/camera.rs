//! From where a scene is seen.

use super::parse::within;
use clap::{Args, ValueEnum};
use glam::DVec3;
use slimkd_scene::{Camera, UpAxis};
use std::str::FromStr;

/// Vertical field of view of a `--camera` that names none, degrees.
const DEFAULT_FOV: f32 = 60.0;

/// Sine of the angle between view and up below which another up is taken.
const LEAST_SINE: f32 = 1e-3;

/// One view.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "View")]
pub(crate) struct CameraArgs {
    /// Which of the scene's three views, 1 to 3: the file's cameras, else views found by looking around
    #[arg(long, value_name = "1..3", value_parser = within::<u8>(1..=3), conflicts_with = "camera")]
    pub(crate) view: Option<u8>,
    /// Eye, target and vertical field of view in degrees (60 unless given), in the scene's units
    #[arg(long, value_name = "ex,ey,ez,tx,ty,tz[,fov]", allow_hyphen_values = true)]
    camera: Option<RawCamera>,
    /// Which axis points up; what the file says unless given, else a guess from the scene's surfaces
    #[arg(long, value_enum)]
    up: Option<Up>,
}

impl CameraArgs {
    /// Up as given.
    pub(crate) fn up(&self) -> Option<UpAxis> {
        self.up.map(|up| match up {
            Up::X => UpAxis::X,
            Up::Y => UpAxis::Y,
            Up::Z => UpAxis::Z,
        })
    }

    /// The camera as given. It may look along the scene's `up`, unless that is what the command line says: then it
    /// would have no upright picture. What it says is in the world; the camera is in coordinates of a scene that has its `origin` there.
    pub(crate) fn camera(&self, up: UpAxis, origin: [f64; 3]) -> Option<Camera> {
        let RawCamera { eye, target, fov } = self.camera?;
        let forward = (target - eye).normalize_or_zero().as_vec3();
        let [eye, target] = [eye, target].map(|point| (point - DVec3::from(origin)).as_vec3());
        let upright = |axis: &UpAxis| forward.cross(axis.vector()).length() > LEAST_SINE;
        let other = [up, UpAxis::Y, UpAxis::Z].into_iter().find(upright).filter(|_| self.up.is_none());
        Some(Camera { eye, target, up: other.unwrap_or(up).vector(), fov })
    }
}

/// An axis.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Up {
    X,
    Y,
    Z,
}

/// What `--camera` says.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RawCamera {
    eye: DVec3,
    target: DVec3,
    fov: f32,
}

impl FromStr for RawCamera {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split(',').map(|part| part.trim().parse::<f64>().ok().filter(|x| x.is_finite()));
        let numbers = numbers.collect::<Option<Vec<_>>>().unwrap_or_default();
        let (place, fov) = match numbers[..] {
            [ex, ey, ez, tx, ty, tz] => ([ex, ey, ez, tx, ty, tz], DEFAULT_FOV),
            [ex, ey, ez, tx, ty, tz, fov] => ([ex, ey, ez, tx, ty, tz], fov as f32),
            _ => {
                return Err("expected 6 or 7 numbers with commas between: ex,ey,ez,tx,ty,tz[,fov]".to_owned());
            }
        };
        let camera =
            Self { eye: DVec3::from_slice(&place[..3]), target: DVec3::from_slice(&place[3..]), fov };
        if camera.eye == camera.target {
            return Err("eye and target are the same point; move one of them".to_owned());
        }
        if !(fov > 0.0 && fov < 180.0) {
            return Err("the field of view must lie between 0 and 180 degrees".to_owned());
        }
        Ok(camera)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras() {
        let camera: RawCamera = "-400,-600,300, 100,0,20,55".parse().unwrap();
        assert_eq!(
            (camera.eye, camera.target, camera.fov),
            (DVec3::new(-400.0, -600.0, 300.0), DVec3::new(100.0, 0.0, 20.0), 55.0)
        );
        assert_eq!("0,0,0,1,0,0".parse::<RawCamera>().unwrap().fov, DEFAULT_FOV);
        for wrong in [
            "",
            "1,2,3",
            "0,0,0,0,0,0",
            "0,0,0,1,0,0,0",
            "0,0,0,1,0,0,180",
            "0,0,0,1,0,nan",
            "0,0,0,1,0,0,60,1",
        ] {
            assert!(wrong.parse::<RawCamera>().is_err(), "{wrong}");
        }
    }
}
