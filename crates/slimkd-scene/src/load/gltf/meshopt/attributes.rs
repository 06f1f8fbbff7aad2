//! Mode 0: elements of any kind, their bytes as differences to the element before (appendix A of the extension).

use super::{TOO_LONG, take};

/// Elements in a group.
const GROUP: usize = 16;
/// Most elements in a block.
const BLOCK: usize = 256;

/// How a group's 16 differences are stored.
#[derive(Clone, Copy)]
enum Width {
    /// All are 0.
    Zero,
    /// So many bits each; all ones stand for a byte behind the group.
    Bits(u32),
    /// Bytes.
    Bytes,
}

use Width::{Bits, Bytes, Zero};

/// Fills `out`, elements of `stride` bytes.
pub(super) fn decode(data: &[u8], out: &mut [u8], stride: usize) -> Result<(), String> {
    let (&header, rest) = data.split_first().ok_or(super::CUT_OFF)?;
    let modern = match header {
        0xa0 => false,
        0xa1 => true,
        _ => return Err(format!("the stream begins with {header:#04x}, which is no version of attributes")),
    };
    // The first element's predecessor, and how differences are meant, stand at the stream's end.
    let channels = if modern { stride / 4 } else { 0 };
    let tail = (stride + channels).max(if modern { 24 } else { 32 });
    let (mut data, end) = rest.split_at_checked(rest.len().wrapping_sub(tail)).ok_or(super::CUT_OFF)?;
    let (padding, end) = end.split_at(tail - stride - channels);
    let _ = padding; // zeros by the specification; nothing depends on them
    let (baseline, modes) = end.split_at(stride);
    let mut channel = [Channel::Bytes; 64];
    for (channel, &mode) in channel.iter_mut().zip(modes) {
        *channel = Channel::of(mode)?;
    }
    let mut last = [0; 256];
    last[..stride].copy_from_slice(baseline);

    let most = ((8192 / stride) & !(GROUP - 1)).min(BLOCK);
    let mut deltas = [[0u8; BLOCK]; 4];
    for block in out.chunks_mut(most * stride) {
        let count = block.len() / stride;
        let control = if modern { take(&mut data, channels)? } else { &[] };
        for at in (0..stride).step_by(4) {
            for (byte, deltas) in deltas.iter_mut().enumerate() {
                let widths = match control.get(at / 4).map(|control| control >> (2 * byte) & 3) {
                    None => [Zero, Bits(2), Bits(4), Bytes],
                    Some(0) => [Zero, Bits(1), Bits(2), Bits(4)],
                    Some(1) => [Bits(1), Bits(2), Bits(4), Bytes],
                    Some(2) => {
                        deltas.fill(0);
                        continue;
                    }
                    Some(_) => {
                        deltas[..count].copy_from_slice(take(&mut data, count)?);
                        continue;
                    }
                };
                groups(&mut data, widths, &mut deltas[..count.next_multiple_of(GROUP)])?;
            }
            let last = &mut last[at..at + 4];
            channel[at / 4].undo(
                &deltas,
                last,
                block.chunks_exact_mut(stride).map(|element| &mut element[at..at + 4]),
            );
        }
    }
    if data.is_empty() { Ok(()) } else { Err(TOO_LONG.into()) }
}

/// The differences of one byte of a block's elements, in whole groups.
fn groups(data: &mut &[u8], widths: [Width; 4], deltas: &mut [u8]) -> Result<(), String> {
    let headers = take(data, (deltas.len() / GROUP).div_ceil(4))?;
    for (k, group) in deltas.chunks_exact_mut(GROUP).enumerate() {
        match widths[usize::from(headers[k / 4] >> (2 * (k % 4)) & 3)] {
            Zero => group.fill(0),
            Bytes => group.copy_from_slice(take(data, GROUP)?),
            Bits(bits) => {
                let packed = take(data, GROUP * bits as usize / 8)?;
                let (each, all) = (8 / bits as usize, (1u8 << bits) - 1);
                for (k, delta) in group.iter_mut().enumerate() {
                    let place = (k % each) as u32 * bits;
                    // Single bits go from the lowest up, others from the highest down.
                    let shift = if bits == 1 { place } else { 8 - bits - place };
                    *delta = packed[k / each] >> shift & all;
                    if *delta == all {
                        *delta = take(data, 1)?[0];
                    }
                }
            }
        }
    }
    Ok(())
}

/// What the differences of four bytes mean.
#[derive(Clone, Copy)]
enum Channel {
    Bytes,
    Shorts,
    /// Exclusive or, turned left by so many bits when it was written.
    Xor(u32),
}

impl Channel {
    fn of(mode: u8) -> Result<Self, String> {
        match (mode & 15, mode >> 4) {
            (0, 0) => Ok(Self::Bytes),
            (1, 0) => Ok(Self::Shorts),
            (2, turn) => Ok(Self::Xor(u32::from(turn))),
            _ => Err(format!("channel mode {mode:#04x} is not known")),
        }
    }

    fn undo<'a>(
        self,
        deltas: &[[u8; BLOCK]; 4],
        last: &mut [u8],
        elements: impl Iterator<Item = &'a mut [u8]>,
    ) {
        let short = |a: u8, b: u8| u16::from_le_bytes([a, b]);
        let mut now = [last[0], last[1], last[2], last[3]];
        for (k, element) in elements.enumerate() {
            let delta = deltas.map(|deltas| deltas[k]);
            now = match self {
                Self::Bytes => std::array::from_fn(|byte| {
                    let v = delta[byte];
                    now[byte].wrapping_add((v >> 1) ^ (v & 1).wrapping_neg())
                }),
                Self::Shorts => {
                    let sum = |at: usize| {
                        let v = short(delta[at], delta[at + 1]);
                        let sum = short(now[at], now[at + 1]).wrapping_add((v >> 1) ^ (v & 1).wrapping_neg());
                        sum.to_le_bytes()
                    };
                    let ([a, b], [c, d]) = (sum(0), sum(2));
                    [a, b, c, d]
                }
                Self::Xor(turn) => {
                    (u32::from_le_bytes(now) ^ u32::from_le_bytes(delta).rotate_right(turn)).to_le_bytes()
                }
            };
            element.copy_from_slice(&now);
        }
        last.copy_from_slice(&now);
    }
}
