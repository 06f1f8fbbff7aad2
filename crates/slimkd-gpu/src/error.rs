//! What can go wrong on a GPU.

use thiserror::Error;

/// Why there is no answer.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum GpuError {
    /// Nothing here can run compute shaders: install a driver, or trace on the CPU.
    #[error(
        "no GPU that can run compute shaders was found; install its Vulkan, Metal or D3D12 driver, or use the CPU"
    )]
    NoAdapter,
    /// No adapter of that name: see the list.
    #[error("no adapter is called {name:?}; there are: {known}")]
    NoSuchAdapter {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// The adapter refused to open: use another, or the CPU.
    #[error("the GPU {name} cannot be used: {reason}; use another, or the CPU")]
    Refused {
        /// The adapter.
        name: String,
        /// What the driver said.
        reason: String,
    },
    /// Tree and mesh are larger than what the adapter's bindings reach: use a smaller preset, or the CPU.
    #[error(
        "tree and mesh take {needed} bytes, the GPU's bindings reach {limit}; use a smaller preset, or the CPU"
    )]
    TooLarge {
        /// Bytes.
        needed: u64,
        /// Bytes.
        limit: u64,
    },
    /// No kernel reads wide nodes yet: build the tree in another layout, or trace on the CPU.
    #[error(
        "GPUs do not trace wide trees yet; build it with the layout dense (--layout dense), or use the CPU"
    )]
    Wide,
    /// The GPU's memory is full: use a smaller preset, or the CPU.
    #[error(
        "the GPU has too little memory ({needed} bytes were asked for); use a smaller preset, or the CPU"
    )]
    OutOfMemory {
        /// Bytes that were asked for.
        needed: u64,
    },
    /// The device went away: its driver was reset, or a kernel ran longer than the system allows.
    #[error("the GPU was lost: {0}; try again, or use the CPU")]
    Lost(String),
    /// The driver did not take a kernel: use another adapter, or the CPU.
    #[error("the GPU's driver refused the kernel: {0}; use another adapter, or the CPU")]
    Kernel(String),
}
