//! Options as words: what a command line or a configuration file says, and back.

use super::{Clipping, HoistAlgorithm, Layout, Splits, TreeBudget};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// A word that no option has: use one of those that the message lists.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{found:?} is no {what}; use {usable}")]
pub struct UnknownName {
    what: &'static str,
    found: String,
    usable: String,
}

impl UnknownName {
    pub(super) fn new(
        what: &'static str,
        found: &str,
        usable: impl IntoIterator<Item = &'static str>,
    ) -> Self {
        let words: Vec<_> = usable.into_iter().collect();
        let usable = match &words[..] {
            [others @ .., last] if !others.is_empty() => format!("{} or {last}", others.join(", ")),
            words => words.concat(),
        };
        Self { what, found: found.to_owned(), usable }
    }
}

/// `exact`, `box`, or a number N: exact in nodes of at least N triangles.
///
/// ```
/// use slimkd::Clipping;
/// assert_eq!("10000".parse(), Ok(Clipping::ExactFrom(10_000)));
/// assert_eq!(Clipping::Box.to_string(), "box");
/// ```
impl fmt::Display for Clipping {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exact => f.write_str("exact"),
            Self::ExactFrom(least) => write!(f, "{least}"),
            Self::Box => f.write_str("box"),
        }
    }
}

impl FromStr for Clipping {
    type Err = UnknownName;

    fn from_str(word: &str) -> Result<Self, UnknownName> {
        match word {
            "exact" => Ok(Self::Exact),
            "box" => Ok(Self::Box),
            number => number
                .parse()
                .map(Self::ExactFrom)
                .map_err(|_| UnknownName::new("clipping", word, ["exact", "box", "a number of triangles"])),
        }
    }
}

/// `four-byte`, `two-byte`, `dense` or `wide`.
///
/// ```
/// use slimkd::Layout;
/// assert_eq!("two-byte".parse(), Ok(Layout::TwoByte));
/// assert_eq!("eight".parse::<Layout>().unwrap_err().to_string(), "\"eight\" is no layout; use four-byte, two-byte, dense or wide");
/// ```
impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FourByte => "four-byte",
            Self::TwoByte => "two-byte",
            Self::Dense => "dense",
            Self::Wide => "wide",
        })
    }
}

impl FromStr for Layout {
    type Err = UnknownName;

    fn from_str(word: &str) -> Result<Self, UnknownName> {
        match word {
            "four-byte" => Ok(Self::FourByte),
            "two-byte" => Ok(Self::TwoByte),
            "dense" => Ok(Self::Dense),
            "wide" => Ok(Self::Wide),
            word => Err(UnknownName::new("layout", word, ["four-byte", "two-byte", "dense", "wide"])),
        }
    }
}

/// `both` or `space`.
///
/// ```
/// use slimkd::Splits;
/// assert_eq!("space".parse(), Ok(Splits::Space));
/// ```
impl fmt::Display for Splits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Both => "both",
            Self::Space => "space",
        })
    }
}

impl FromStr for Splits {
    type Err = UnknownName;

    fn from_str(word: &str) -> Result<Self, UnknownName> {
        match word {
            "both" => Ok(Self::Both),
            "space" => Ok(Self::Space),
            word => Err(UnknownName::new("kind of splits", word, ["both", "space"])),
        }
    }
}

/// `strip` or `rebuild`.
impl fmt::Display for HoistAlgorithm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Strip => "strip",
            Self::Rebuild => "rebuild",
        })
    }
}

impl FromStr for HoistAlgorithm {
    type Err = UnknownName;

    fn from_str(word: &str) -> Result<Self, UnknownName> {
        match word {
            "strip" => Ok(Self::Strip),
            "rebuild" => Ok(Self::Rebuild),
            word => Err(UnknownName::new("way to hoist", word, ["strip", "rebuild"])),
        }
    }
}

/// A number of bytes with or without a unit (`kB`, `MB`, `GB`, `TB` by thousands; `KiB`, `MiB`, `GiB`, `TiB` by 1,024), or bytes a
/// triangle, as `6/tri`.
///
/// ```
/// use slimkd::TreeBudget;
/// assert_eq!("64MiB".parse(), Ok(TreeBudget::Bytes(64 << 20)));
/// assert_eq!("6.5/tri".parse(), Ok(TreeBudget::BytesPerTriangle(6.5)));
/// ```
impl fmt::Display for TreeBudget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bytes(bytes) => write!(f, "{bytes}"),
            Self::BytesPerTriangle(each) => write!(f, "{each}/tri"),
        }
    }
}

const UNITS: [(&str, f64); 10] = [
    ("KiB", 1024.0),
    ("MiB", 1_048_576.0),
    ("GiB", 1_073_741_824.0),
    ("TiB", 1_099_511_627_776.0),
    ("kB", 1e3),
    ("KB", 1e3),
    ("MB", 1e6),
    ("GB", 1e9),
    ("TB", 1e12),
    ("B", 1.0),
];

impl FromStr for TreeBudget {
    type Err = UnknownName;

    fn from_str(word: &str) -> Result<Self, UnknownName> {
        let unknown = || UnknownName::new("number of bytes", word, ["800000", "64MiB", "6/tri"]);
        if let Some(each) = word.strip_suffix("/tri") {
            let each = each.parse().ok().filter(|each: &f32| each.is_finite() && *each > 0.0);
            return each.map(Self::BytesPerTriangle).ok_or_else(unknown);
        }
        let (number, unit) = UNITS
            .iter()
            .find_map(|&(name, unit)| Some((word.strip_suffix(name)?.trim_end(), unit)))
            .unwrap_or((word, 1.0));
        let bytes = number.parse::<f64>().map(|number| number * unit);
        bytes
            .ok()
            .filter(|bytes| (1.0..1e18).contains(bytes))
            .map(|b| Self::Bytes(b as u64))
            .ok_or_else(unknown)
    }
}
