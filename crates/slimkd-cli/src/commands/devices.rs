//! `slimkd devices`: what there is to trace on.

use crate::failure::Failure;
use crate::ui;
use clap::Args;

/// Arguments of `slimkd devices`.
#[derive(Debug, Args)]
pub(crate) struct DevicesArgs {}

/// Lists the CPU, then the adapters, the one that `--device gpu` takes first.
pub(crate) fn run(_: &DevicesArgs) -> Result<(), Failure> {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    ui::print(&format!("cpu  {threads} threads, {}\n{}", slimkd::InstructionSet::best().name(), adapters()))
}

#[cfg(feature = "gpu")]
fn adapters() -> String {
    use std::fmt::Write;
    let mut text = String::new();
    for adapter in slimkd_gpu::adapters() {
        let slimkd_gpu::Adapter { name, kind, backend, driver, binding_bytes, timestamps } = adapter;
        let mib = binding_bytes >> 20;
        let stamps = if timestamps { ", timestamps" } else { "" };
        let _ = writeln!(text, "gpu  {name}: {kind}, {backend}, {driver}, {mib} MiB a binding{stamps}");
    }
    if text.is_empty() {
        text.push_str(
            "no GPU that can run compute shaders was found; its Vulkan, Metal or D3D12 driver is needed\n",
        );
    }
    text
}

#[cfg(not(feature = "gpu"))]
fn adapters() -> String {
    "this slimkd was built without its feature gpu\n".to_owned()
}
