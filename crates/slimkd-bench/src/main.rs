//! The `slimkd-bench` command.

use anyhow::{Context, Result};
use clap::Parser;
use slimkd_lab::bench::{args::Args, report, run};
use slimkd_util::alloc::Counting;
use std::io::{ErrorKind, Write as _};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn main() -> ExitCode {
    match work(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("slimkd-bench: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn work(args: &Args) -> Result<()> {
    let report = run::run(args, &mut |what| eprintln!("{what}"))?;
    // The table first: should the file fail, the figures of a long run are not lost.
    let printed = std::io::stdout().write_all(report::table(&report).as_bytes());
    if let Some(path) = &args.json {
        let text = serde_json::to_string_pretty(&report)?;
        slimkd_util::whole_file::write(path, text.as_bytes())
            .with_context(|| format!("{} cannot be written", path.display()))?;
        eprintln!("all figures are in {}", path.display());
    }
    match printed {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
