//! How a command may end, and the exit status of each ending.

use std::fmt;

/// Why a command did not finish. Every message is one line: what, where, and how to fix it.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The work failed: exit 1.
    Work(String),
    /// The command line contradicts itself in a way that the parser cannot see: exit 2.
    Usage(String),
    /// Ctrl-C: exit 130, nothing is left half-written.
    Interrupted,
    /// Whoever read our output has seen enough, as `head` does: exit 0.
    BrokenPipe,
}

impl Failure {
    /// The process's exit status.
    pub(crate) fn status(&self) -> u8 {
        match self {
            Self::Work(_) => 1,
            Self::Usage(_) => 2,
            Self::Interrupted => 130,
            Self::BrokenPipe => 0,
        }
    }

    /// A failure of the work in one line; errors that quote their input may hold line breaks.
    pub(crate) fn work(what: impl fmt::Display) -> Self {
        Self::Work(one_line(&what.to_string()))
    }

    /// Wrong usage in one line.
    pub(crate) fn usage(what: impl fmt::Display) -> Self {
        Self::Usage(one_line(&what.to_string()))
    }

    /// A failure of the work on `path`.
    pub(crate) fn at(path: &std::path::Path, what: impl fmt::Display) -> Self {
        Self::work(format_args!("{}: {what}", path.display()))
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Work(what) | Self::Usage(what) => f.write_str(what),
            Self::Interrupted => f.write_str("interrupted"),
            Self::BrokenPipe => f.write_str("broken pipe"),
        }
    }
}
