//! Files that are there whole or not at all: written beside their target, brought to the disk, renamed over it.

use super::FileError;
use crate::geometry::TriangleMesh;
use crate::tree::KdTree;
use std::fs::{self, File, OpenOptions};
use std::io::{BufReader, BufWriter, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Bytes gathered before they are handed to the operating system.
const BUFFER: usize = 1 << 20;

impl KdTree {
    /// Saves the tree and its mesh. Whatever happens meanwhile, `path` holds the old file or the new one.
    ///
    /// # Errors
    /// [`FileError::At`] with the path: the old file is as it was.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), FileError> {
        let path = path.as_ref();
        replace(path, |file| self.write(file)).map_err(|error| error.at(path))
    }

    /// Saves the tree without its mesh; [`KdTree::load_with_mesh`] reads it. Whatever happens meanwhile, `path` holds the old file or the
    /// new one.
    ///
    /// # Errors
    /// [`FileError::At`] with the path: the old file is as it was.
    pub fn save_without_mesh(&self, path: impl AsRef<Path>) -> Result<(), FileError> {
        let path = path.as_ref();
        replace(path, |file| self.write_without_mesh(file)).map_err(|error| error.at(path))
    }

    /// Reads and proves a tree that was saved with its mesh.
    ///
    /// # Errors
    /// [`FileError::At`] with the path, around an error of [`KdTree::read`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        open(path).and_then(Self::read).map_err(|error| error.at(path))
    }

    /// Reads and proves a saved tree over a mesh that the caller has, whether or not the file holds it too.
    ///
    /// # Errors
    /// [`FileError::At`] with the path, around an error of [`KdTree::read_with_mesh`].
    pub fn load_with_mesh(
        path: impl AsRef<Path>,
        mesh: impl Into<Arc<TriangleMesh>>,
    ) -> Result<Self, FileError> {
        let path = path.as_ref();
        open(path).and_then(|file| Self::read_with_mesh(file, mesh)).map_err(|error| error.at(path))
    }
}

fn open(path: &Path) -> Result<BufReader<File>, FileError> {
    Ok(BufReader::with_capacity(BUFFER, File::open(path)?))
}

/// A file that is removed unless it was renamed.
struct Draft(PathBuf);

impl Drop for Draft {
    fn drop(&mut self) {
        // An error means that the file was renamed, or that it cannot be removed: nothing is left to do either way.
        let _ = fs::remove_file(&self.0);
    }
}

fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), FileError>,
) -> Result<(), FileError> {
    // A rename must replace the file, not the link to it.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let (file, draft) = create_beside(&target)?;
    let mut writer = BufWriter::with_capacity(BUFFER, file);
    write(&mut writer)?;
    let file = writer.into_inner().map_err(std::io::IntoInnerError::into_error)?;
    file.sync_all()?;
    fs::rename(&draft.0, &target)?;
    sync_folder(&target);
    Ok(())
}

fn create_beside(target: &Path) -> std::io::Result<(File, Draft)> {
    let name = target.file_name().ok_or(ErrorKind::InvalidFilename)?.to_string_lossy();
    for attempt in 0.. {
        let path = target.with_file_name(format!(".{name}-{}-{attempt}.part", std::process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => return Ok((file, Draft(path))),
            Err(error) if error.kind() == ErrorKind::AlreadyExists && attempt < 1000 => {}
            Err(error) => return Err(error),
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}

/// Brings the rename itself to the disk, where folders can be opened for that.
fn sync_folder(target: &Path) {
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // The new file is in place either way: a file system that cannot do this loses at most the rename.
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}
