//! Whole pictures on the GPU: what [`slimkd_render::render`] shows, by one kernel a pixel that follows Whitted's tree of rays.
//!
//! ```no_run
//! use slimkd_gpu::frame::GpuScene;
//! use slimkd_gpu::{Device, UploadOptions};
//! use slimkd_render::{RenderSettings, Setup};
//! # use {slimkd::{KdTree, Progress}, slimkd_scene::{Camera, Scene}};
//! # fn show(scene: Scene, tree: KdTree, camera: Camera) -> Result<(), Box<dyn std::error::Error>> {
//! let device = Device::open(None)?;
//! let settings = RenderSettings::sized(640, 480);
//! let setup = Setup::new(&scene, &tree, &camera, &scene.lights, &settings)?;
//! let gpu = GpuScene::upload(&device, &scene, &tree, &UploadOptions::default())?;
//! let (film, time) = gpu.render(&setup, &settings, &Progress::new())?;
//! # Ok(())
//! # }
//! ```
//!
//! # How near to the CPU's picture
//!
//! What decides where a ray starts or goes is computed as on the CPU, f64 as sums of two floats; colours are f32 as there, in
//! another order. At most a pixel in a thousand differs by more than 1/255, at edges of things and of shadows.

mod words;

pub use words::Frame;

use crate::image::Image;
use crate::kernel::Kernel;
use crate::stamps::Stamps;
use crate::trace::no_image;
use crate::upload::Uploaded;
use crate::{Device, GpuError, GpuTime, UploadOptions, source};
use slimkd::{KdTree, Progress};
use slimkd_render::{Film, RenderError, RenderSettings, RenderStatistics, Setup};
use slimkd_scene::Scene;
use std::time::Instant;
use thiserror::Error;
use wgpu::{BufferBindingType, BufferUsages};

/// Edge of a tile, pixels: what one dispatch renders of one sample. In hardware it is done before a display's watchdog barks,
/// and fills any GPU.
const TILE: u32 = 512;
/// The same of a software GPU: a fraction of a second or a few, so that cancelling does not take long.
const SOFTWARE_TILE: u32 = 128;
/// Bytes of a tile's pixel.
const PIXEL_BYTES: u64 = 16;
/// Bytes of the counters of rays.
const COUNTER_BYTES: u64 = 16;

/// Why there is no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FrameError {
    /// The GPU failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// It was cancelled, or cannot be rendered anywhere.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A scene and its tree on a device.
#[derive(Debug)]
pub struct GpuScene<'d> {
    device: &'d Device,
    uploaded: Uploaded,
    /// Where what shading reads is.
    words: Frame,
    block: [u32; 2],
    bytes: u64,
}

/// Of one picture.
struct Buffers {
    frame: wgpu::Buffer,
    film: wgpu::Buffer,
    counters: wgpu::Buffer,
    read_film: wgpu::Buffer,
    read_counters: wgpu::Buffer,
    group: wgpu::BindGroup,
    stamps: Stamps,
}

/// A dispatch's part of the picture.
#[derive(Clone, Copy)]
struct Tile {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

impl<'d> GpuScene<'d> {
    /// Uploads the tree's bytes, the mesh and what shading reads of the scene.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn upload(
        device: &'d Device,
        scene: &Scene,
        tree: &KdTree,
        options: &UploadOptions,
    ) -> Result<Self, GpuError> {
        device.check()?;
        let mut image = Image::new(tree).ok_or_else(|| no_image(tree))?;
        let words = Frame::append(&mut image, scene).ok_or_else(|| no_image(tree))?;
        let uploaded = Uploaded::new(device, &image, options.stack.max(1), options.binding_limit)?;
        let (block, bytes) = (options.block.map(|edge| edge.max(1)), image.bytes());
        Ok(Self { device, uploaded, words, block, bytes })
    }

    /// Bytes of tree, mesh and shading on the GPU.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// How many bindings they take.
    pub fn shards(&self) -> u32 {
        self.uploaded.shape.shards
    }

