//! The PLY header: which elements follow, and how their values are stored (Greg Turk, *The PLY Polygon File Format*).

use super::invalid;
use crate::load::{LoadError, Place, error::quoted};

/// The byte-order mark of UTF-8.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// How values are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    Little,
    Big,
}

/// A number's type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "int64" => Self::I64,
            "uint64" => Self::U64,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// One value, or a list of values, of each entry of an element.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of the list's length; `None`: not a list.
    pub(super) length: Option<Number>,
    pub(super) number: Number,
}

/// A table of the file.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// The header's line that names it.
    pub(super) line: u64,
}

impl Element {
    /// The fewest bytes that an entry takes.
    pub(super) fn least_bytes(&self, encoding: Encoding) -> u64 {
        let least = |property: &Property| match encoding {
            Encoding::Text => 2, // a digit and what parts it from the next
            _ => property.length.unwrap_or(property.number).size() as u64,
        };
        self.properties.iter().map(least).sum()
    }

    /// True when each entry takes the same number of bytes.
    pub(super) fn is_fixed(&self) -> bool {
        self.properties.iter().all(|property| property.length.is_none())
    }
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where the data starts.
    pub(super) bytes: usize,
    /// Lines of the header.
    pub(super) lines: u64,
}

impl Header {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, LoadError> {
        // A byte-order mark, as Windows' editors and some scripts write it.
        let mark = if bytes.starts_with(MARK) { MARK.len() } else { 0 };
        if !bytes[mark..].starts_with(b"ply") {
            let what = format!("it starts with {}, not \"ply\"", quoted(&bytes[..bytes.len().min(8)]));
            return Err(invalid(Place::Byte(0), what, "give the file the extension of what it is"));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let (mut at, mut lines) = (mark, 0);
        // Lines end as the first one does: in CR alone, as the format's first description has it, or in LF.
        let first = bytes.iter().position(|&b| b == b'\n' || b == b'\r');
        let end = match first {
            Some(k) if bytes[k] == b'\r' && bytes.get(k + 1) != Some(&b'\n') => b'\r',
            _ => b'\n',
        };
        loop {
            let Some(length) = bytes[at..].iter().position(|&b| b == end) else {
                return Err(invalid(
                    Place::Line(lines + 1),
                    "the header ends without end_header",
                    "the file is cut off or not a PLY",
                ));
            };
            let line = &bytes[at..at + length];
            (at, lines) = (at + length + 1, lines + 1);
            let wrong = |fix| invalid(Place::Line(lines), format!("header line {}", quoted(line)), fix);
            let words: Vec<&str> = std::str::from_utf8(line)
                .map(|text| text.split_ascii_whitespace().take(6).collect())
                .unwrap_or_default();
            match words[..] {
                ["ply"] if lines == 1 => {}
                ["format", name, _] => {
                    encoding = Some(match name {
                        "ascii" => Encoding::Text,
                        "binary_little_endian" => Encoding::Little,
                        "binary_big_endian" => Encoding::Big,
                        _ => return Err(wrong("use ascii, binary_little_endian or binary_big_endian")),
                    });
                }
                ["element", name, count] => {
                    let count = count
                        .parse()
                        .map_err(|_| wrong("write a count that is a whole number, 0 or more"))?;
                    elements.push(Element { name: name.into(), count, properties: Vec::new(), line: lines });
                }
                ["property", ref rest @ ..] => {
                    let element =
                        elements.last_mut().ok_or_else(|| wrong("put an element before its properties"))?;
                    let number = |name| {
                        Number::named(name).ok_or_else(|| wrong("use char to uint, float or double as type"))
                    };
                    element.properties.push(match *rest {
                        ["list", length, item, name] => Property {
                            name: name.into(),
                            length: Some(number(length)?),
                            number: number(item)?,
                        },
                        [item, name] => Property { name: name.into(), length: None, number: number(item)? },
                        _ => {
                            return Err(wrong(
                                "write \"property type name\" or \"property list type type name\"",
                            ));
                        }
                    });
                }
                ["end_header"] => break,
                // Comments may hold bytes of any encoding.
                _ if line.starts_with(b"comment")
                    || line.starts_with(b"obj_info")
                    || line.trim_ascii().is_empty() => {}
                _ => return Err(wrong("use format, element, property, comment, obj_info or end_header")),
            }
        }
        let encoding = encoding.ok_or_else(|| {
            invalid(
                Place::Line(lines),
                "the header has no format line",
                "add \"format ascii 1.0\" or what it is",
            )
        })?;
        if encoding == Encoding::Text && bytes[at..].starts_with(MARK) {
            at += MARK.len();
        }
        Ok(Self { encoding, elements, bytes: at, lines })
    }
}
