//! The `slimkd-frontier` command: pictures of size against speed from `slimkd-bench --json` files.

use anyhow::{Context, Result};
use clap::Parser;
use slimkd_lab::report::{output, plots::frontier};
use std::path::PathBuf;
use std::process::ExitCode;

/// Draws size against speed, one panel a file of `slimkd-bench --json`.
#[derive(Debug, Parser)]
#[command(name = "slimkd-frontier", version)]
struct Args {
    /// Files that slimkd-bench wrote
    #[arg(required = true)]
    reports: Vec<PathBuf>,
    /// The picture, SVG
    #[arg(short, long)]
    output: PathBuf,
    /// Which rays
    #[arg(long, default_value = "bounce")]
    workload: String,
    /// How rays are handed over: single, packet, stream, or best for the fastest of each
    #[arg(long, default_value = "single")]
    interface: String,
    /// Bytes that must stay in memory, mesh included, instead of what the structure adds
    #[arg(long)]
    resident: bool,
}

fn main() -> ExitCode {
    match work(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("slimkd-frontier: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn work(args: &Args) -> Result<()> {
    let mut panels = Vec::new();
    for path in &args.reports {
        let peers = output::read_peers(path)?;
        panels.push(frontier::Panel::new(&peers, &args.workload, &args.interface, args.resident));
    }
    let size =
        if args.resident { "bytes a triangle, mesh included" } else { "bytes a triangle beside the mesh" };
    let svg = frontier::frontier(&panels, &format!("{} rays, million a second", args.workload), size);
    slimkd_util::whole_file::write(&args.output, svg.as_bytes())
        .with_context(|| format!("{} cannot be written", args.output.display()))
}
