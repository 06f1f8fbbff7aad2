//! What people see: notes and progress on stderr, results on stdout.

use crate::failure::Failure;
use crate::interrupt;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use slimkd_scene::Warning;
use std::fmt::Display;
use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How long work runs before it gets a bar: shorter work would only flicker.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often the bar and Ctrl-C are looked at: a cancelled build should feel immediate.
const TICK: Duration = Duration::from_millis(50);
/// Steps of a bar: finer than any terminal is wide.
const STEPS: u64 = 100_000;

/// Work that another thread can watch and stop.
pub(crate) trait Watched: Sync {
    /// Share done, 0 to 1.
    fn fraction(&self) -> f64;
    /// Asks the work to end soon.
    fn cancel(&self);
}

impl Watched for slimkd::Progress {
    fn fraction(&self) -> f64 {
        self.fraction()
    }

    fn cancel(&self) {
        self.cancel();
    }
}

impl Watched for slimkd_lab::Progress {
    fn fraction(&self) -> f64 {
        self.fraction()
    }

    fn cancel(&self) {
        self.cancel();
    }
}

/// Where a command talks to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ui {
    quiet: bool,
    strict: bool,
}

impl Ui {
    /// `quiet`: errors only.
    pub(crate) fn new(quiet: bool) -> Self {
        Self { quiet, strict: false }
    }

    /// `strict`: what a scene file is warned of is an error.
    pub(crate) fn strict(self, strict: bool) -> Self {
        Self { strict, ..self }
    }

    /// True when only errors are wanted.
    pub(crate) fn is_quiet(self) -> bool {
        self.quiet
    }

    /// A line of log on stderr.
    pub(crate) fn note(self, what: impl Display) {
        if !self.quiet {
            // A closed stderr is no reason to stop.
            let _ = writeln!(std::io::stderr(), "slimkd: {what}");
        }
    }

    /// Something that the user should know although the work goes on.
    pub(crate) fn warn(self, what: impl Display) {
        self.note(format_args!("warning: {what}"));
    }

    /// Tells what a scene is warned of, one line each; with `--strict` that is an error.
    pub(crate) fn warn_of(self, place: &str, warnings: &[Warning]) -> Result<(), Failure> {
        for warning in warnings {
            self.warn(format_args!("{place}: {warning}"));
        }
        match warnings {
            [first, rest @ ..] if self.strict => {
                let more =
                    if rest.is_empty() { String::new() } else { format!(" (and {} more)", rest.len()) };
                let fix = "mend the file, or leave out --strict";
                Err(Failure::work(format_args!("{place}: {first}{more}; {fix}")))
            }
            _ => Ok(()),
        }
    }

    /// Runs `work` on this thread while another one draws its bar and passes Ctrl-C on to it.
    pub(crate) fn watch<T>(self, label: &str, watched: &dyn Watched, work: impl FnOnce() -> T) -> T {
        let (done, ended) = channel::<()>();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                let started = Instant::now();
                let mut bar = None;
                while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
                    if interrupt::pending() {
                        watched.cancel();
                    }
                    if started.elapsed() >= PATIENCE {
                        let bar = bar.get_or_insert_with(|| self.bar(label));
                        let fraction = watched.fraction().clamp(0.0, 1.0);
                        bar.set_prefix(time_left(started.elapsed(), fraction));
                        bar.set_position((fraction * STEPS as f64) as u64);
                    }
                }
                if let Some(bar) = bar {
                    bar.finish_and_clear();
                }
            });
            // Dropped on the way out, by a panic too, which is what ends the watcher.
            let _done = done;
            work()
        })
    }

    fn bar(self, label: &str) -> ProgressBar {
        let draws = !self.quiet && std::io::stderr().is_terminal();
        let target = if draws { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let style = ProgressStyle::with_template("{msg:10} [{wide_bar}] {percent:>3} %{prefix}")
            .unwrap_or_else(|_| ProgressStyle::default_bar())
            .progress_chars("=> ");
        ProgressBar::with_draw_target(Some(STEPS), target).with_style(style).with_message(label.to_owned())
    }
}

/// What is left if all goes on as it did on average; nothing while there is nothing to go by.
fn time_left(elapsed: Duration, fraction: f64) -> String {
    let left = elapsed.as_secs_f64() * (1.0 - fraction) / fraction;
    match Duration::try_from_secs_f64(left.ceil()) {
        Ok(left) => format!("  {:#} left", HumanDuration(left)),
        Err(_) => String::new(),
    }
}

/// Writes a result to stdout.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(|error| match error.kind() {
        ErrorKind::BrokenPipe => Failure::BrokenPipe,
        _ => Failure::work(format_args!("stdout: {error}")),
    })
}

/// Writes one JSON object to stdout.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_string_pretty(value).map_err(Failure::work)?;
    text.push('\n');
    print(&text)
}

/// `1234567` as `1,234,567`.
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut out = String::with_capacity(digits.len() * 4 / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// Bytes in the largest binary unit that leaves at least 1.
pub(crate) fn bytes(count: u64) -> String {
    match count {
        0..1024 => format!("{count} B"),
        1024..1_048_576 => format!("{:.1} KiB", count as f64 / 1024.0),
        1_048_576..1_073_741_824 => format!("{:.2} MiB", count as f64 / 1_048_576.0),
        _ => format!("{:.2} GiB", count as f64 / 1_073_741_824.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_are_grouped() {
        for (number, text) in [(0, "0"), (999, "999"), (1000, "1,000"), (12_345_678, "12,345,678")] {
            assert_eq!(grouped(number), text);
        }
    }

    #[test]
    fn time_left_follows_the_average() {
        let ten = Duration::from_secs(10);
        assert_eq!(time_left(ten, 0.25), "  30s left");
        assert_eq!(time_left(ten, 1.0), "  0s left");
        assert_eq!(time_left(ten, 0.0), "");
    }

    #[test]
    fn units_change_at_powers_of_1024() {
        for (count, text) in
            [(1023, "1023 B"), (1024, "1.0 KiB"), (3 << 20, "3.00 MiB"), (5 << 30, "5.00 GiB")]
        {
            assert_eq!(bytes(count), text);
        }
    }
}
