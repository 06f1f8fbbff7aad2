//! Adapters, and one of them opened.

use crate::GpuError;
use crate::kernel::Kernel;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use wgpu::{Backends, Features, InstanceDescriptor, Limits};

/// What there is to trace on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adapter {
    /// The driver's name for it.
    pub name: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub kind: &'static str,
    /// `vulkan`, `metal` or `dx12`.
    pub backend: String,
    /// The driver and its version.
    pub driver: String,
    /// Bytes that one binding reaches; larger trees are sharded.
    pub binding_bytes: u64,
    /// Whether kernels are timed by the GPU itself.
    pub timestamps: bool,
}

impl Adapter {
    fn of(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        Self {
            kind: match info.device_type {
                wgpu::DeviceType::DiscreteGpu => "discrete",
                wgpu::DeviceType::IntegratedGpu => "integrated",
                wgpu::DeviceType::VirtualGpu => "virtual",
                wgpu::DeviceType::Cpu => "software",
                wgpu::DeviceType::Other => "other",
            },
            name: info.name,
            backend: info.backend.to_string(),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            binding_bytes: adapter.limits().max_storage_buffer_binding_size,
            timestamps: adapter.features().contains(Features::TIMESTAMP_QUERY),
        }
    }

    /// Hardware before software, discrete before integrated.
    fn rank(&self) -> usize {
        ["discrete", "integrated", "virtual", "other"].iter().position(|&k| k == self.kind).unwrap_or(4)
    }
}

/// Every adapter that can run compute shaders, the one that [`Device::open`] prefers first.
pub fn adapters() -> Vec<Adapter> {
    found().into_iter().map(|(adapter, _)| adapter).collect()
}

fn found() -> Vec<(Adapter, wgpu::Adapter)> {
    let mut descriptor = InstanceDescriptor::new_without_display_handle();
    descriptor.backends = Backends::VULKAN | Backends::METAL | Backends::DX12;
    let all = pollster::block_on(wgpu::Instance::new(descriptor).enumerate_adapters(Backends::all()));
    let compute = |adapter: &wgpu::Adapter| {
        let flags = adapter.get_downlevel_capabilities().flags;
        flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS)
    };
    let mut found: Vec<_> =
        all.into_iter().filter(compute).map(|adapter| (Adapter::of(&adapter), adapter)).collect();
    found.sort_by_key(|(adapter, _)| adapter.rank());
    found
}

/// An open adapter. Several trees may share one.
#[derive(Debug)]
pub struct Device {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(crate) limits: Limits,
    pub(crate) timestamps: bool,
    /// By their text.
    pub(crate) kernels: Mutex<HashMap<String, Kernel>>,
    adapter: Adapter,
    lost: Arc<Mutex<Option<String>>>,
}

impl Device {
    /// Opens the adapter whose name contains `name`, whatever its case; without a name, the best there is.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`], [`GpuError::NoSuchAdapter`], [`GpuError::Refused`].
    pub fn open(name: Option<&str>) -> Result<Self, GpuError> {
        let all = found();
        if all.is_empty() {
            return Err(GpuError::NoAdapter);
        }
        let matches = |adapter: &Adapter| {
            name.is_none_or(|name| adapter.name.to_lowercase().contains(&name.to_lowercase()))
        };
        let known: Vec<String> = all.iter().map(|(adapter, _)| adapter.name.clone()).collect();
        let (adapter, handle) = all.into_iter().find(|(adapter, _)| matches(adapter)).ok_or_else(|| {
            GpuError::NoSuchAdapter { name: name.unwrap_or_default().to_owned(), known: known.join(", ") }
        })?;
        let limits = handle.limits();
        let timestamps = adapter.timestamps;
        let (device, queue) = pollster::block_on(handle.request_device(&wgpu::DeviceDescriptor {
            label: Some("slimkd"),
            required_features: if timestamps { Features::TIMESTAMP_QUERY } else { Features::empty() },
            required_limits: limits.clone(),
            ..Default::default()
        }))
        .map_err(|error| GpuError::Refused { name: adapter.name.clone(), reason: error.to_string() })?;
        let lost = Arc::new(Mutex::new(None));
        let note = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            let text = if message.is_empty() { format!("{reason:?}") } else { message };
            note.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).get_or_insert(text);
        });
        let kernels = Mutex::default();
        Ok(Self { device, queue, limits, timestamps, kernels, adapter, lost })
    }

    /// What it is.
    pub fn adapter(&self) -> &Adapter {
        &self.adapter
    }

    /// Gives the device back to the system; what is asked of it afterwards ends with [`GpuError::Lost`].
    pub fn destroy(&self) {
        self.device.destroy();
        let mut lost = self.lost.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        lost.get_or_insert_with(|| "it was given back".to_owned());
    }

    /// Runs `work` and turns what the driver complains about into an error. `bytes` is what it allocates.
    pub(crate) fn guarded<T>(&self, bytes: u64, work: impl FnOnce() -> T) -> Result<T, GpuError> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let done = work();
        let internal = pollster::block_on(internal.pop());
        let validation = pollster::block_on(validation.pop());
        let memory = pollster::block_on(memory.pop());
        if internal.is_some() || validation.is_some() {
            let _ = self.device.poll(wgpu::PollType::Poll); // brings the news of a lost device
        }
        self.check()?;
        if memory.is_some() {
            return Err(GpuError::OutOfMemory { needed: bytes });
        }
        match internal.or(validation) {
            Some(error) => Err(GpuError::Kernel(one_line(&error.to_string()))),
            None => Ok(done),
        }
    }

    /// An error once the device is lost.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        match &*self.lost.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) {
            Some(reason) => Err(GpuError::Lost(reason.clone())),
            None => Ok(()),
        }
    }

    /// Waits until all that was submitted is done.
    pub(crate) fn wait(&self) -> Result<(), GpuError> {
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        polled.map(|_| ()).map_err(|error| GpuError::Lost(error.to_string()))
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
