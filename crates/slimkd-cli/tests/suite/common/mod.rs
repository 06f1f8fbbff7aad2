//! Running the tool, and small scenes for it.
#![allow(dead_code, unreachable_pub)] // each test file uses its share

mod keys;

pub use keys::{keys, set};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What a run left behind.
#[derive(Debug)]
pub struct Run {
    pub status: i32,
    pub stdout: String,
    pub stderr: String,
}

/// The tool, in a folder of its own.
pub struct Tool {
    folder: tempfile::TempDir,
}

impl Tool {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file into the folder.
    pub fn file(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        std::fs::write(self.path(name), bytes).unwrap();
        self.path(name)
    }

    /// Names of all files in the folder.
    pub fn files(&self) -> BTreeSet<String> {
        let names = std::fs::read_dir(self.folder.path()).unwrap();
        names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    /// The tool with a command line whose words are split at spaces.
    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_slimkd"));
        command.args(line.split_whitespace()).current_dir(self.folder.path()).stdin(Stdio::null());
        command
    }

    pub fn run(&self, line: &str) -> Run {
        let output = self.command(line).output().unwrap();
        Run {
            status: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Runs what must succeed.
    pub fn ok(&self, line: &str) -> Run {
        let run = self.run(line);
        assert_eq!(run.status, 0, "{line}: {}", run.stderr);
        run
    }

    /// Runs what must print one JSON object and nothing else.
    pub fn json(&self, line: &str) -> serde_json::Value {
        let run = self.ok(line);
        serde_json::from_str(&run.stdout).unwrap_or_else(|error| panic!("{line}: {error}: {}", run.stdout))
    }

    /// Runs what must fail with `status` and one line that holds all of `words`.
    pub fn fails(&self, line: &str, status: i32, words: &[&str]) -> Run {
        let run = self.run(line);
        assert_eq!(run.status, status, "{line}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{line}");
        if !line.is_empty() {
            assert_eq!(run.stderr.lines().count(), 1, "{line}: {}", run.stderr);
            assert!(run.stderr.starts_with("slimkd: error: "), "{line}: {}", run.stderr);
        }
        for word in words {
            assert!(run.stderr.contains(word), "{line}: no {word:?} in {}", run.stderr);
        }
        run
    }
}

/// A text PLY.
pub fn ply(vertices: &[&str], faces: &[&str]) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n{}\n{}\n",
        vertices.len(),
        faces.len(),
        vertices.join("\n"),
        faces.join("\n")
    )
}

/// A square of two triangles at z = 0, from (0, 0) to (1, 1).
pub fn square() -> String {
    ply(&["0 0 0", "1 0 0", "1 1 0", "0 1 0"], &["3 0 1 2", "3 0 2 3"])
}

/// Writes rays as the tool reads them.
pub fn ray_file(path: &Path, rays: &[slimkd::Ray]) {
    let floats = rays.iter().flat_map(|ray| {
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
        [ox, oy, oz, ray.t_min, dx, dy, dz, ray.t_max]
    });
    std::fs::write(path, floats.flat_map(f32::to_le_bytes).collect::<Vec<_>>()).unwrap();
}

/// What a running process has done.
#[cfg(unix)]
#[derive(Debug)]
pub struct State {
    /// Whether it listens to Ctrl-C.
    pub listens: bool,
    /// Processor time of all its threads, ticks of usually 10 ms.
    pub ticks: u64,
}

/// Waits until a child has got somewhere or has ended; `None` where there is no /proc to see that.
#[cfg(unix)]
pub fn until(child: &std::process::Child, there: impl Fn(&State) -> bool) -> Option<()> {
    const SIGINT: u64 = 1 << (2 - 1);
    let folder = PathBuf::from(format!("/proc/{}", child.id()));
    loop {
        let status = std::fs::read_to_string(folder.join("status")).ok()?;
        let signals = status.lines().find_map(|line| line.strip_prefix("SigCgt:"))?;
        let stat = std::fs::read_to_string(folder.join("stat")).ok()?;
        // The name before it may hold spaces.
        let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
        let state = State {
            listens: u64::from_str_radix(signals.trim(), 16).ok()? & SIGINT != 0,
            ticks: fields.get(11)?.parse::<u64>().ok()? + fields.get(12)?.parse::<u64>().ok()?,
        };
        if fields[0] == "Z" || there(&state) {
            return Some(());
        }
        std::thread::yield_now();
    }
}
