//! Bytes of files: read whole, decompressed under a cap, and the files that a scene names beside its own.

use super::{LoadError, Loading, Progress, progress::READ_SHARE};
use std::{
    ffi::OsStr,
    fs::File,
    io::{self, Read},
    path::{Component, Path, PathBuf},
};

/// How a file is compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Compression {
    /// Not at all.
    None,
    /// Zstandard, `.zst`.
    Zstd,
    /// Gzip, `.gz`.
    Gzip,
}

/// Largest growth from a file to what it holds. Binary scenes shrink by 2 to 10, text by up to 30, wholly regular
/// grids by some 200; a bomb of zeros reaches 1,030 (gzip) to 30,000 (zstd).
pub(super) const MAX_GROWTH: u64 = 256;
/// Content below this size is never out of proportion, bytes.
pub(super) const FREE_BYTES: u64 = 64 << 20;
/// Largest zstd window that is accepted, log2 of bytes: what `zstd --long` and `--ultra -22` write.
const ZSTD_WINDOW_LOG: u32 = 27;
/// Bytes read between two looks at the progress.
const BLOCK: u64 = 4 << 20;

/// How many bytes may come out of `input` bytes.
pub(super) fn growth_limit(input: u64) -> u64 {
    input.saturating_mul(MAX_GROWTH).saturating_add(FREE_BYTES)
}

/// Opens a regular file; the length comes with it. Pipes and devices could block or never end.
fn open(path: &Path) -> Result<(File, u64), LoadError> {
    let failed = |source| LoadError::Read { path: path.to_owned(), source };
    // Looked at before opening, since opening a pipe waits for a writer.
    if !std::fs::metadata(path).map_err(failed)?.is_file() {
        return Err(LoadError::NotAFile { path: path.to_owned() });
    }
    let file = File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?.len();
    Ok((file, length))
}

/// The whole content of a file, decompressed.
pub(super) fn read(path: &Path, compression: Compression, progress: &Progress) -> Result<Vec<u8>, LoadError> {
    let (mut file, length) = open(path)?;
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(length as usize)
        .map_err(|_| LoadError::Read { path: path.to_owned(), source: io::ErrorKind::OutOfMemory.into() })?;
    let share = if compression == Compression::None { READ_SHARE } else { 0.1 * READ_SHARE };
    loop {
        let got = (&mut file)
            .take(BLOCK)
            .read_to_end(&mut bytes)
            .map_err(|source| LoadError::Read { path: path.to_owned(), source })?;
        progress.reach(share * bytes.len() as f64 / length.max(1) as f64)?;
        if got == 0 {
            break;
        }
    }
    match compression {
        Compression::None => Ok(bytes),
        _ => decompress(compression, &bytes, progress),
    }
}

/// What `bytes` decompress to; refused when it grows beyond [`growth_limit`].
pub(super) fn decompress(
    compression: Compression,
    bytes: &[u8],
    progress: &Progress,
) -> Result<Vec<u8>, LoadError> {
    if bytes.is_empty() {
        return Err(LoadError::Empty);
    }
    let limit = growth_limit(bytes.len() as u64);
    match compression {
        Compression::None => Ok(bytes.to_vec()),
        Compression::Gzip => {
            // A gzip member ends with its length modulo 2³²; only a hint, for members may follow one another.
            let hint = bytes.last_chunk().map_or(0, |&last| u64::from(u32::from_le_bytes(last)));
            let decoder = |input| Ok(flate2::bufread::MultiGzDecoder::new(input));
            inflate("gz", bytes, decoder, hint, limit, progress)
        }
        Compression::Zstd => {
            let hint = zstd::zstd_safe::get_frame_content_size(bytes).ok().flatten().unwrap_or(0);
            let decoder = |input| {
                let mut decoder = zstd::stream::read::Decoder::with_buffer(input)?;
                decoder.window_log_max(ZSTD_WINDOW_LOG)?;
                Ok(decoder)
            };
            inflate("zst", bytes, decoder, hint, limit, progress)
        }
    }
}

/// The input of a decoder, which counts what was taken from it.
struct Counted<'a> {
    rest: &'a [u8],
    progress: &'a Progress,
    total: usize,
}

