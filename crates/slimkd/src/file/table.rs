//! Header and section table.
//!
//! ```text
//! header   0  "SKDTREE\0"
//!          8  version u32, number of sections u32
//!         16  length of the file u64
//!         24  xxh3 of the 24 bytes before and of the table, u64
//!         32  zeros up to 64
//! table   64  per section: kind u32, zero u32, offset u64, length u64, xxh3 of its bytes u64
//! ```
//!
//! Kinds ascend, and every offset is the first multiple of 64 behind what precedes it: there is one way to write a tree.

use super::{FileError, damaged};
use std::borrow::Cow;
use std::io::{Read, Write};
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

const MAGIC: &[u8; 8] = b"SKDTREE\0";
/// The only version that is read. Any change of the format counts it up.
const VERSION: u32 = 3;
/// Sections begin at multiples of this, bytes: a cache line, and the alignment of every item that may come.
const ALIGNMENT: u64 = 64;
const HEADER: usize = 64;
const ENTRY: usize = 32;
/// Most sections that are believed; there are 8 kinds.
const MOST_SECTIONS: u32 = 64;

/// What a section holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Kind(pub(super) u32);

impl Kind {
    pub(super) const OPTIONS: Self = Self(1);
    pub(super) const SHAPE: Self = Self(2);
    pub(super) const VERTICES: Self = Self(3);
    pub(super) const TRIANGLES: Self = Self(4);
    pub(super) const ORIGIN: Self = Self(5);
    /// The first kind that belongs to the encoded tree; `sections.rs` names them.
    pub(super) const TREE: Self = Self(16);
}

/// Where a section lies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) kind: Kind,
    pub(super) offset: u64,
    pub(super) length: u64,
    pub(super) checksum: u64,
}

/// The sections of a file, in order.
#[derive(Clone, Debug)]
pub(super) struct Table {
    pub(super) entries: Vec<Entry>,
}

/// The first multiple of [`ALIGNMENT`] from `position`.
fn aligned(position: u64) -> Option<u64> {
    position.checked_next_multiple_of(ALIGNMENT)
}

/// Where the table of that many sections ends.
fn end(sections: usize) -> u64 {
    (HEADER + sections * ENTRY) as u64
}

fn checksum(start: &[u8], table: &[u8]) -> u64 {
    let mut hash = Xxh3::new();
    hash.update(start);
    hash.update(table);
    hash.digest()
}

/// Writes header, table and sections.
pub(super) fn write(to: &mut impl Write, sections: &[(Kind, Cow<'_, [u8]>)]) -> std::io::Result<()> {
    debug_assert!(sections.is_sorted_by(|a, b| a.0 < b.0));
    let mut table = Vec::with_capacity(sections.len() * ENTRY);
    let mut position = end(sections.len());
    for (kind, bytes) in sections {
        let offset = position.next_multiple_of(ALIGNMENT);
        position = offset + bytes.len() as u64;
        for number in [u64::from(kind.0), offset, bytes.len() as u64, xxh3_64(bytes)] {
            table.extend_from_slice(&number.to_le_bytes());
        }
    }
    let mut header = [0; HEADER];
    header[..8].copy_from_slice(MAGIC);
    header[8..12].copy_from_slice(&VERSION.to_le_bytes());
    header[12..16].copy_from_slice(&(sections.len() as u32).to_le_bytes());
    header[16..24].copy_from_slice(&position.to_le_bytes());
    let sum = checksum(&header[..24], &table);
    header[24..32].copy_from_slice(&sum.to_le_bytes());

    to.write_all(&header)?;
    to.write_all(&table)?;
    let mut position = end(sections.len());
    for (_, bytes) in sections {
        let offset = position.next_multiple_of(ALIGNMENT);
        to.write_all(&[0; ALIGNMENT as usize][..(offset - position) as usize])?;
        to.write_all(bytes)?;
        position = offset + bytes.len() as u64;
    }
    Ok(())
}

impl Table {
    /// Reads and checks both; nothing of a section is looked at.
    pub(super) fn read(from: &mut impl Read) -> Result<Self, FileError> {
        let mut header = [0; HEADER];
        let read = read_up_to(from, &mut header)?;
        if read < 12 || &header[..8] != MAGIC {
            return Err(FileError::NotATree);
        }
        let word = |at: usize| u32::from_le_bytes(std::array::from_fn(|k| header[at + k]));
        let (version, sections) = (word(8), word(12));
        if version != VERSION {
            return Err(FileError::Version { found: version, expected: VERSION });
        }
        if read < HEADER || sections > MOST_SECTIONS {
            return damaged("its header is cut off or makes no sense");
        }
        let mut table = vec![0; sections as usize * ENTRY];
        if read_up_to(from, &mut table)? < table.len() {
            return damaged("its table is cut off");
        }
        let (words, _) = header.as_chunks::<8>();
        let [length, sum] = [2, 3].map(|at| u64::from_le_bytes(words[at]));
        if sum != checksum(&header[..24], &table) || header[32..] != [0; 32] {
            return damaged("the checksum of its header is wrong");
        }
        Self::parse(&table, length)
    }

    fn parse(table: &[u8], file_length: u64) -> Result<Self, FileError> {
        let mut entries = Vec::with_capacity(table.len() / ENTRY);
        let mut position = end(table.len() / ENTRY);
        let mut last = Kind(0);
        for entry in table.as_chunks::<ENTRY>().0 {
            let (words, _) = entry.as_chunks::<8>();
            let [kind, offset, length, checksum] = std::array::from_fn(|k| u64::from_le_bytes(words[k]));
            let Ok(kind) = u32::try_from(kind).map(Kind) else {
                return damaged("a section's kind is absurd");
            };
            if kind <= last || aligned(position) != Some(offset) {
                return damaged("its sections are out of place");
            }
            let Some(next) = offset.checked_add(length) else {
                return damaged("a section's length is absurd");
            };
            (last, position) = (kind, next);
            entries.push(Entry { kind, offset, length, checksum });
        }
        if position != file_length { damaged("its length is wrong") } else { Ok(Self { entries }) }
    }

    /// Where the table ends, bytes from the file's start.
    pub(super) fn end(&self) -> u64 {
        end(self.entries.len())
    }
}

/// Fills `buffer` as far as the input goes.
fn read_up_to(from: &mut impl Read, buffer: &mut [u8]) -> std::io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match from.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(got) => filled += got,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}
