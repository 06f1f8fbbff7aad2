//! The slimkd command: build, inspect, render, trace and measure small kd-trees.
//!
//! Results go to stdout, everything else to stderr. Exit status: 0 done, 1 the work failed, 2 wrong usage, 130
//! interrupted; a broken pipe is 0.

mod args;
mod cameras;
mod commands;
mod cut_short;
mod device;
mod failure;
mod interrupt;
mod output;
mod rays;
mod report;
mod saved;
mod scenes;
mod trees;
mod ui;

use args::{Cli, Command};
use clap::Parser;
use clap::error::ErrorKind;
use failure::Failure;
use std::io::Write;

/// Counts what builds allocate; it costs one relaxed load a call at any other time.
#[global_allocator]
static ALLOCATOR: slimkd_util::alloc::Counting = slimkd_util::alloc::Counting;
use std::process::ExitCode;
use ui::Ui;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return explain(&error),
    };
    device::quieten();
    interrupt::listen();
    let Err(mut failure) = run(&cli) else { return ExitCode::SUCCESS };
    if interrupt::pending() {
        // Whatever a cancelled library call said, this is the reason.
        failure = Failure::Interrupted;
    }
    end(&failure)
}

/// Says why, and ends.
fn end(failure: &Failure) -> ExitCode {
    if !matches!(failure, Failure::BrokenPipe) {
        let _ = writeln!(std::io::stderr(), "slimkd: error: {failure}");
    }
    ExitCode::from(failure.status())
}

/// Prints the help that was asked for, or one line on what is wrong with the command line.
fn explain(error: &clap::Error) -> ExitCode {
    let nothing_given = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    if nothing_given || !error.use_stderr() {
        // Help that nobody reads is no failure.
        let _ = error.print();
        return ExitCode::from(error.exit_code() as u8);
    }
    let text = error.to_string();
    // The first paragraphs say what is wrong and what would be right; the usage line would only bury them.
    let lines = text.lines().take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    let mut what = String::new();
    for line in lines.map(str::trim).filter(|line| !line.is_empty()) {
        let (between, line) = match line.strip_prefix("tip: ") {
            Some(tip) => ("; ", tip),
            None => (" ", line.strip_prefix("error: ").unwrap_or(line)),
        };
        what.push_str(if what.is_empty() { "" } else { between });
        what.push_str(line);
    }
    end(&Failure::Usage(format!("{what}; see --help")))
}

fn run(cli: &Cli) -> Result<(), Failure> {
    let ui = Ui::new(cli.quiet).strict(cli.strict);
    match &cli.command {
        Command::Render(args) => commands::render::run(args, ui),
        Command::Build(args) => commands::build::run(args, ui),
        Command::Inspect(args) => commands::inspect::run(args, ui),
        Command::Trace(args) => commands::trace::run(args, ui),
        Command::Bench(args) => commands::bench::run(args, ui),
        Command::Report(args) => commands::report::run(args, ui),
        Command::Devices(args) => commands::devices::run(args),
        Command::Scene(args) => commands::scene::run(args, ui),
        Command::Convert(args) => commands::convert::run(args, ui),
        Command::Completions(args) => commands::completions::run(args),
    }
}
