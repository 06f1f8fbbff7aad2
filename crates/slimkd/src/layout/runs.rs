//! Ascending ids as gaps and runs, the usual byte code of inverted indexes.
//!
//! ```text
//! code, a byte           | gap: 5 bits | run − 1: 3 bits |
//! ```
//! Each code skips `gap` ids and takes the next `run`. A gap of 29 is followed by a byte that is added to it; 30 by the gap as u16; 31
//! by the gap as u32. A leaf's header says how many ids there are, and which is the first.

/// Gaps from here on need more than the code's 5 bits.
const GAP_PLUS_BYTE: u32 = 29;
const GAP_2BYTE: u32 = 30;
const GAP_4BYTE: u32 = 31;
/// Ids that one code takes at most.
pub(super) const LONGEST_RUN: usize = 8;

/// Calls `code` with the gap and the run of each code of the ids that follow `first`.
pub(super) fn for_each_code(first: u32, mut rest: &[u32], mut code: impl FnMut(u32, usize)) {
    let mut next = first + 1;
    while let Some(&start) = rest.first() {
        let run = (1..LONGEST_RUN.min(rest.len())).take_while(|&k| rest[k] == start + k as u32).count() + 1;
        code(start - next, run);
        next = start + run as u32;
        rest = &rest[run..];
    }
}

/// Bytes of a code with this gap.
pub(super) fn code_size(gap: u32) -> u64 {
    match field(gap) {
        GAP_PLUS_BYTE => 2,
        GAP_2BYTE => 3,
        GAP_4BYTE => 5,
        _ => 1,
    }
}

/// The 5 bits that say how a gap is written.
fn field(gap: u32) -> u32 {
    match gap {
        0..GAP_PLUS_BYTE => gap,
        GAP_PLUS_BYTE..=284 => GAP_PLUS_BYTE,
        285..=0xffff => GAP_2BYTE,
        _ => GAP_4BYTE,
    }
}

/// Appends a code.
pub(super) fn write_code(out: &mut Vec<u8>, gap: u32, run: usize) {
    let field = field(gap);
    out.push((field << 3) as u8 | (run - 1) as u8);
    match field {
        GAP_PLUS_BYTE => out.push((gap - GAP_PLUS_BYTE) as u8),
        GAP_2BYTE => out.extend_from_slice(&(gap as u16).to_le_bytes()),
        GAP_4BYTE => out.extend_from_slice(&gap.to_le_bytes()),
        _ => (),
    }
}

/// One code in the 8 bytes from its start: the gap, the run, and the bytes it takes.
#[inline(always)]
pub(super) fn read_code(bytes: u64) -> (u32, u32, u32) {
    let (run, field) = ((bytes as u32 & 7) + 1, bytes as u32 >> 3 & 31);
    let tail = (bytes >> 8) as u32;
    // Nearly always the first: a branch that is foreseen lets the next code start before this one is known.
    if field < GAP_PLUS_BYTE {
        return (field, run, 1);
    }
    match field {
        GAP_PLUS_BYTE => (GAP_PLUS_BYTE + (tail & 0xff), run, 2),
        GAP_2BYTE => (tail & 0xffff, run, 3),
        _ => (tail, run, 5),
    }
}
