//! Traces [`slimkd`]'s trees in compute shaders: the encoded tree is uploaded byte for byte as it is, with the bare indexed
//! mesh, and WGSL kernels walk it on any vendor's GPU through wgpu.
//!
//! ```
//! use slimkd::{BuildOptions, KdTree, Ray, TriangleMesh};
//! use slimkd_gpu::{Device, GpuError, GpuTree, UploadOptions};
//!
//! let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
//! let tree = KdTree::build(mesh, &BuildOptions::default())?;
//! let device = match Device::open(None) {
//!     Ok(device) => device,
//!     Err(GpuError::NoAdapter) => return Ok(()), // this machine has no GPU
//!     Err(other) => return Err(other.into()),
//! };
//! let gpu = GpuTree::upload(&device, &tree, &UploadOptions::default())?;
//! let mut hits = [None];
//! gpu.closest(&[Ray::new([0.2, 0.2, 5.0], [0.0, 0.0, -1.0])], &mut hits)?;
//! assert_eq!(hits[0].unwrap().triangle, 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How near to the CPU's hits
//!
//! Whether a triangle is hit is decided exactly as on the CPU: the sheared corners are the same floats, and the signs of the
//! edge functions are exact. t, u, v come from 48-bit arithmetic where the CPU has 53 bits, so t is the CPU's up to
//! [`t_bound`], nearly always to the last bit. Two triangles whose t differ by less may change places. Subnormal
//! numbers are flushed by many GPUs: scenes of 10⁻³⁰ units are not promised.
//!
//! [`twin`] is every kernel again in Rust over the same words, so that a difference is found in the kernel and not in the data.

mod device;
mod error;
#[cfg(feature = "render")]
pub mod frame;
mod image;
mod kernel;
mod source;
mod stamps;
mod trace;
pub mod twin;
mod upload;

pub use device::{Adapter, Device, adapters};
pub use error::GpuError;
pub use image::{Image, Params};
pub use trace::{GpuTime, GpuTree, UploadOptions};

use slimkd::{Aabb, Ray};

/// How far a kernel's t may lie from the CPU's `t` for the same triangle: two units in the last place, and 2⁻³⁶ of the way
/// to the far side of the scene (`bounds`), which matters where a ray starts on the triangle. A hit that near to an end of the
/// ray's range may be found on the other side of it.
pub fn t_bound(ray: &Ray, bounds: &Aabb, t: f32) -> f32 {
    let largest = |v: [f32; 3]| v.into_iter().fold(0.0f32, |most, x| most.max(x.abs()));
    let away = |corner: [f32; 3]| largest(std::array::from_fn(|k| corner[k] - ray.origin[k]));
    let reach = away(bounds.min).max(away(bounds.max));
    let far = f64::from(reach) / f64::from(largest(ray.direction));
    (f64::from(t.abs()) * 2.0 * f64::from(f32::EPSILON) + far * REACH_SHARE) as f32
}

/// 2⁻³⁶.
const REACH_SHARE: f64 = 1.0 / (1u64 << 36) as f64;