impl Read for Counted<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.rest.read(buffer)
    }
}

impl io::BufRead for Counted<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        Ok(self.rest)
    }
    fn consume(&mut self, amount: usize) {
        self.rest = &self.rest[amount..];
        let done = (self.total - self.rest.len()) as f64 / self.total as f64;
        self.progress.set(READ_SHARE * (0.1 + 0.9 * done));
    }
}

fn inflate<'a, R: Read>(
    compression: &'static str,
    bytes: &'a [u8],
    decoder: impl FnOnce(Counted<'a>) -> io::Result<R>,
    hint: u64,
    limit: u64,
    progress: &'a Progress,
) -> Result<Vec<u8>, LoadError> {
    let bomb = || LoadError::OutOfProportion {
        what: "the decompressed content",
        limit,
        input: bytes.len() as u64,
        fix: "decompress it beforehand",
    };
    let damaged = |decoded: usize, reason: &dyn std::fmt::Display| LoadError::Decompress {
        compression,
        decoded: decoded as u64,
        reason: reason.to_string(),
    };
    let mut decoder =
        decoder(Counted { rest: bytes, progress, total: bytes.len() }).map_err(|e| damaged(0, &e))?;
    let mut out = Vec::new();
    // A header may lie about the size: beyond this it is believed only as the bytes come.
    let believed = hint.min(limit).min(FREE_BYTES.max(16 * bytes.len() as u64));
    out.try_reserve_exact(believed as usize).map_err(|e| damaged(0, &e))?;
    loop {
        progress.reach(0.0)?;
        let before = out.len();
        (&mut decoder).take(BLOCK).read_to_end(&mut out).map_err(|e| damaged(before, &e))?;
        if out.len() as u64 > limit {
            return Err(bomb());
        }
        if out.len() == before {
            return Ok(out);
        }
    }
}

/// Where the files lie that a scene names: beside its own, or nowhere when it came from memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Folder<'a> {
    pub(super) path: Option<&'a Path>,
    /// False: only what lies in the folder, or in one below it, is read.
    pub(super) allow_outside: bool,
}

impl Folder<'_> {
    /// Of a scene from memory: it has no files beside it.
    pub(super) const NONE: Self = Self { path: None, allow_outside: false };

    /// Reads the file of that relative name. The error says why not, without the name.
    pub(super) fn read(self, name: &str) -> Result<Vec<u8>, String> {
        let (mut file, length) = open(&self.path(name)?).map_err(|error| match error {
            LoadError::Read { source, .. } => source.to_string(),
            _ => "not a regular file".to_owned(),
        })?;
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(length as usize).map_err(|e| e.to_string())?;
        file.read_to_end(&mut bytes).map_err(|e| e.to_string())?;
        Ok(bytes)
    }

    /// True when the named file is there.
    pub(super) fn has(self, name: &str) -> bool {
        self.path(name).is_ok_and(|path| path.is_file())
    }

    fn path(self, name: &str) -> Result<PathBuf, String> {
        let folder = self.path.ok_or("a scene from memory has no files beside it")?;
        // Files from Windows name folders by backslashes; Windows takes slashes as well.
        let name = name.replace('\\', "/");
        let path = folder.join(&name);
        if !self.allow_outside && (leaves(Path::new(&name)) || is_outside(folder, &path)) {
            return Err("it lies outside the scene file's folder; allow that by --allow-outside".to_owned());
        }
        Ok(path)
    }
}

/// True for a name that leaves its folder by its words alone.
fn leaves(name: &Path) -> bool {
    let mut depth = 0;
    name.components().any(|component| {
        depth += match component {
            Component::Normal(_) => 1,
            Component::CurDir => 0,
            Component::ParentDir => -1,
            Component::Prefix(_) | Component::RootDir => return true,
        };
        depth < 0
    })
}

/// True for a file that is there, but not below `folder` once links are followed.
fn is_outside(folder: &Path, path: &Path) -> bool {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match (std::fs::canonicalize(folder), std::fs::canonicalize(path)) {
        (Ok(folder), Ok(path)) => !path.starts_with(folder),
        _ => false,
    }
}

/// The ending of a file's name, in lower case.
pub(super) fn extension(path: &Path) -> Option<String> {
    path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase)
}
