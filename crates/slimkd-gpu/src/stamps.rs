//! How long a kernel takes, by the GPU's own clock where it has one.

use crate::{Device, GpuError};
use std::time::Duration;
use wgpu::{BufferUsages, ComputePass, ComputePassTimestampWrites};

/// Bytes of two stamps.
const BYTES: u64 = 16;

/// Stamps at the beginning and the end of a pass; none on an adapter without.
#[derive(Debug)]
pub(crate) struct Stamps(Option<Clock>);

#[derive(Debug)]
struct Clock {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    read: wgpu::Buffer,
}

impl Stamps {
    pub(crate) fn new(device: &Device) -> Self {
        let buffer = |usage| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("slimkd stamps"),
                size: BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        Self(device.timestamps.then(|| Clock {
            set: device.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: None,
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            }),
            resolved: buffer(BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            read: buffer(BufferUsages::COPY_DST | BufferUsages::MAP_READ),
        }))
    }

    /// A pass between stamps.
    pub(crate) fn pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> ComputePass<'e> {
        let timestamp_writes = self.0.as_ref().map(|clock| ComputePassTimestampWrites {
            query_set: &clock.set,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        });
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes })
    }

    /// After the pass.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(clock) = &self.0 {
            encoder.resolve_query_set(&clock.set, 0..2, &clock.resolved, 0);
            encoder.copy_buffer_to_buffer(&clock.resolved, 0, &clock.read, 0, BYTES);
        }
    }

    /// After submission.
    pub(crate) fn map(&self) {
        if let Some(clock) = &self.0 {
            clock.read.map_async(wgpu::MapMode::Read, .., |_| ());
        }
    }

    /// Time between the stamps once all is done; `waited` where there is no clock.
    pub(crate) fn read(&self, device: &Device, waited: Duration) -> Result<Duration, GpuError> {
        let Some(clock) = &self.0 else { return Ok(waited) };
        let ticks: [u64; 2] = {
            let view = clock.read.get_mapped_range(..).map_err(|error| GpuError::Lost(error.to_string()))?;
            bytemuck::pod_read_unaligned(&view)
        };
        clock.read.unmap();
        let period = f64::from(device.queue.get_timestamp_period());
        let nanoseconds = ticks[1].saturating_sub(ticks[0]) as f64 * period;
        // Drivers that write no stamp leave zeros.
        Ok(if nanoseconds > 0.0 { Duration::from_nanos(nanoseconds as u64) } else { waited })
    }
}
