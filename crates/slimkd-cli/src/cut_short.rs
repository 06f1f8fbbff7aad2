//! The signal of a mapped file that another program cuts short: reading what is gone would end the process without a word.

use std::path::Path;

/// Makes that signal one line that names the file, and status 1.
#[cfg(unix)]
pub(crate) fn listen(path: &Path) {
    use std::fs::File;
    use std::io::Write;
    use std::mem::ManuallyDrop;
    use std::os::fd::FromRawFd;
    use std::sync::OnceLock;

    static LINE: OnceLock<String> = OnceLock::new();
    LINE.get_or_init(|| {
        let what = "was cut short while it was traced; leave it alone meanwhile, or leave out --no-verify";
        format!("slimkd: error: {}: {what}\n", path.display())
    });
    let end = || {
        // SAFETY: standard error stays open for the life of the process, and is not closed here.
        let mut stderr = ManuallyDrop::new(unsafe { File::from_raw_fd(2) });
        // If nobody reads the line, there is nobody to tell.
        let _ = stderr.write_all(LINE.get().map_or(&b""[..], |line| line.as_bytes()));
        signal_hook::low_level::exit(1);
    };
    // SAFETY: the handler reads what was written before it was registered, writes to a file without locks or memory of its own, and ends
    // the process.
    let registered = unsafe { signal_hook::low_level::register(signal_hook::consts::SIGBUS, end) };
    // Without the handler the process ends all the same, only less politely.
    drop(registered);
}

/// Other systems do not let mapped files be cut short.
#[cfg(not(unix))]
pub(crate) fn listen(_: &Path) {}
