//! Ctrl-C: a flag that all long work looks at.

use crate::failure::Failure;
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
}

/// True once Ctrl-C was pressed.
pub(crate) fn pending() -> bool {
    INTERRUPTED.load(Relaxed)
}

/// An error once Ctrl-C was pressed.
pub(crate) fn check() -> Result<(), Failure> {
    if pending() { Err(Failure::Interrupted) } else { Ok(()) }
}
