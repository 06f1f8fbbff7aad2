//! Where the camera stands.

use crate::basics::vector::{Vec64, add_scaled, cross, normalized, sub, wide};
use serde::{Deserialize, Serialize};
use slimkd_scene::{Camera, UpAxis};

/// Vertical field of view where none is given, degrees.
pub const DEFAULT_FOV: f32 = 60.0;

/// A pinhole camera, as the JSON shows it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Where it stands.
    pub eye: [f32; 3],
    /// What it looks at.
    pub target: [f32; 3],
    /// Roughly upwards.
    pub up: [f32; 3],
    /// Vertical field of view, degrees.
    pub fov: f32,
}

impl From<Camera> for View {
    fn from(camera: Camera) -> Self {
        Self { eye: camera.eye.into(), target: camera.target.into(), up: camera.up.into(), fov: camera.fov }
    }
}

/// Right, upward (both scaled to half the picture's height) and forward.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    right: Vec64,
    upward: Vec64,
    forward: Vec64,
}

impl View {
    /// Reads `ex,ey,ez,tx,ty,tz[,fov]`; otherwise says what is wrong with the text.
    pub fn parse(text: &str, up: UpAxis) -> Result<Self, String> {
        let numbers: Vec<f32> = text
            .split(',')
            .map(|word| word.trim().parse().map_err(|_| format!("`{word}` in --camera is no number")))
            .collect::<Result<_, String>>()?;
        if !matches!(numbers.len(), 6 | 7) || numbers.iter().any(|x| !x.is_finite()) {
            return Err("--camera takes ex,ey,ez,tx,ty,tz[,fov], all finite".to_owned());
        }
        let view = Self {
            eye: [numbers[0], numbers[1], numbers[2]],
            target: [numbers[3], numbers[4], numbers[5]],
            up: up.vector().into(),
            fov: numbers.get(6).copied().unwrap_or(DEFAULT_FOV),
        };
        if view.fov <= 0.0 || view.fov >= 180.0 {
            return Err("the field of view in --camera must lie between 0 and 180".to_owned());
        }
        view.frame().ok_or("--camera has eye and target at one place")?;
        Ok(view)
    }

    /// The picture plane, or `None` when the camera looks nowhere. Looking along `up` takes another axis for it.
    pub fn frame(&self) -> Option<Frame> {
        let forward = normalized(sub(wide(self.target), wide(self.eye)))?;
        let right = [wide(self.up), [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
            .into_iter()
            .find_map(|up| normalized(cross(forward, up)).filter(|r| r.iter().all(|x| x.is_finite())))?;
        let scale = (f64::from(self.fov).to_radians() / 2.0).tan();
        let upward = cross(right, forward);
        Some(Frame { right: right.map(|x| x * scale), upward: upward.map(|x| x * scale), forward })
    }
}

impl Frame {
    /// Unit direction through (x, y) of the picture, each from −1 to 1, y upwards.
    pub fn direction(&self, x: f64, y: f64) -> [f32; 3] {
        let d = add_scaled(add_scaled(self.forward, x, self.right), y, self.upward);
        normalized(d).unwrap_or(self.forward).map(|x| x as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parses_and_refuses() {
        let view = View::parse("0,0,5, 0,0,0", UpAxis::Y).unwrap();
        assert_eq!((view.eye, view.fov), ([0.0, 0.0, 5.0], DEFAULT_FOV));
        assert_eq!(View::parse("0,0,5,0,0,0,90", UpAxis::Y).unwrap().fov, 90.0);
        for wrong in ["", "1,2,3", "0,0,5,0,0,x", "0,0,5,0,0,0,0", "1,1,1,1,1,1", "0,0,5,0,0,inf"] {
            assert!(View::parse(wrong, UpAxis::Y).is_err(), "{wrong}");
        }
    }

    #[test]
    fn looks_forward_right_and_up() {
        let frame = View::parse("0,0,5,0,0,0,90", UpAxis::Y).unwrap().frame().unwrap();
        assert_eq!(frame.direction(0.0, 0.0), [0.0, 0.0, -1.0]);
        assert!(frame.direction(1.0, 0.0)[0] > 0.7);
        assert!(frame.direction(0.0, 1.0)[1] > 0.7);
        // Straight down along the up axis still has a frame.
        assert!(View::parse("0,5,0,0,0,0", UpAxis::Y).unwrap().frame().is_some());
    }
}