    /// Renders the picture that `setup` prepares, with the same bits each time. The first of a [`RenderSettings::max_depth`]
    /// compiles its kernel.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`], [`RenderError::Film`], [`GpuError::Lost`], [`GpuError::OutOfMemory`], [`GpuError::Kernel`].
    pub fn render(
        &self,
        setup: &Setup<'_>,
        settings: &RenderSettings,
        progress: &Progress,
    ) -> Result<(Film, GpuTime), FrameError> {
        let mut film = Film::new(settings.width, settings.height).map_err(RenderError::from)?;
        let kernel = self.kernel(settings.max_depth)?;
        let started = Instant::now();
        let (mut frame, lights) = self.words.of_picture(setup, settings);
        let edge = if self.device.adapter().kind == "software" { SOFTWARE_TILE } else { TILE };
        let edge = edge.min(settings.width.max(settings.height));
        let pixels = u64::from(edge) * u64::from(edge);
        let buffers =
            self.device.guarded(2 * pixels * PIXEL_BYTES, || self.buffers(&kernel, pixels, &lights))?;
        let mut time = GpuTime::default();
        let tiles = tiles(settings.width, settings.height, edge);
        let steps = tiles.len() as u64 * u64::from(settings.samples);
        let mut done = 0;
        for tile in tiles {
            for sample in 0..settings.samples {
                if progress.is_cancelled() {
                    return Err(RenderError::Cancelled.into());
                }
                (frame.first_sample, frame.sample_count) = (sample, 1);
                let last = sample + 1 == settings.samples;
                let (took, rays) = self.dispatch(&kernel, &buffers, frame, tile, last)?;
                time.kernels += took;
                film.add_rays(rays);
                done += 1;
                progress.set(done as f64 / steps as f64);
            }
            fetch(&buffers, tile, settings.samples, &mut film)?;
        }
        time.total = started.elapsed();
        Ok((film, time))
    }

    /// The rays that may wait are written into it.
    fn kernel(&self, max_depth: u32) -> Result<Kernel, GpuError> {
        let [x, y] = self.block;
        // A node's two rays take its own place and one more.
        let constants = format!(
            "const PENDING = {}u;\nconst BLOCK_X = {x}u;\nconst BLOCK_Y = {y}u;\n",
            max_depth.saturating_add(1)
        );
        let mut parts = vec![words::FRAME_WGSL, &constants];
        parts.extend(source::FRAME);
        let text = source::module(self.uploaded.shape, &parts);
        let kinds = [
            BufferBindingType::Uniform,
            BufferBindingType::Storage { read_only: true },
            BufferBindingType::Storage { read_only: false },
            BufferBindingType::Storage { read_only: false },
        ];
        Kernel::of(self.device, &self.uploaded.layout, &kinds, text, "render_frame")
    }

    fn buffers(&self, kernel: &Kernel, pixels: u64, lights: &[[f32; 8]]) -> Buffers {
        let Device { device, queue, .. } = self.device;
        let buffer = |size: u64, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("slimkd picture"),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let read = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
        let written = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let frame = buffer(size_of::<Frame>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let light_bytes = bytemuck::cast_slice(lights);
        let lights = buffer(light_bytes.len().max(32) as u64, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        queue.write_buffer(&lights, 0, light_bytes);
        let film = buffer(pixels * PIXEL_BYTES, written);
        let counters = buffer(COUNTER_BYTES, written | BufferUsages::COPY_DST);
        let bound = [&frame, &lights, &film, &counters];
        let entries: Vec<_> = (0..)
            .zip(bound)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &kernel.layout,
            entries: &entries,
        });
        let read_film = buffer(pixels * PIXEL_BYTES, read);
        let read_counters = buffer(COUNTER_BYTES, read);
        let stamps = Stamps::new(self.device);
        Buffers { frame, film, counters, read_film, read_counters, group, stamps }
    }

