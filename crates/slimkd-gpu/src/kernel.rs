//! Kernels, compiled once a device: trees of one shape share theirs.

use crate::{Device, GpuError};
use wgpu::ShaderStages;

/// A pipeline, and how its own bindings (group 1) are laid out.
#[derive(Clone, Debug)]
pub(crate) struct Kernel {
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layout: wgpu::BindGroupLayout,
}

impl Kernel {
    /// `text` over the image (group 0) and bindings of `kinds` (group 1).
    pub(crate) fn of(
        device: &Device,
        image: &wgpu::BindGroupLayout,
        kinds: &[wgpu::BufferBindingType],
        text: String,
        entry_point: &str,
    ) -> Result<Self, GpuError> {
        let mut known = device.kernels.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(kernel) = known.get(&text) {
            return Ok(kernel.clone());
        }
        let kernel = device.guarded(0, || compile(device, image, kinds, &text, entry_point))?;
        known.insert(text, kernel.clone());
        Ok(kernel)
    }
}

fn compile(
    device: &Device,
    image: &wgpu::BindGroupLayout,
    kinds: &[wgpu::BufferBindingType],
    text: &str,
    entry_point: &str,
) -> Kernel {
    let entries: Vec<_> = kinds
        .iter()
        .enumerate()
        .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry {
            binding: binding as u32,
            visibility: ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        })
        .collect();
    let device = &device.device;
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(entry_point),
        entries: &entries,
    });
    let both = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(entry_point),
        bind_group_layouts: &[Some(image), Some(&layout)],
        immediate_size: 0,
    });
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(entry_point),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry_point),
        layout: Some(&both),
        module: &module,
        entry_point: Some(entry_point),
        compilation_options: Default::default(),
        cache: None,
    });
    Kernel { pipeline, layout }
}
