//! Arrays as little-endian bytes, out of and into memory without a second copy.

use super::table::Entry;
use super::{FileError, damaged};
use crate::layout::WideNode;
use crate::layout::plain::Packed;
use std::borrow::Cow;
use std::io::{ErrorKind, Read};
use xxhash_rust::xxh3::Xxh3;

/// Memory is taken in steps of at least that many bytes, and never of more than was read so far: a lying length ends
/// at the file's end instead of memory's.
const STEP: usize = 1 << 22;

/// What arrays hold: words of [`Words::WORD`] bytes, in the machine's order.
pub(super) trait Words: bytemuck::Pod {
    const WORD: usize;

    /// Turns the machine's order into the file's, or back, on machines whose order is the other one.
    fn swap(items: &mut [Self]) {
        bytemuck::cast_slice_mut::<_, u8>(items).chunks_exact_mut(Self::WORD).for_each(<[u8]>::reverse);
    }
}

impl Words for u8 {
    const WORD: usize = 1;
}
impl Words for u16 {
    const WORD: usize = 2;
}
impl Words for u32 {
    const WORD: usize = 4;
}
impl Words for [u32; 3] {
    const WORD: usize = 4;
}
impl Words for [f32; 3] {
    const WORD: usize = 4;
}
impl Words for Packed {
    const WORD: usize = 8;
}

impl Words for WideNode {
    const WORD: usize = 1;

    fn swap(items: &mut [Self]) {
        items.iter_mut().for_each(|node| *node = node.swapped());
    }
}

/// The items as the file has them.
pub(super) fn le_bytes<T: Words>(items: &[T]) -> Cow<'_, [u8]> {
    if cfg!(target_endian = "big") {
        let mut swapped = items.to_vec();
        T::swap(&mut swapped);
        return Cow::Owned(bytemuck::cast_slice(&swapped).to_vec());
    }
    Cow::Borrowed(bytemuck::cast_slice(items))
}

/// A section whose bytes come next.
pub(super) struct Section<'a, R> {
    from: &'a mut R,
    entry: &'a Entry,
    hash: Box<Xxh3>,
}

impl<'a, R: Read> Section<'a, R> {
    /// Goes from `position` to the section's start over zeros; `position` is its end then.
    pub(super) fn start(from: &'a mut R, position: &mut u64, entry: &'a Entry) -> Result<Self, FileError> {
        let mut padding = [0; 64];
        let padding = &mut padding[..(entry.offset - *position) as usize];
        from.read_exact(padding).map_err(truncated)?;
        if padding.iter().any(|&byte| byte != 0) {
            return damaged("there is something between its sections");
        }
        *position = entry.offset + entry.length;
        Ok(Self { from, entry, hash: Box::default() })
    }

    pub(super) fn entry(&self) -> &Entry {
        self.entry
    }

    /// All items, once their checksum is right.
    pub(super) fn read<T: Words>(mut self) -> Result<Vec<T>, FileError> {
        let size = size_of::<T>() as u64;
        if !self.entry.length.is_multiple_of(size) {
            return damaged(format!("section {} ends within an item", self.entry.kind.0));
        }
        let mut left = self.entry.length / size;
        let mut items: Vec<T> = Vec::new();
        while left > 0 {
            let start = items.len();
            let step = left.min(start.max(STEP / size_of::<T>()) as u64) as usize;
            items.try_reserve_exact(step).map_err(|_| std::io::Error::from(ErrorKind::OutOfMemory))?;
            items.resize(start + step, T::zeroed());
            let bytes = bytemuck::cast_slice_mut(&mut items[start..]);
            self.from.read_exact(bytes).map_err(truncated)?;
            self.hash.update(bytes);
            if cfg!(target_endian = "big") {
                T::swap(&mut items[start..]);
            }
            left -= step as u64;
        }
        self.finish()?;
        Ok(items)
    }

    /// The bytes of a section that is never long.
    pub(super) fn read_at_most(self, limit: usize) -> Result<Vec<u8>, FileError> {
        if self.entry.length > limit as u64 {
            return damaged(format!("section {} is too long", self.entry.kind.0));
        }
        self.read()
    }

    /// Checks the checksum and keeps nothing.
    pub(super) fn skip(mut self) -> Result<(), FileError> {
        let mut left = self.entry.length;
        let mut piece = vec![0; left.min(1 << 16) as usize];
        while left > 0 {
            let step = left.min(piece.len() as u64) as usize;
            self.from.read_exact(&mut piece[..step]).map_err(truncated)?;
            self.hash.update(&piece[..step]);
            left -= step as u64;
        }
        self.finish()
    }

    fn finish(self) -> Result<(), FileError> {
        if self.hash.digest() == self.entry.checksum {
            return Ok(());
        }
        damaged(format!("the checksum of section {} is wrong", self.entry.kind.0))
    }
}

fn truncated(error: std::io::Error) -> FileError {
    match error.kind() {
        ErrorKind::UnexpectedEof => FileError::Damaged("the file ends too early".into()),
        _ => FileError::Io(error),
    }
}
