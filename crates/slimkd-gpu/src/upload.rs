//! The image in the GPU's memory: as many bindings as it needs.

use crate::image::Image;
use crate::source::Shape;
use crate::{Device, GpuError};
use wgpu::{BufferUsages, ShaderStages};

/// Storage bindings that a kernel needs beside the shards.
const OTHER_BINDINGS: u32 = 3;
/// Bytes that are handed to the driver at once.
const PIECE: usize = 16 << 20;

/// An image on a device, bound as group 0.
#[derive(Debug)]
pub(crate) struct Uploaded {
    pub(crate) layout: wgpu::BindGroupLayout,
    pub(crate) group: wgpu::BindGroup,
    pub(crate) shape: Shape,
}

impl Uploaded {
    /// `binding_limit` (bytes) stands in for the adapter's own where it is smaller.
    pub(crate) fn new(
        device: &Device,
        image: &Image,
        ring: u32,
        binding_limit: Option<u64>,
    ) -> Result<Self, GpuError> {
        let limits = &device.limits;
        let own = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let largest = binding_limit.map_or(own, |limit| limit.min(own)).clamp(1024, 1 << 33);
        let shard_words = 1u32 << (largest / 4).ilog2();
        let shards = image.words.len().div_ceil(shard_words as usize).max(1) as u64;
        let most = limits.max_storage_buffers_per_shader_stage.saturating_sub(OTHER_BINDINGS);
        if shards > u64::from(most) {
            let limit = u64::from(most) * u64::from(shard_words) * 4;
            return Err(GpuError::TooLarge { needed: image.bytes(), limit });
        }
        let shards = shards as u32;
        let shape = Shape { dense: image.dense, shards, shard_words, ring, depth: image.depth };

        let entry = |binding: u32| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match binding {
                    0 => wgpu::BufferBindingType::Uniform,
                    _ => wgpu::BufferBindingType::Storage { read_only: true },
                },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let entries: Vec<_> = (0..=shards).map(entry).collect();
        let pieces: Vec<&[u32]> = image.words.chunks(shard_words as usize).collect();
        let buffer = |bytes: u64, usage| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("slimkd tree"),
                size: bytes.max(16),
                usage: usage | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let (layout, group) = device.guarded(image.bytes(), || {
            let uniform = buffer(size_of_val(&image.params) as u64, BufferUsages::UNIFORM);
            device.queue.write_buffer(&uniform, 0, bytemuck::bytes_of(&image.params));
            let mut buffers = vec![uniform];
            for k in 0..shards as usize {
                let words = pieces.get(k).copied().unwrap_or_default();
                buffers.push(buffer(4 * words.len() as u64, BufferUsages::STORAGE));
            }
            let layout = device.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("slimkd tree"),
                entries: &entries,
            });
            let bound: Vec<_> = buffers
                .iter()
                .enumerate()
                .map(|(k, buffer)| wgpu::BindGroupEntry {
                    binding: k as u32,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            let group = device.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("slimkd tree"),
                layout: &layout,
                entries: &bound,
            });
            for (buffer, words) in buffers[1..].iter().zip(&pieces) {
                for (k, piece) in words.chunks(PIECE / 4).enumerate() {
                    device.queue.write_buffer(buffer, (k * PIECE) as u64, bytemuck::cast_slice(piece));
                    device.queue.submit([]);
                }
            }
            (layout, group)
        })?;
        device.wait()?;
        Ok(Self { layout, group, shape })
    }
}
