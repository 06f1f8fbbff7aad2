//! The `slimkd-bench` command.

use anyhow::{Context, Result};
use clap::Parser;
use slimkd_bench::{alloc::Counting, args::Args, report, run};
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
    if let Some(path) = &args.json {
        let text = serde_json::to_string_pretty(&report)?;
        std::fs::write(path, text).with_context(|| format!("{} cannot be written", path.display()))?;
    }
    print!("{}", report::table(&report));
    Ok(())
}
