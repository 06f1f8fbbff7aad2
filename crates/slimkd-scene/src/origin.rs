//! Where in the world a mesh's coordinates are 0: chosen, subtracted and counted here, for every format.
//!
//! f32 has 24 bits. Coordinates of 5·10⁵ m that are far from 0 compared with the model's extent spend most of them on where the model is: steps are 0.03 m
//! there. So such a file is read a second time with an origin that is subtracted in f64, before anything is rounded. A model near 0 is read
//! once, and nothing changes for it.

use crate::{Light, Scene};
use glam::Vec3;
use slimkd::{MeshError, TriangleMesh};
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// A model is far from 0 on an axis where it reaches more than so many times its largest extent.
const FAR: f64 = 8.0;

/// Which point of a file's coordinates becomes the mesh's 0: see [`TriangleMesh::origin`].
///
/// ```
/// use slimkd_scene::Origin;
/// assert_eq!("auto".parse(), Ok(Origin::Auto));
/// assert_eq!("528980,183524,0".parse(), Ok(Origin::At([528_980.0, 183_524.0, 0.0])));
/// assert_eq!(Origin::At([0.5, 0.0, 0.0]).to_string(), "0.5,0,0");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Origin {
    /// 0 on each axis on which the model reaches no more than 8 times its largest extent away from 0; else near the middle of the model, a
    /// multiple of the power of two at or above that extent.
    #[default]
    Auto,
    /// 0, however far the model is.
    None,
    /// This point.
    At([f64; 3]),
}

/// What is no [`Origin`]: write `auto`, `none` or `x,y,z`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is no origin; write auto, none or three numbers x,y,z")]
pub struct UnknownOrigin(String);

impl FromStr for Origin {
    type Err = UnknownOrigin;

    fn from_str(text: &str) -> Result<Self, UnknownOrigin> {
        match text {
            "auto" => return Ok(Self::Auto),
            "none" => return Ok(Self::None),
            _ => {}
        }
        let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
        let origin = numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
        // Beyond this a coordinate of f32 has no place behind the subtraction.
        let origin = origin.filter(|origin| origin.iter().all(|x| x.abs() < f64::from(f32::MAX)));
        origin.map(Self::At).ok_or_else(|| UnknownOrigin(text.to_owned()))
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::None => f.write_str("none"),
            Self::At([x, y, z]) => write!(f, "{x},{y},{z}"),
        }
    }
}

impl Origin {
    /// The origin of a mesh that was read as it is; 0 where it needs none.
    pub(crate) fn choose(self, mesh: &TriangleMesh) -> [f64; 3] {
        match self {
            Self::At(origin) => return origin,
            Self::None => return [0.0; 3],
            Self::Auto => {}
        }
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for vertex in mesh.vertices().iter().filter(|vertex| vertex.iter().all(|x| x.is_finite())) {
            for (k, x) in vertex.map(f64::from).into_iter().enumerate() {
                (low[k], high[k]) = (low[k].min(x), high[k].max(x));
            }
        }
        let extent = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        // A single point needs none; steps near the ends of f32 do not exist.
        if !(extent > 0.0 && extent < 1e30) {
            return [0.0; 3];
        }
        let step = extent.log2().ceil().exp2();
        std::array::from_fn(|k| {
            let is_far = low[k].abs().max(high[k].abs()) > FAR * extent;
            if is_far { (0.5 * (low[k] + high[k]) / step).round() * step } else { 0.0 }
        })
    }
}

/// What loaders put positions through: subtracts an origin in f64 and rounds to f32.
#[derive(Debug, Default)]
pub(crate) struct Frame {
    origin: [f64; 3],
    /// Positions are read as exactly as the file says them, and roundings are measured.
    is_exact: bool,
    /// The largest rounding of what was put together of parts, before that; as below.
    carried: AtomicU64,
    /// The largest rounding on each axis, the bits of an f64; those of numbers above 0 are in the numbers' order.
    rounding: [AtomicU64; 3],
}

impl Frame {
    pub(crate) fn new(origin: [f64; 3]) -> Self {
        Self { origin, is_exact: origin != [0.0; 3], ..Self::default() }
    }

