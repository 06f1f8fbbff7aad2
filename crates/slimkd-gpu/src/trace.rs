//! Batches of rays through an uploaded tree.

use crate::image::Image;
use crate::kernel::Kernel;
use crate::stamps::Stamps;
use crate::upload::Uploaded;
use crate::{Device, GpuError, source};
use slimkd::{EncodedTree, Hit, KdTree, Ray};
use std::sync::Mutex;
use std::time::{Duration, Instant};
use wgpu::BufferUsages;

/// Rays of one dispatch, at most: short enough for a display's watchdog, long enough to fill any GPU.
const BATCH: usize = 1 << 18;
/// Threads of a workgroup; `shaders/trace.wgsl` says the same.
const WORKGROUP: u32 = 128;
const RAY_BYTES: u64 = 32;
const HIT_BYTES: u64 = 16;

/// How a tree is uploaded.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct UploadOptions {
    /// Bytes of one binding, at most; the adapter's limit unless given. Larger trees are cut into shards.
    pub binding_limit: Option<u64>,
    /// Entries of the short stack, 1 and up; 12 unless given. A ray that needs more restarts at the root.
    pub stack: u32,
    /// Width and height of a picture's workgroups, pixels; 4 × 32 unless given, as in the paper.
    pub block: [u32; 2],
}

impl Default for UploadOptions {
    fn default() -> Self {
        Self { binding_limit: None, stack: 12, block: [4, 32] }
    }
}

/// What a batch took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GpuTime {
    /// In kernels: by the GPU's own timestamps where it has them, else from submission to completion.
    pub kernels: Duration,
    /// All of it, copies included.
    pub total: Duration,
}

impl std::ops::AddAssign for GpuTime {
    fn add_assign(&mut self, other: Self) {
        self.kernels += other.kernels;
        self.total += other.total;
    }
}

/// A tree on a device.
#[derive(Debug)]
pub struct GpuTree<'d> {
    device: &'d Device,
    uploaded: Uploaded,
    kernel: Kernel,
    /// One batch at a time uses the buffers.
    buffers: Mutex<Option<Buffers>>,
    bytes: u64,
}

#[derive(Debug)]
struct Buffers {
    rays: u64,
    batch: wgpu::Buffer,
    input: wgpu::Buffer,
    output: wgpu::Buffer,
    read: wgpu::Buffer,
    stamps: Stamps,
}

impl<'d> GpuTree<'d> {
    /// Uploads the tree's bytes and the mesh, and compiles the kernels.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::OutOfMemory`], [`GpuError::Kernel`], [`GpuError::Lost`].
    pub fn upload(device: &'d Device, tree: &KdTree, options: &UploadOptions) -> Result<Self, GpuError> {
        device.check()?;
        let image = Image::new(tree).ok_or_else(|| no_image(tree))?;
        let uploaded = Uploaded::new(device, &image, options.stack.max(1), options.binding_limit)?;
        let bytes = image.bytes();
        drop(image);
        let text = source::module(uploaded.shape, &[source::TRACE]);
        let kinds = [
            wgpu::BufferBindingType::Uniform,
            wgpu::BufferBindingType::Storage { read_only: true },
            wgpu::BufferBindingType::Storage { read_only: false },
        ];
        let kernel = Kernel::of(device, &uploaded.layout, &kinds, text, "trace_rays")?;
        Ok(Self { device, uploaded, kernel, buffers: Mutex::new(None), bytes })
    }

    /// Bytes of tree and mesh on the GPU.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// How many bindings they take.
    pub fn shards(&self) -> u32 {
        self.uploaded.shape.shards
    }

