//! Finding and loading the shared library.

use super::abi::{Api, PROPERTY_VERSION};
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Names an Embree 4 that the system's loader should search for.
const SYSTEM_NAMES: &[&str] = &["libembree4.so.4", "libembree4.so", "libembree4.4.dylib", "embree4.dll"];
/// Where `get-embree.sh` puts the library, from the repository's root.
const FETCHED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/embree");
/// Folders below a given one that are searched.
const SEARCH_DEPTH: u32 = 6;

/// Why there is no Embree.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LoadError {
    /// Nothing was found: fetch it or name it.
    #[error(
        "no Embree 4 found; run crates/slimkd-bench/get-embree.sh, or give --embree PATH or SLIMKD_EMBREE"
    )]
    NotFound,
    /// The path that was given holds no Embree 4: name the shared library or a folder above it.
    #[error("no libembree4 at or below {0}; name the shared library or a folder above it")]
    NotThere(PathBuf),
    /// It cannot be loaded: it must be an Embree 4 with its libtbb beside it.
    #[error("{path} cannot be loaded ({source}); it must be an Embree 4 with its libtbb beside it")]
    Load {
        /// Which library.
        path: PathBuf,
        /// What the loader says.
        source: libloading::Error,
    },
    /// Another major version: use Embree 4.
    #[error("{path} is version {version}, not 4; its structures differ, use an Embree 4")]
    Version {
        /// Which library.
        path: PathBuf,
        /// What it says it is.
        version: isize,
    },
}

/// A loaded Embree 4.
pub struct Library {
    pub(super) api: Api,
    /// Such as "4.4.0".
    pub(super) version: String,
    /// Keeps the entry points valid. Never unloaded: the threads of Embree's scheduler outlive its devices, and their
    /// code would be gone (a crash at the end of every other run).
    _library: ManuallyDrop<libloading::Library>,
}

impl Library {
    /// Loads the one at `given`, a file or a folder above it. Without it: what `SLIMKD_EMBREE` names, then what
    /// `get-embree.sh` fetched, then the system's.
    pub fn find(given: Option<&Path>) -> Result<Self, LoadError> {
        let variable = std::env::var_os("SLIMKD_EMBREE").map(PathBuf::from);
        if let Some(path) = given.map(Path::to_path_buf).or(variable) {
            let file = search(&path, SEARCH_DEPTH).ok_or_else(|| LoadError::NotThere(path.clone()))?;
            return Self::load(&file);
        }
        if let Some(file) = search(Path::new(FETCHED), SEARCH_DEPTH) {
            return Self::load(&file);
        }
        for name in SYSTEM_NAMES {
            match Self::load(Path::new(name)) {
                Err(LoadError::Load { .. }) => {}
                other => return other,
            }
        }
        Err(LoadError::NotFound)
    }

    fn load(path: &Path) -> Result<Self, LoadError> {
        let error = |source| LoadError::Load { path: path.to_path_buf(), source };
        // SAFETY: runs the library's initialisers; the user names it or has fetched it, as any dependency.
        let library = unsafe { libloading::Library::new(path) }.map_err(error)?;
        // SAFETY: only Embree exports all of these names; the table is stored beside the library. That it is version 4
        // is checked below, before any call that passes a structure.
        let api = unsafe { Api::new(&library) }.map_err(error)?;
        // SAFETY: creating, asking and releasing a device takes pointers to nothing.
        let number = unsafe {
            let device = (api.new_device)(std::ptr::null());
            let number = if device.is_null() { 0 } else { (api.device_property)(device, PROPERTY_VERSION) };
            (api.release_device)(device);
            number
        };
        if number / 10_000 != 4 {
            return Err(LoadError::Version { path: path.to_path_buf(), version: number });
        }
        let version = format!("{}.{}.{}", number / 10_000, number / 100 % 100, number % 100);
        Ok(Self { api, version, _library: ManuallyDrop::new(library) })
    }
}

/// The first `libembree4*` at or below `path`, folders in the order of their names.
fn search(path: &Path, depth: u32) -> Option<PathBuf> {
    if path.is_file() {
        return Some(path.to_path_buf());
    }
    if depth == 0 {
        return None;
    }
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(path).ok()?.filter_map(|e| Some(e.ok()?.path())).collect();
    entries.sort();
    let is_embree = |file: &&PathBuf| {
        let name = file.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        name.starts_with("libembree4") && (name.contains(".so") || name.ends_with(".dylib"))
    };
    entries
        .iter()
        .find(|entry| entry.is_file() && is_embree(entry))
        .cloned()
        .or_else(|| entries.iter().filter(|entry| entry.is_dir()).find_map(|entry| search(entry, depth - 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absent_or_wrong_is_an_error_that_says_what_to_do() {
        let folder = tempfile::tempdir().unwrap();
        let missing = Library::find(Some(&folder.path().join("none"))).err().unwrap();
        assert!(matches!(missing, LoadError::NotThere(_)), "{missing}");
        let empty = Library::find(Some(folder.path())).err().unwrap();
        assert!(matches!(empty, LoadError::NotThere(_)), "{empty}");
        let fake = folder.path().join("deeper");
        std::fs::create_dir(&fake).unwrap();
        std::fs::write(fake.join("libembree4.so.4"), b"not a library").unwrap();
        let broken = Library::find(Some(folder.path())).err().unwrap();
        assert!(matches!(broken, LoadError::Load { .. }), "{broken}");
        assert!(!broken.to_string().contains('\n'));
    }
}
