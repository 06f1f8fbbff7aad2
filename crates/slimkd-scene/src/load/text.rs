//! Text formats: lines and numbers.

use crate::origin::Frame;
use std::borrow::Cow;

/// The lines of a text and their numbers from 1, without white space around them.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    total: usize,
    number: u64,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        // A byte-order mark, as Windows' editors write it.
        let rest = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        Self { rest, total: text.len(), number: 0 }
    }

    /// How many bytes are behind.
    pub(super) fn at(&self) -> usize {
        self.total - self.rest.len()
    }

    /// The next line with the number of its first part; a `\` at a line's end joins it to the next where `joins` says
    /// so of the line: comments and names may end in a backslash, too.
    pub(super) fn next_joined(&mut self, joins: impl Fn(&[u8]) -> bool) -> Option<(u64, Cow<'a, [u8]>)> {
        let (number, line) = self.next()?;
        if !joins(line) {
            return Some((number, Cow::Borrowed(line)));
        }
        let Some(start) = line.strip_suffix(b"\\") else { return Some((number, Cow::Borrowed(line))) };
        let mut joined = start.to_vec();
        for (_, line) in self.by_ref() {
            joined.push(b' ');
            match line.strip_suffix(b"\\") {
                Some(part) => joined.extend_from_slice(part),
                None => {
                    joined.extend_from_slice(line);
                    break;
                }
            }
        }
        Some((number, Cow::Owned(joined)))
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (u64, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        // Lines end in LF, CR LF, or CR alone.
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r');
        let (line, rest) = match end {
            Some(end) => {
                let rest = &self.rest[end + 1..];
                let pair = self.rest[end] == b'\r' && rest.first() == Some(&b'\n');
                (&self.rest[..end], if pair { &rest[1..] } else { rest })
            }
            None => (self.rest, &self.rest[self.rest.len()..]),
        };
        (self.rest, self.number) = (rest, self.number + 1);
        Some((self.number, line.trim_ascii()))
    }
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A number; also the ways in which C libraries print what is not one (`-nan(ind)`, `1.#INF`).
pub(super) fn number<T: std::str::FromStr + From<f32>>(word: &[u8]) -> Option<T> {
    let word = std::str::from_utf8(word).ok()?;
    word.parse().ok().or_else(|| {
        let (lower, first) = (word.to_ascii_lowercase(), word.bytes().next()?);
        if !(first.is_ascii_digit() || matches!(first, b'-' | b'+' | b'n')) {
            return None;
        }
        let bare = lower.trim_start_matches(['+', '-']);
        let infinite = if first == b'-' { f32::NEG_INFINITY } else { f32::INFINITY };
        if bare.starts_with("nan") || bare.starts_with("1.#qnan") || bare.starts_with("1.#ind") {
            Some(f32::NAN.into())
        } else {
            bare.starts_with("1.#inf").then(|| infinite.into())
        }
    })
}

/// The first three words as a position; they are read as f64 where the mesh has an origin.
pub(super) fn position<'a>(mut words: impl Iterator<Item = &'a [u8]>, frame: &Frame) -> Option<[f32; 3]> {
    if !frame.is_exact() {
        return numbers(words);
    }
    let mut out = [0.0; 3];
    for (axis, value) in out.iter_mut().enumerate() {
        *value = frame.axis(axis, number(words.next()?)?);
    }
    Some(out)
}

/// The first `N` of a line's words as numbers; `None` when there are fewer.
pub(super) fn numbers<'a, const N: usize>(mut words: impl Iterator<Item = &'a [u8]>) -> Option<[f32; N]> {
    let mut out = [0.0; N];
    for value in &mut out {
        *value = number(words.next()?)?;
    }
    Some(out)
}
