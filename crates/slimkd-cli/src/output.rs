//! Files that appear whole or not at all: written beside their target, brought to the disk, renamed over it.

use crate::failure::Failure;
use crate::interrupt::{self, Interruptible};
use crate::ui::{Ui, grouped};
use slimkd_scene::Scene;
use slimkd_util::whole_file;
use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A place that was found to be writable before the work began.
#[derive(Debug)]
pub(crate) struct Output {
    /// Symbolic links resolved, so that a rename replaces the file and not the link.
    target: PathBuf,
    /// False for devices and pipes, which are written to in place: a rename would replace the device.
    replaceable: bool,
}

type Stream<T> = BufWriter<Interruptible<T>>;

/// An [`Output`] being written.
pub(crate) enum Draft {
    /// To be renamed.
    Beside(Stream<NamedTempFile>, PathBuf),
    /// A device or a pipe.
    InPlace(Stream<File>, PathBuf),
}

impl Output {
    /// Checks that `path` can be written, so that a long computation does not end in "permission denied".
    pub(crate) fn prepare(path: &Path) -> Result<Self, Failure> {
        if path == Path::new("-") {
            let what =
                "is no name for standard output; name /dev/stdout, or ./- for a file that is called so";
            return Err(Failure::Usage(format!("- {what}")));
        }
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let kind = fs::metadata(&target).ok().map(|metadata| metadata.file_type());
        if kind.is_some_and(|kind| kind.is_dir()) || path.file_name().is_none() {
            return Err(Failure::at(path, "cannot write: this is a directory; name a file in it"));
        }
        let output = Self { target, replaceable: kind.is_none_or(|kind| kind.is_file()) };
        if output.replaceable {
            drop(output.beside()?);
        }
        Ok(output)
    }

    /// Refuses to write over what is read. Devices and pipes keep what they hold.
    pub(crate) fn apart_from<'a>(self, inputs: impl IntoIterator<Item = &'a Path>) -> Result<Self, Failure> {
        match inputs.into_iter().find(|input| self.replaceable && is_same(&self.target, input)) {
            Some(input) => Err(overwritten(&self.target, input)),
            None => Ok(self),
        }
    }

    /// The file's name as it will be.
    pub(crate) fn path(&self) -> &Path {
        &self.target
    }

    /// Opens it for writing; nothing shows at the target before [`Draft::commit`].
    pub(crate) fn draft(&self) -> Result<Draft, Failure> {
        let path = self.target.clone();
        if self.replaceable {
            return Ok(Draft::Beside(BufWriter::new(Interruptible(self.beside()?)), path));
        }
        let file = OpenOptions::new().write(true).open(&path).map_err(|error| unwritable(&path, &error))?;
        Ok(Draft::InPlace(BufWriter::new(Interruptible(file)), path))
    }

    /// Writes a scene as PLY and says so; `path` is the name that the user gave.
    pub(crate) fn write_ply(&self, scene: &Scene, path: &Path, ui: Ui) -> Result<(), Failure> {
        let mut draft = self.draft()?;
        let warnings = scene.write_ply(&mut draft).map_err(|error| unwritable(path, &error))?;
        ui.warn_of(&path.display().to_string(), &warnings)?;
        draft.commit()?;
        let mesh = &scene.mesh;
        let (triangles, vertices) = (grouped(mesh.len() as u64), grouped(mesh.vertices().len() as u64));
        ui.note(format_args!("wrote {}: {triangles} triangles, {vertices} vertices", path.display()));
        Ok(())
    }

    fn beside(&self) -> Result<NamedTempFile, Failure> {
        whole_file::beside(&self.target).map_err(|error| unwritable(&self.target, &error))
    }
}