    /// The nearest hits of a batch, in its order; see the crate's head for how near they are to the CPU's.
    ///
    /// # Errors
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn closest(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> Result<GpuTime, GpuError> {
        assert_eq!(rays.len(), hits.len(), "one hit slot a ray");
        self.trace(rays, false, |at, hit| hits[at] = hit)
    }

    /// Whether each ray of a batch hits anything.
    ///
    /// # Errors
    /// As [`GpuTree::closest`].
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn any(&self, rays: &[Ray], hits: &mut [bool]) -> Result<GpuTime, GpuError> {
        assert_eq!(rays.len(), hits.len(), "one answer slot a ray");
        self.trace(rays, true, |at, hit| hits[at] = hit.is_some())
    }

    fn trace(
        &self,
        rays: &[Ray],
        any: bool,
        mut answer: impl FnMut(usize, Option<Hit>),
    ) -> Result<GpuTime, GpuError> {
        let mut time = GpuTime::default();
        let mut buffers = self.buffers.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        for (number, batch) in rays.chunks(BATCH).enumerate() {
            let started = Instant::now();
            let buffers = self.room(&mut buffers, batch.len() as u64)?;
            let kernels = self.dispatch(buffers, batch, any)?;
            {
                let view = buffers
                    .read
                    .get_mapped_range(..batch.len() as u64 * HIT_BYTES)
                    .map_err(|error| GpuError::Lost(error.to_string()))?;
                for (k, record) in view.chunks_exact(16).enumerate() {
                    let [t, u, v, triangle] = bytemuck::pod_read_unaligned::<[u32; 4]>(record);
                    let found = (triangle != u32::MAX).then(|| Hit {
                        t: f32::from_bits(t),
                        u: f32::from_bits(u),
                        v: f32::from_bits(v),
                        triangle,
                    });
                    answer(number * BATCH + k, found);
                }
            }
            buffers.read.unmap();
            time += GpuTime { kernels, total: started.elapsed() };
        }
        Ok(time)
    }

    /// Buffers for that many rays, kept for the next batch.
    fn room<'b>(&self, slot: &'b mut Option<Buffers>, rays: u64) -> Result<&'b Buffers, GpuError> {
        let fits = slot.as_ref().is_some_and(|buffers| buffers.rays >= rays);
        let kept = if fits { slot.take() } else { None };
        let buffers = match kept {
            Some(buffers) => buffers,
            None => self.device.guarded(rays * (RAY_BYTES + 2 * HIT_BYTES), || self.buffers(rays))?,
        };
        Ok(slot.insert(buffers))
    }

    fn buffers(&self, rays: u64) -> Buffers {
        let buffer = |bytes: u64, usage| {
            self.device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("slimkd rays"),
                size: bytes,
                usage,
                mapped_at_creation: false,
            })
        };
        let read = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
        Buffers {
            rays,
            batch: buffer(16, BufferUsages::UNIFORM | BufferUsages::COPY_DST),
            input: buffer(rays * RAY_BYTES, BufferUsages::STORAGE | BufferUsages::COPY_DST),
            output: buffer(rays * HIT_BYTES, BufferUsages::STORAGE | BufferUsages::COPY_SRC),
            read: buffer(rays * HIT_BYTES, read),
            stamps: Stamps::new(self.device),
        }
    }

    /// Traces one batch and leaves its hits mapped; returns the time in the kernel.
    fn dispatch(&self, buffers: &Buffers, rays: &[Ray], any: bool) -> Result<Duration, GpuError> {
        let Device { device, queue, .. } = self.device;
        let words: Vec<[f32; 8]> = rays
            .iter()
            .map(|ray| {
                let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
                [ox, oy, oz, dx, dy, dz, ray.t_min, ray.t_max]
            })
            .collect();
        let submitted = self.device.guarded(0, || {
            queue.write_buffer(&buffers.input, 0, bytemuck::cast_slice(&words));
            let batch = [rays.len() as u32, u32::from(any), 0, 0];
            queue.write_buffer(&buffers.batch, 0, bytemuck::cast_slice(&batch));
            let bound = [&buffers.batch, &buffers.input, &buffers.output];
            let entries = [0, 1, 2]
                .map(|k| wgpu::BindGroupEntry { binding: k as u32, resource: bound[k].as_entire_binding() });
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &self.kernel.layout,
                entries: &entries,
            });
            let mut encoder = device.create_command_encoder(&Default::default());
            {
                let mut pass = buffers.stamps.pass(&mut encoder);
                pass.set_pipeline(&self.kernel.pipeline);
                pass.set_bind_group(0, &self.uploaded.group, &[]);
                pass.set_bind_group(1, &group, &[]);
                pass.dispatch_workgroups((rays.len() as u32).div_ceil(WORKGROUP), 1, 1);
            }
            let bytes = rays.len() as u64 * HIT_BYTES;
            encoder.copy_buffer_to_buffer(&buffers.output, 0, &buffers.read, 0, bytes);
            buffers.stamps.resolve(&mut encoder);
            let submitted = Instant::now();
            queue.submit([encoder.finish()]);
            buffers.read.map_async(wgpu::MapMode::Read, ..bytes, |_| ());
            buffers.stamps.map();
            submitted
        })?;
        self.device.wait()?;
        buffers.stamps.read(self.device, submitted.elapsed())
    }
}

/// Why a tree has no [`Image`]: its layout, or it is more than words can address.
pub(crate) fn no_image(tree: &KdTree) -> GpuError {
    if matches!(tree.encoded(), EncodedTree::Wide { .. }) {
        return GpuError::Wide;
    }
    GpuError::TooLarge { needed: tree.memory().resident(), limit: 4 * u64::from(u32::MAX) }
}
