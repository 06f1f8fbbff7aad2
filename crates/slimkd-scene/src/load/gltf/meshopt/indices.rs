//! Modes 1 and 2: triangles and plain indices (appendix A of the extension).

use super::{CUT_OFF, TOO_LONG, take};

/// Where indices go, of two bytes (what is above is cut) or four.
pub(super) struct Sink<'a> {
    pub(super) out: &'a mut Vec<u8>,
    pub(super) stride: usize,
}

impl Sink<'_> {
    fn put(&mut self, index: u32) {
        self.out.extend_from_slice(&index.to_le_bytes()[..self.stride]);
    }
}

/// A number of 7 bits a byte, low ones first, 5 bytes at most.
fn varint(data: &mut &[u8]) -> Result<u32, String> {
    let mut value = 0;
    for shift in [0, 7, 14, 21, 28] {
        let byte = take(data, 1)?[0];
        value |= u32::from(byte & 127) << shift;
        if byte < 128 {
            return Ok(value);
        }
    }
    Err("a number has more than 5 bytes".into())
}

/// Even numbers as they are, odd ones as negative: 0, −1, 1, −2, …
fn signed(value: u32) -> u32 {
    (value >> 1) ^ (value & 1).wrapping_neg()
}

fn without_header(data: &[u8], header: u8) -> Result<&[u8], String> {
    match data.split_first() {
        Some((&first, rest)) if first == header => Ok(rest),
        Some((first, _)) => Err(format!("the stream begins with {first:#04x}, not {header:#04x}")),
        None => Err(CUT_OFF.into()),
    }
}

pub(super) fn sequence(data: &[u8], count: usize, mut sink: Sink<'_>) -> Result<(), String> {
    let rest = without_header(data, 0xd1)?;
    let (mut data, _) = rest.split_at_checked(rest.len().wrapping_sub(4)).ok_or(CUT_OFF)?;
    let mut last = [0u32; 2];
    for _ in 0..count {
        let value = varint(&mut data)?;
        let last = &mut last[(value & 1) as usize];
        *last = last.wrapping_add(signed(value >> 1));
        sink.put(*last);
    }
    if data.is_empty() { Ok(()) } else { Err(TOO_LONG.into()) }
}

/// The latest 16 of something; reading what was never put there is an error.
struct Fifo<T> {
    entries: [T; 16],
    put: usize,
}

impl<T: Copy> Fifo<T> {
    fn new(empty: T) -> Self {
        Self { entries: [empty; 16], put: 0 }
    }

    fn push(&mut self, entry: T) {
        self.entries[self.put % 16] = entry;
        self.put += 1;
    }

    /// The entry that was put `back` entries before the latest.
    fn get(&self, back: u8) -> Result<T, String> {
        let back = usize::from(back);
        if back < self.put.min(16) {
            Ok(self.entries[(self.put - 1 - back) % 16])
        } else {
            Err("a triangle refers to what was not there yet".into())
        }
    }
}

struct Decoder<'a> {
    data: &'a [u8],
    /// The index that has not been used yet.
    next: u32,
    /// The index that was last given by its difference.
    last: u32,
    edges: Fifo<(u32, u32)>,
    vertices: Fifo<u32>,
}

impl Decoder<'_> {
    fn fresh(&mut self) -> u32 {
        let index = self.next;
        self.next = index.wrapping_add(1);
        index
    }

    fn explicit(&mut self) -> Result<u32, String> {
        self.last = self.last.wrapping_add(signed(varint(&mut self.data)?));
        Ok(self.last)
    }

    /// A corner by four bits, and whether it goes to the latest vertices.
    fn corner(&mut self, code: u8) -> Result<(u32, bool), String> {
        match code {
            0 => Ok((self.fresh(), true)),
            15 => Ok((self.explicit()?, true)),
            _ => Ok((self.vertices.get(code - 1)?, false)),
        }
    }

    /// A triangle at a known edge.
    fn at_edge(&mut self, code: u8) -> Result<[u32; 3], String> {
        let (a, b) = self.edges.get(code >> 4)?;
        let (c, keep) = match code & 15 {
            0 => (self.fresh(), true),
            13 | 14 => {
                self.last =
                    if code & 15 == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                (self.last, true)
            }
            15 => (self.explicit()?, true),
            back => (self.vertices.get(back)?, false),
        };
        self.edges.push((c, b));
        self.edges.push((a, c));
        if keep {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }

    /// A triangle of its own; `codes` are four bits each for its second and third corner.
    fn alone(&mut self, a: u32, codes: u8) -> Result<[u32; 3], String> {
        let (b, keep_b) = self.corner(codes >> 4)?;
        let (c, keep_c) = self.corner(codes & 15)?;
        self.edges.push((b, a));
        self.edges.push((c, b));
        self.edges.push((a, c));
        self.vertices.push(a);
        if keep_b {
            self.vertices.push(b);
        }
        if keep_c {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }
}

pub(super) fn triangles(data: &[u8], count: usize, mut sink: Sink<'_>) -> Result<(), String> {
    let mut rest = without_header(data, 0xe1)?;
    let codes = take(&mut rest, count / 3)?;
    let (data, table) = rest.split_at_checked(rest.len().wrapping_sub(16)).ok_or(CUT_OFF)?;
    let (edges, vertices) = (Fifo::new((0, 0)), Fifo::new(0));
    let mut decoder = Decoder { data, next: 0, last: 0, edges, vertices };
    for &code in codes {
        let corners = match code {
            0xfe | 0xff => {
                let codes = take(&mut decoder.data, 1)?[0];
                if codes == 0 {
                    decoder.next = 0;
                }
                let a = if code == 0xfe { decoder.fresh() } else { decoder.explicit()? };
                decoder.alone(a, codes)?
            }
            0xf0..0xfe => {
                let codes = table[usize::from(code & 15)];
                if codes >> 4 == 15 || codes & 15 == 15 {
                    return Err("its table is damaged".into());
                }
                let a = decoder.fresh();
                decoder.alone(a, codes)?
            }
            _ => decoder.at_edge(code)?,
        };
        corners.into_iter().for_each(|corner| sink.put(corner));
    }
    if decoder.data.is_empty() { Ok(()) } else { Err(TOO_LONG.into()) }
}