    /// One that measures how far it moves positions by rounding, though the origin be 0.
    fn measuring(origin: [f64; 3]) -> Self {
        Self { is_exact: true, ..Self::new(origin) }
    }

    /// Whether loaders have to read positions in f64. Where not, they may read them as f32 at once.
    pub(crate) fn is_exact(&self) -> bool {
        self.is_exact
    }

    /// Reads a part of a scene, which is put into the world later: where that is to be exact, with an origin of its own.
    pub(crate) fn part<E>(&self, read: impl Fn(&Self) -> Result<Scene, E>) -> Result<Scene, E> {
        if !self.is_exact {
            return read(&Self::default());
        }
        let mut frame = Self::measuring([0.0; 3]);
        let mut scene = read(&frame)?;
        let origin = Origin::Auto.choose(&scene.mesh);
        if origin != [0.0; 3] {
            frame = Self::measuring(origin);
            drop(scene);
            scene = read(&frame)?;
        }
        frame.finish(&mut scene);
        Ok(scene)
    }

    /// A frame for a part that is made around a point.
    pub(crate) fn around(&self, point: [f64; 3]) -> Self {
        if self.is_exact { Self::measuring(point) } else { Self::default() }
    }

    /// Positions had been moved by as much before they came here.
    pub(crate) fn carry(&self, rounding: f64) {
        self.carried.fetch_max(rounding.abs().to_bits(), Relaxed);
    }

    /// A coordinate of the file on an axis, before it is rounded.
    pub(crate) fn near(&self, axis: usize, coordinate: f64) -> f64 {
        coordinate - self.origin[axis]
    }

    /// The same of a position, such as a camera's.
    pub(crate) fn near_all(&self, position: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| self.near(k, position[k]))
    }

    /// A coordinate of the file on an axis.
    pub(crate) fn axis(&self, axis: usize, coordinate: f64) -> f32 {
        let near = self.near(axis, coordinate);
        let rounded = near as f32;
        if self.is_exact && rounded.is_finite() {
            let rounding = (f64::from(rounded) - near).abs();
            self.rounding[axis].fetch_max(rounding.to_bits(), Relaxed);
        }
        rounded
    }

    /// A position of the file.
    pub(crate) fn put(&self, position: [f64; 3]) -> [f32; 3] {
        std::array::from_fn(|k| self.axis(k, position[k]))
    }

    /// A position that the file has in f32.
    pub(crate) fn put_f32(&self, position: [f32; 3]) -> [f32; 3] {
        if self.is_exact { self.put(position.map(f64::from)) } else { position }
    }

    /// No vertex was moved farther than this by rounding.
    pub(crate) fn rounding(&self) -> f64 {
        let axes = self.rounding.each_ref().map(|bits| f64::from_bits(bits.load(Relaxed)));
        f64::from_bits(self.carried.load(Relaxed)) + axes.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Tells a scene, whose positions all went through this, where it is.
    pub(crate) fn finish(&self, scene: &mut Scene) {
        if self.is_exact {
            scene.mesh = Arc::new(TriangleMesh::clone(&scene.mesh).with_origin(self.origin));
            scene.rounding = self.rounding();
        }
    }
}

impl Scene {
    /// Moves the mesh, cameras and lights to another origin.
    pub(crate) fn move_to(&mut self, origin: [f64; 3]) -> Result<(), MeshError> {
        let from = self.mesh.origin();
        if from == origin {
            return Ok(());
        }
        let frame = Frame::new(std::array::from_fn(|k| origin[k] - from[k]));
        let shift = |point: &mut Vec3| *point = Vec3::from(frame.put_f32(point.to_array()));
        for camera in &mut self.cameras {
            shift(&mut camera.eye);
            shift(&mut camera.target);
        }
        for light in &mut self.lights {
            if let Light::Point { position, .. } = light {
                shift(position);
            }
        }
        // Roundings of vertices alone count.
        let frame = Frame::new(frame.origin);
        let vertices = self.mesh.vertices().iter().map(|vertex| frame.put_f32(*vertex)).collect();
        let mesh = TriangleMesh::new(vertices, self.mesh.triangles().to_vec())?;
        self.mesh = Arc::new(mesh.with_origin(origin));
        self.rounding += frame.rounding();
        Ok(())
    }
}
