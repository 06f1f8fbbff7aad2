//! Taking `.skd` files apart and putting them together with right checksums, independently of the library's code.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part

use std::ops::Range;
use xxhash_rust::xxh3::xxh3_64;

pub struct Section {
    pub kind: u32,
    pub range: Range<usize>,
}

fn word(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
}

fn count(bytes: &[u8]) -> usize {
    u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize
}

/// The sections of a sound file.
pub fn sections(bytes: &[u8]) -> Vec<Section> {
    (0..count(bytes))
        .map(|section| {
            let at = 64 + 32 * section;
            let start = word(bytes, at + 8) as usize;
            Section { kind: word(bytes, at) as u32, range: start..start + word(bytes, at + 16) as usize }
        })
        .collect()
}

/// Kinds and contents.
pub fn parts(bytes: &[u8]) -> Vec<(u32, Vec<u8>)> {
    sections(bytes).into_iter().map(|section| (section.kind, bytes[section.range].to_vec())).collect()
}

/// A file of these kinds and contents.
pub fn join(parts: &[(u32, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = vec![0; 64 + 32 * parts.len()];
    bytes[..8].copy_from_slice(b"SKDTREE\0");
    bytes[8] = 3; // the version
    bytes[12] = parts.len() as u8;
    for (section, (kind, content)) in parts.iter().enumerate() {
        bytes.resize(bytes.len().next_multiple_of(64), 0);
        let at = 64 + 32 * section;
        let start = bytes.len() as u64;
        bytes[at..at + 8].copy_from_slice(&u64::from(*kind).to_le_bytes());
        bytes[at + 8..at + 16].copy_from_slice(&start.to_le_bytes());
        bytes[at + 16..at + 24].copy_from_slice(&(content.len() as u64).to_le_bytes());
        bytes.extend_from_slice(content);
    }
    let length = bytes.len() as u64;
    bytes[16..24].copy_from_slice(&length.to_le_bytes());
    sign(&mut bytes);
    bytes
}

/// Makes all checksums right.
pub fn sign(bytes: &mut [u8]) {
    for (section, Section { range, .. }) in sections(bytes).into_iter().enumerate() {
        let sum = xxh3_64(&bytes[range]);
        bytes[64 + 32 * section + 24..][..8].copy_from_slice(&sum.to_le_bytes());
    }
    sign_header(bytes);
}

/// Makes offsets, the file's length and the header's checksum follow from the lengths in the table, true or not.
pub fn place(bytes: &mut [u8]) {
    let mut position = (64 + 32 * count(bytes)) as u64;
    for section in 0..count(bytes) {
        let at = 64 + 32 * section;
        let offset = position.div_ceil(64).wrapping_mul(64);
        bytes[at + 8..at + 16].copy_from_slice(&offset.to_le_bytes());
        position = offset.wrapping_add(word(bytes, at + 16));
    }
    bytes[16..24].copy_from_slice(&position.to_le_bytes());
    sign_header(bytes);
}

fn sign_header(bytes: &mut [u8]) {
    let table = &bytes[64..64 + 32 * count(bytes)];
    let sum = xxh3_64(&[&bytes[..24], table].concat());
    bytes[24..32].copy_from_slice(&sum.to_le_bytes());
}