impl Draft {
    /// Makes the file appear under its name, unless Ctrl-C was pressed.
    pub(crate) fn commit(self) -> Result<(), Failure> {
        match self {
            Self::Beside(writer, path) => {
                let file = writer.into_inner().map_err(|error| unwritable(&path, error.error()))?;
                // On the disk before it gets the old file's name: after a power cut there is the old file or this one.
                file.0.as_file().sync_all().map_err(|error| unwritable(&path, &error))?;
                interrupt::check()?;
                whole_file::appear(file.0, &path).map_err(|error| unwritable(&path, &error))
            }
            Self::InPlace(mut writer, path) => writer.flush().map_err(|error| unwritable(&path, &error)),
        }
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match self {
            Self::Beside(writer, _) => writer.write(bytes),
            Self::InPlace(writer, _) => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match self {
            Self::Beside(writer, _) => writer.flush(),
            Self::InPlace(writer, _) => writer.flush(),
        }
    }
}

/// The error for a target that the operating system refuses.
pub(crate) fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    let text = error.to_string();
    // tempfile adds the temporary file's path behind the number; only the cause concerns the user.
    let cause = match text.split_once(" (os error") {
        Some((cause, _)) => cause.to_lowercase(),
        None => text,
    };
    let fix = match error.kind() {
        ErrorKind::NotFound => "make its folder first, or choose another place",
        _ => "choose another place",
    };
    Failure::at(path, format_args!("cannot write: {cause}; {fix}"))
}

/// The error for an output that is an input.
pub(crate) fn overwritten(output: &Path, input: &Path) -> Failure {
    Failure::usage(format_args!(
        "{}: would overwrite the input {}; name another file",
        output.display(),
        input.display()
    ))
}

/// Whether both are there and one file, whatever they are called: by links of both kinds.
pub(crate) fn is_same(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    let identity = |path: &Path| {
        use std::os::unix::fs::MetadataExt;
        fs::metadata(path).map(|metadata| (metadata.dev(), metadata.ino()))
    };
    #[cfg(not(unix))]
    let identity = |path: &Path| fs::canonicalize(path);
    identity(a).is_ok_and(|a| identity(b).is_ok_and(|b| a == b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_draft_that_is_dropped_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let output = Output::prepare(&folder.path().join("a.bin")).unwrap();
        let mut draft = output.draft().unwrap();
        draft.write_all(b"half").unwrap();
        drop(draft);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_commit_replaces_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        fs::write(&path, b"old").unwrap();
        let output = Output::prepare(&path).unwrap();
        let mut draft = output.draft().unwrap();
        draft.write_all(b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        draft.commit().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_a_device_a_device() {
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a.bin"), folder.path().join("link"));
        fs::write(&path, b"old").unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        let mut draft = Output::prepare(&link).unwrap().draft().unwrap();
        draft.write_all(b"new").unwrap();
        draft.commit().unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"new");

        let null = Output::prepare(Path::new("/dev/null")).unwrap();
        assert!(!null.replaceable);
        null.draft().unwrap().commit().unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }

    #[test]
    fn what_cannot_be_written_is_said_before_the_work() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, b"").unwrap();
        for path in [file.join("under"), folder.path().to_owned(), folder.path().join("no/such/folder/a.png")]
        {
            let failure = Output::prepare(&path).unwrap_err();
            assert_eq!(failure.status(), 1, "{failure}");
            assert!(!failure.to_string().contains(".part"), "{failure}");
        }
    }

    #[test]
    fn an_input_is_no_output() {
        let folder = tempfile::tempdir().unwrap();
        let (a, b) = (folder.path().join("a"), folder.path().join("b"));
        fs::write(&a, b"in").unwrap();
        let refused = |output: &Path, input: &Path| {
            Output::prepare(output).unwrap().apart_from([input]).is_err_and(|failure| failure.status() == 2)
        };
        assert!(refused(&a, &a) && refused(&folder.path().join("./a"), &a));
        assert!(!refused(&b, &a) && !refused(&b, &b));
        assert!(!refused(Path::new("/dev/null"), Path::new("/dev/null")));
    }
}
