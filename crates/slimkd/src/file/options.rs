//! Build options as bytes: for each option a tag, the length of its value, and the value.
//!
//! ```text
//! tag: u8 | length: u8 | value: `length` bytes, little-endian
//! ```
//!
//! Tags ascend, so that the same options are always the same bytes. An option at its preset's value is written too: a later
//! version may change presets. An unknown tag is an error, since a tree with another option would be another tree. What leaves no
//! trace in a tree is left out: threads, and limits of bytes.

use crate::options::{
    BuildOptions, Clipping, HoistAlgorithm, Hoisting, Layout, Preset, SahConstants, Splits,
};

/// Longest block, bytes: all options take less than 100.
pub(super) const LIMIT: usize = 4096;

/// What a value says. Numbers are never used again for something else.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
enum Tag {
    Preset = 1,
    Traversal = 2,
    Intersection = 3,
    EmptyBonus = 4,
    LeafAtMost = 5,
    /// 0: exact; `u32::MAX`: by box; else exact from so many triangles on.
    Clipping = 6,
    Layout = 7,
    Collapse = 8,
    ByteWeight = 9,
    /// Occupancy and frequency, two f32; nothing without T-references.
    Hoisting = 10,
    HoistAlgorithm = 11,
    Splits = 12,
}

const TAGS: [Tag; 12] = [
    Tag::Preset,
    Tag::Traversal,
    Tag::Intersection,
    Tag::EmptyBonus,
    Tag::LeafAtMost,
    Tag::Clipping,
    Tag::Layout,
    Tag::Collapse,
    Tag::ByteWeight,
    Tag::Hoisting,
    Tag::HoistAlgorithm,
    Tag::Splits,
];

/// Options as bytes.
pub(super) fn put(options: &BuildOptions) -> Vec<u8> {
    // Without `..`, so that a new option must be thought of here.
    let BuildOptions {
        preset,
        sah: SahConstants { traversal, intersection, empty_bonus },
        leaf_at_most,
        clipping,
        layout,
        splits,
        hoisting,
        collapse,
        byte_weight,
        max_tree: _,
        max_build_bytes: _,
        threads: _,
    } = options;
    let mut out = Vec::new();
    let mut add = |tag: Tag, value: &[u8]| {
        out.extend([tag as u8, value.len() as u8]);
        out.extend_from_slice(value);
    };
    add(Tag::Preset, preset.name().as_bytes());
    add(Tag::Traversal, &traversal.to_le_bytes());
    add(Tag::Intersection, &intersection.to_le_bytes());
    add(Tag::EmptyBonus, &empty_bonus.to_le_bytes());
    add(Tag::LeafAtMost, &leaf_at_most.to_le_bytes());
    let clipping = match *clipping {
        Clipping::Exact => 0,
        Clipping::ExactFrom(least) => least.max(1),
        Clipping::Box => u32::MAX,
    };
    add(Tag::Clipping, &clipping.to_le_bytes());
    add(Tag::Layout, &[*layout as u8]);
    add(Tag::Collapse, &[u8::from(*collapse)]);
    add(Tag::ByteWeight, &byte_weight.to_le_bytes());
    match hoisting {
        None => add(Tag::Hoisting, &[]),
        Some(Hoisting { occupancy, frequency, algorithm }) => {
            add(Tag::Hoisting, [occupancy.to_le_bytes(), frequency.to_le_bytes()].as_flattened());
            add(Tag::HoistAlgorithm, &[*algorithm as u8]);
        }
    }
    add(Tag::Splits, &[*splits as u8]);
    out
}

