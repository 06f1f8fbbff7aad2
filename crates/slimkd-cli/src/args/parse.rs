//! Values of options, parsed and checked.

use slimkd::{Clipping, Layout, Splits, TreeBudget, UnknownName};
use std::fmt::Display;
use std::num::{NonZeroU32, NonZeroUsize};
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Most threads that may be asked for: beyond any machine, below what exhausts it.
const MAX_THREADS: usize = 1024;
/// Most triangles of a built-in scene: about 10 GiB of scene, the most that one should start by mistake.
const MAX_TRIANGLES: u32 = 100_000_000;
/// Longest edge of a picture, pixels: 16384² × 3 × 4 B is 3 GiB, the most that one should start by mistake.
const MAX_EDGE: u32 = 16_384;
/// Smallest and largest cost: what f32 holds in full precision, rounded.
const COSTS: RangeInclusive<f32> = 1e-37..=3.4e38;

/// A parser of whole numbers in a range.
pub(crate) fn within<T>(
    range: RangeInclusive<T>,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static
where
    T: FromStr + PartialOrd + Display + Clone + Send + Sync + 'static,
{
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| expected(&range))
    }
}

/// What is said of every number out of its range.
fn expected<T: Display>(range: &RangeInclusive<T>) -> String {
    format!("expected a number from {} to {}", range.start(), range.end())
}

/// A thread count.
pub(crate) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    within(1..=MAX_THREADS)(text).map(|count| NonZeroUsize::new(count).unwrap_or(NonZeroUsize::MIN))
}

/// A number of triangles to generate.
pub(crate) fn triangles(text: &str) -> Result<NonZeroU32, String> {
    within(1..=MAX_TRIANGLES)(text).map(|count| NonZeroU32::new(count).unwrap_or(NonZeroU32::MIN))
}

/// Width and height of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    /// Pixels.
    pub(crate) width: u32,
    /// Pixels.
    pub(crate) height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let edge = |text: &str| text.parse().ok().filter(|edge| (1..=MAX_EDGE).contains(edge));
        text.split_once(['x', 'X'])
            .and_then(|(width, height)| Some(Self { width: edge(width)?, height: edge(height)? }))
            .ok_or_else(|| format!("expected WIDTHxHEIGHT such as 1024x1024, each from 1 to {MAX_EDGE}"))
    }
}

/// A finite number above zero.
pub(super) fn positive(text: &str) -> Result<f32, String> {
    number(text, COSTS)
}

/// A finite number from zero.
pub(super) fn not_negative(text: &str) -> Result<f32, String> {
    number(text, 0.0..=*COSTS.end())
}

/// A number from zero to one.
pub(super) fn fraction(text: &str) -> Result<f32, String> {
    number(text, 0.0..=1.0)
}

/// By how many stops a picture is made brighter: beyond these it is black or white.
pub(crate) fn stops(text: &str) -> Result<f32, String> {
    number(text, -100.0..=100.0)
}

fn number(text: &str, range: RangeInclusive<f32>) -> Result<f32, String> {
    let short = |number: f32| {
        // Digits beside an exponent, where there would be dozens of zeros.
        if number != 0.0 && !(1e-3..1e6).contains(&number.abs()) {
            format!("{number:e}")
        } else {
            number.to_string()
        }
    };
    let number = text.parse().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| expected(&(short(*range.start())..=short(*range.end()))))
}

/// How triangles are bounded.
pub(super) fn clipping(text: &str) -> Result<Clipping, UnknownName> {
    text.parse()
}

/// What divides nodes.
pub(super) fn splits(text: &str) -> Result<Splits, UnknownName> {
    text.parse()
}

/// The most that a tree may take; `None` for no bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TreeSize(pub(super) Option<TreeBudget>);

/// Bytes for a tree, or none.
pub(super) fn tree_budget(text: &str) -> Result<TreeSize, String> {
    if text == "none" {
        return Ok(TreeSize(None));
    }
    text.parse()
        .map(|budget| TreeSize(Some(budget)))
        .map_err(|_| "expected bytes such as 64MiB or 800000, bytes a triangle such as 6/tri, or none".into())
}

/// A number of bytes above 0, with or without a unit.
pub(super) fn bytes(text: &str) -> Result<u64, String> {
    match text.parse() {
        Ok(TreeBudget::Bytes(bytes)) => Ok(bytes),
        _ => Err("expected a number from 1 to 1e18 bytes, such as 64MiB or 800000".into()),
    }
}

/// How the tree is written.
pub(super) fn layout(text: &str) -> Result<Layout, UnknownName> {
    text.parse()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!("640x480".parse(), Ok(Size { width: 640, height: 480 }));
        for wrong in ["640", "640x", "x480", "0x1", "1x99999", "-1x1", "1x1x1", ""] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        assert_eq!(threads("3").unwrap().get(), 3);
        assert!(["0", "-1", "x", "99999999"].iter().all(|text| threads(text).is_err()));
        assert_eq!(positive("0.8"), Ok(0.8));
        assert!(["0", "-1", "nan", "inf", "x"].iter().all(|text| positive(text).is_err()));
        assert_eq!((not_negative("0"), fraction("1")), (Ok(0.0), Ok(1.0)));
        assert!(["-0.1", "inf", ""].iter().all(|text| not_negative(text).is_err()));
        assert!(["-0.1", "1.01", "nan"].iter().all(|text| fraction(text).is_err()));
        assert!(["1e300", "1e-300"].iter().all(|text| positive(text).is_err()));
        assert!(["inf", "nan", "101"].iter().all(|text| stops(text).is_err()));
    }

    #[test]
    fn one_phrase_for_all_ranges() {
        for (error, range) in [
            (threads("0").unwrap_err(), "1 to 1024"),
            (within(5..=1000)("3").unwrap_err(), "5 to 1000"),
            (positive("1e300").unwrap_err(), "1e-37 to 3.4e38"),
            (not_negative("-1").unwrap_err(), "0 to 3.4e38"),
            (fraction("2").unwrap_err(), "0 to 1"),
            (stops("bright").unwrap_err(), "-100 to 100"),
        ] {
            assert_eq!(error, format!("expected a number from {range}"));
        }
    }
}
