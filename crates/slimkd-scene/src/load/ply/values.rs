//! Reading a PLY's numbers one after the other, from text or binary data.

use super::{
    header::{Encoding, Number},
    invalid,
};
use crate::load::{LoadError, Place, error::quoted, text};

/// The numbers of the file's data, in order. `f64` holds each of the format's types exactly, and what an index may be of the
/// 64-bit ones that some programs write.
pub(super) trait Values {
    fn next(&mut self, number: Number) -> Result<f64, LoadError>;
    /// What to read a number as, so that it is as exact as the file says it.
    fn exact(&self, number: Number) -> Number {
        number
    }
    /// Where the next number is.
    fn place(&self) -> Place;
    /// Bytes from the start.
    fn at(&self) -> usize;
    /// An upper bound of how many numbers of that type can follow.
    fn most(&self, number: Number) -> u64;
    /// Called behind each entry.
    fn end_entry(&mut self) {}
}

/// Binary data.
pub(super) struct Binary<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    pub(super) big: bool,
}

/// A number at the start of `bytes`, which hold at least its size.
#[inline]
pub(super) fn decode(bytes: &[u8], number: Number, big: bool) -> f64 {
    macro_rules! decode {
        ($type:ty) => {{
            let mut raw = [0; size_of::<$type>()];
            raw.copy_from_slice(&bytes[..size_of::<$type>()]);
            (if big { <$type>::from_be_bytes(raw) } else { <$type>::from_le_bytes(raw) }) as f64
        }};
    }
    match number {
        Number::I8 => decode!(i8),
        Number::U8 => decode!(u8),
        Number::I16 => decode!(i16),
        Number::U16 => decode!(u16),
        Number::I32 => decode!(i32),
        Number::U32 => decode!(u32),
        Number::I64 => decode!(i64),
        Number::U64 => decode!(u64),
        Number::F32 => decode!(f32),
        Number::F64 => decode!(f64),
    }
}

impl Values for Binary<'_> {
    fn next(&mut self, number: Number) -> Result<f64, LoadError> {
        let rest = &self.bytes[self.at..];
        if rest.len() < number.size() {
            return Err(cut_off(self.place()));
        }
        self.at += number.size();
        Ok(decode(rest, number, self.big))
    }

    fn place(&self) -> Place {
        Place::Byte(self.at as u64)
    }

    fn at(&self) -> usize {
        self.at
    }

    fn most(&self, number: Number) -> u64 {
        ((self.bytes.len() - self.at) / number.size()) as u64
    }
}

/// Text: numbers with white space between them. Line ends are counted but mean nothing more, as in most readers, unless
/// entries are read line by line.
pub(super) struct Text<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    pub(super) line: u64,
    /// An entry ends its line, whatever else is in it.
    pub(super) by_lines: bool,
    /// Entries, and those whose lines have more in them.
    pub(super) entries: u64,
    pub(super) longer: u64,
}

impl<'a> Text<'a> {
    pub(super) fn new(bytes: &'a [u8], at: usize, line: u64, by_lines: bool) -> Self {
        Self { bytes, at, line, by_lines, entries: 0, longer: 0 }
    }

    /// True when there is something behind the last number that was read.
    pub(super) fn has_more(&self) -> bool {
        !self.bytes[self.at..].trim_ascii().is_empty()
    }
}

impl Values for Text<'_> {
    fn exact(&self, number: Number) -> Number {
        if number == Number::F32 { Number::F64 } else { number }
    }

    fn next(&mut self, number: Number) -> Result<f64, LoadError> {
        let mut rest = &self.bytes[self.at..];
        while let [first, tail @ ..] = rest
            && first.is_ascii_whitespace()
        {
            self.line += u64::from(ends_line(*first, tail));
            rest = tail;
        }
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at = self.bytes.len() - rest.len();
        if length == 0 {
            return Err(cut_off(self.place()));
        }
        let word = &rest[..length];
        let value = match number {
            // Parsed as f32 so that it is rounded once.
            Number::F32 => text::number::<f32>(word).map(f64::from),
            _ => text::number(word),
        };
        let value = value.ok_or_else(|| {
            invalid(self.place(), format!("{} is not a number", quoted(word)), "write a number there")
        })?;
        self.at += length;
        Ok(value)
    }

    fn place(&self) -> Place {
        let rest = &self.bytes[self.at..];
        let blanks = rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let ends = (0..blanks).filter(|&k| ends_line(rest[k], &rest[k + 1..])).count();
        Place::Line(self.line + ends as u64)
    }

    fn at(&self) -> usize {
        self.at
    }

    fn most(&self, _: Number) -> u64 {
        (self.bytes.len() - self.at).div_ceil(2) as u64
    }

    fn end_entry(&mut self) {
        if !self.by_lines {
            return;
        }
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(rest.len());
        self.entries += 1;
        self.longer += u64::from(!rest[..end].trim_ascii().is_empty());
        self.at += end;
    }
}

/// True for the last byte of a line's end: LF, or CR without an LF behind it.
fn ends_line(byte: u8, tail: &[u8]) -> bool {
    byte == b'\n' || (byte == b'\r' && tail.first() != Some(&b'\n'))
}

pub(super) fn cut_off(place: Place) -> LoadError {
    invalid(
        place,
        "the file ends before all entries that its header announces",
        "it was cut off: write or download it again",
    )
}

impl Encoding {
    /// True when the most significant byte comes first.
    pub(super) fn is_big(self) -> bool {
        self == Self::Big
    }
}