/// What [`put`] wrote; `None` for what it never writes.
pub(super) fn get(mut block: &[u8]) -> Option<BuildOptions> {
    let mut values: [Option<&[u8]>; TAGS.len()] = [None; TAGS.len()];
    let mut last = 0;
    while let [tag, length, rest @ ..] = block {
        let at = TAGS.iter().position(|known| *known as u8 == *tag).filter(|_| *tag > last)?;
        last = *tag;
        let (value, behind) = rest.split_at_checked(usize::from(*length))?;
        (values[at], block) = (Some(value), behind);
    }
    if !block.is_empty() {
        return None;
    }
    let value = |tag: Tag| values[TAGS.iter().position(|known| *known == tag)?];
    let word = |tag: Tag| Some(u32::from_le_bytes(value(tag)?.try_into().ok()?));
    let float = |tag: Tag| word(tag).map(f32::from_bits);
    let byte = |tag: Tag| if let Some(&[byte]) = value(tag) { Some(byte) } else { None };
    let preset = std::str::from_utf8(value(Tag::Preset)?).ok()?.parse::<Preset>().ok()?;
    let hoisting = match (value(Tag::Hoisting), value(Tag::HoistAlgorithm)) {
        (Some([]), None) => None,
        (Some(&[a, b, c, d, e, f, g, h]), Some(&[algorithm])) => Some(Hoisting {
            occupancy: f32::from_le_bytes([a, b, c, d]),
            frequency: f32::from_le_bytes([e, f, g, h]),
            algorithm: match algorithm {
                0 => HoistAlgorithm::Strip,
                1 => HoistAlgorithm::Rebuild,
                _ => return None,
            },
        }),
        _ => return None,
    };
    let options = BuildOptions {
        preset,
        sah: SahConstants {
            traversal: float(Tag::Traversal)?,
            intersection: float(Tag::Intersection)?,
            empty_bonus: float(Tag::EmptyBonus)?,
        },
        leaf_at_most: word(Tag::LeafAtMost)?,
        clipping: match word(Tag::Clipping)? {
            0 => Clipping::Exact,
            u32::MAX => Clipping::Box,
            least => Clipping::ExactFrom(least),
        },
        layout: match byte(Tag::Layout)? {
            0 => Layout::FourByte,
            1 => Layout::TwoByte,
            2 => Layout::Dense,
            3 => Layout::Wide,
            _ => return None,
        },
        splits: match byte(Tag::Splits)? {
            0 => Splits::Both,
            1 => Splits::Space,
            _ => return None,
        },
        hoisting,
        collapse: match byte(Tag::Collapse)? {
            0 => false,
            1 => true,
            _ => return None,
        },
        byte_weight: float(Tag::ByteWeight)?,
        max_tree: None,
        max_build_bytes: None,
        threads: None,
    };
    options.validate().ok()?;
    Some(options)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Options that differ from their preset's in every field that a file keeps.
    fn unusual() -> Vec<BuildOptions> {
        let mut all = Vec::new();
        for &preset in Preset::ALL {
            for clipping in [Clipping::Exact, Clipping::ExactFrom(7), Clipping::Box] {
                for layout in [Layout::FourByte, Layout::TwoByte, Layout::Dense, Layout::Wide] {
                    for algorithm in [None, Some(HoistAlgorithm::Strip), Some(HoistAlgorithm::Rebuild)] {
                        let hoisting = algorithm.map(|algorithm| Hoisting {
                            occupancy: 0.125,
                            frequency: 0.625,
                            algorithm,
                        });
                        all.push(BuildOptions {
                            preset,
                            sah: SahConstants { traversal: 1.5, intersection: 2.5, empty_bonus: 0.75 },
                            leaf_at_most: 17,
                            clipping,
                            layout,
                            splits: if all.len() % 3 == 0 { Splits::Space } else { Splits::Both },
                            hoisting,
                            collapse: all.len() % 2 == 0,
                            byte_weight: 0.375,
                            max_tree: None,
                            max_build_bytes: None,
                            threads: None,
                        });
                    }
                }
            }
        }
        all
    }

    #[test]
    fn every_option_survives() {
        for options in unusual() {
            assert_eq!(get(&put(&options)), Some(options));
        }
    }

    #[test]
    fn what_is_never_written_is_refused() {
        let block = put(&BuildOptions::from(Preset::PaperFast));
        for at in 0..block.len() {
            assert_eq!(get(&block[..at]), None, "cut off at {at}");
        }
        let unknown = [&block[..], &[200, 1, 0]].concat();
        assert_eq!(get(&unknown), None, "an unknown tag");
        let twice = [&block[..], &[Tag::Splits as u8, 1, 0]].concat();
        assert_eq!(get(&twice), None, "a tag that comes twice");
    }
}
