//! Ctrl-C: a flag that all long work looks at; and the signal of a file-size limit, which nobody should die of.

use crate::failure::Failure;
use std::io::{Read, Write};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Starts to listen. The first Ctrl-C asks the running work to stop, the second ends the process at once.
pub(crate) fn listen() {
    // Without a handler Ctrl-C still ends the process, only less tidily: not worth failing for.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Relaxed) {
            std::process::exit(i32::from(Failure::Interrupted.status()));
        }
    });
    // Ignored like this, a file that reaches `ulimit -f` is an error of the write, which says so.
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default());
}

/// True once Ctrl-C was pressed.
pub(crate) fn pending() -> bool {
    INTERRUPTED.load(Relaxed)
}

/// A reader or writer that fails once Ctrl-C was pressed: it ends library calls that know nothing of it.
pub(crate) struct Interruptible<T>(pub(crate) T);

fn io_check() -> std::io::Result<()> {
    check().map_err(|failure| std::io::Error::other(failure.to_string()))
}

impl<T: Read> Read for Interruptible<T> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        io_check()?;
        self.0.read(buffer)
    }
}

impl<T: Write> Write for Interruptible<T> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        io_check()?;
        self.0.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.flush()
    }
}

/// An error once Ctrl-C was pressed.
pub(crate) fn check() -> Result<(), Failure> {
    if pending() { Err(Failure::Interrupted) } else { Ok(()) }
}