    /// Renders one sample of a tile and counts its rays; with the last sample the film is left mapped. Returns the time in the
    /// kernel and the rays.
    fn dispatch(
        &self,
        kernel: &Kernel,
        buffers: &Buffers,
        frame: Frame,
        tile: Tile,
        last: bool,
    ) -> Result<(std::time::Duration, RenderStatistics), GpuError> {
        let Tile { x, y, width, height } = tile;
        let frame = Frame { tile_x: x, tile_y: y, tile_width: width, tile_height: height, ..frame };
        let submitted = self.device.guarded(0, || {
            let Device { device, queue, .. } = self.device;
            queue.write_buffer(&buffers.frame, 0, bytemuck::bytes_of(&frame));
            queue.write_buffer(&buffers.counters, 0, &[0; COUNTER_BYTES as usize]);
            let mut encoder = device.create_command_encoder(&Default::default());
            {
                let mut pass = buffers.stamps.pass(&mut encoder);
                pass.set_pipeline(&kernel.pipeline);
                pass.set_bind_group(0, &self.uploaded.group, &[]);
                pass.set_bind_group(1, &buffers.group, &[]);
                pass.dispatch_workgroups(width.div_ceil(self.block[0]), height.div_ceil(self.block[1]), 1);
            }
            encoder.copy_buffer_to_buffer(&buffers.counters, 0, &buffers.read_counters, 0, COUNTER_BYTES);
            let bytes = tile.bytes();
            if last {
                encoder.copy_buffer_to_buffer(&buffers.film, 0, &buffers.read_film, 0, bytes);
            }
            buffers.stamps.resolve(&mut encoder);
            let submitted = Instant::now();
            queue.submit([encoder.finish()]);
            buffers.read_counters.map_async(wgpu::MapMode::Read, .., |_| ());
            if last {
                buffers.read_film.map_async(wgpu::MapMode::Read, ..bytes, |_| ());
            }
            buffers.stamps.map();
            submitted
        })?;
        self.device.wait()?;
        let took = buffers.stamps.read(self.device, submitted.elapsed())?;
        let counted: [u32; 4] = {
            let view = buffers.read_counters.get_mapped_range(..).map_err(lost)?;
            bytemuck::pod_read_unaligned(&view)
        };
        buffers.read_counters.unmap();
        let mut rays = RenderStatistics::default();
        rays.primary = u64::from(width) * u64::from(height);
        [rays.shadow, rays.reflection, rays.refraction, rays.occlusion] = counted.map(u64::from);
        Ok((took, rays))
    }
}

/// Copies a tile's mapped sums to its place in the film.
fn fetch(buffers: &Buffers, tile: Tile, samples: u32, film: &mut Film) -> Result<(), GpuError> {
    {
        let view = buffers.read_film.get_mapped_range(..tile.bytes()).map_err(lost)?;
        let width = film.width() as usize;
        let rows = view.chunks_exact(tile.width as usize * PIXEL_BYTES as usize);
        for (row, y) in rows.zip(tile.y..) {
            let start = y as usize * width + tile.x as usize;
            let pixels = &mut film.pixels_mut()[start..start + tile.width as usize];
            for (pixel, sum) in pixels.iter_mut().zip(row.chunks_exact(PIXEL_BYTES as usize)) {
                let [r, g, b, _] = bytemuck::pod_read_unaligned::<[f32; 4]>(sum);
                *pixel = [r, g, b].map(|sum| sum / samples as f32);
            }
        }
    }
    buffers.read_film.unmap();
    Ok(())
}

impl Tile {
    fn bytes(self) -> u64 {
        u64::from(self.width) * u64::from(self.height) * PIXEL_BYTES
    }
}

/// Tiles of that edge that cover the picture, in rows from the top.
fn tiles(width: u32, height: u32, edge: u32) -> Vec<Tile> {
    let mut tiles = Vec::new();
    for y in (0..height).step_by(edge as usize) {
        for x in (0..width).step_by(edge as usize) {
            tiles.push(Tile { x, y, width: edge.min(width - x), height: edge.min(height - y) });
        }
    }
    tiles
}

fn lost(error: impl std::fmt::Display) -> GpuError {
    GpuError::Lost(error.to_string())
}
