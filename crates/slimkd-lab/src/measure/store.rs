//! What was measured before: a file a unit of work, named by what decides its result.

use crate::basics::error::ReportError;
use serde::Serialize;
use serde::de::DeserializeOwned;
use slimkd_util::whole_file;
use std::fs;
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::xxh3_64;

/// Folder of the units, below the report's.
const UNITS: &str = "measured";

/// The report's folder.
pub(crate) struct Store {
    folder: PathBuf,
}

impl Store {
    pub(crate) fn open(folder: &Path) -> Result<Self, ReportError> {
        let units = folder.join(UNITS);
        fs::create_dir_all(&units)
            .map_err(|error| ReportError::file(&units, format_args!("{error}; choose another folder")))?;
        Ok(Self { folder: folder.to_owned() })
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// The result of a unit, if it is there and whole.
    pub(crate) fn get<T: DeserializeOwned>(&self, unit: &str, decides: &str) -> Option<T> {
        serde_json::from_slice(&fs::read(self.path(unit, decides)).ok()?).ok()
    }

    pub(crate) fn has(&self, unit: &str, decides: &str) -> bool {
        self.path(unit, decides).exists()
    }

    pub(crate) fn put(&self, unit: &str, decides: &str, result: &impl Serialize) -> Result<(), ReportError> {
        let path = self.path(unit, decides);
        let text = serde_json::to_vec(result).map_err(|error| ReportError::file(&path, error))?;
        write(&path, &text)
    }

    fn path(&self, unit: &str, decides: &str) -> PathBuf {
        let key = xxh3_64(format!("{} {unit} {decides}", env!("CARGO_PKG_VERSION")).as_bytes());
        let name: String =
            unit.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect();
        self.folder.join(UNITS).join(format!("{name}-{key:016x}.json"))
    }
}

/// Writes a file that is there whole or not at all.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), ReportError> {
    let fail = |error: std::io::Error| ReportError::file(path, format_args!("cannot write: {error}"));
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(fail)?;
    whole_file::write(path, bytes).map_err(fail)
}
