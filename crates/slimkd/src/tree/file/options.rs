//! Build options as bytes: the preset's name, then 4-byte words. The thread count leaves no trace.

use crate::build::{BuildOptions, Clipping, Layout, Preset, Sweep};
use crate::reduce::{CountedLeaves, HoistAlgorithm, Hoisting, OccupancyBase, WhenLeafRemains};

/// Longest block, bytes: a name and 15 words are far below.
pub(super) const LIMIT: usize = 4096;

/// Options as bytes: the preset's name with its length, then 4-byte words.
pub(super) fn put(options: &BuildOptions) -> Vec<u8> {
    let name = options.preset.name().as_bytes();
    let mut out = vec![name.len() as u8];
    out.extend_from_slice(name);
    let sah = options.sah;
    let clipping = match options.clipping {
        Clipping::Exact => 0,
        Clipping::ExactFrom(least) => least.max(1),
        Clipping::Box => u32::MAX,
    };
    let mut words = vec![
        sah.traversal.to_bits(),
        sah.intersection.to_bits(),
        sah.empty_bonus.to_bits(),
        options.leaf_at_most,
        clipping,
        options.layout as u32,
        options.collapse.into(),
        options.byte_weight.to_bits(),
        options.hoisting.is_some().into(),
    ];
    if let Some(hoisting) = &options.hoisting {
        words.extend([
            hoisting.occupancy.to_bits(),
            hoisting.frequency.to_bits(),
            match hoisting.algorithm {
                HoistAlgorithm::Strip => 0,
                HoistAlgorithm::Rebuild => 1,
                HoistAlgorithm::Predict => 2,
            },
            (hoisting.occupancy_base == OccupancyBase::NodeArea).into(),
            (hoisting.leaves == CountedLeaves::NotEmpty).into(),
            (hoisting.when_leaf_remains == WhenLeafRemains::DropPick).into(),
        ]);
    }
    // Written only where it is not the usual one.
    if let Sweep::BinnedFrom(least) = options.sweep {
        words.push(least);
    }
    words.iter().for_each(|word| out.extend_from_slice(&word.to_le_bytes()));
    out
}

/// What [`put`] wrote; `None` for what it never writes.
pub(super) fn get(block: &[u8]) -> Option<BuildOptions> {
    let (&length, rest) = block.split_first()?;
    let (name, numbers) = rest.split_at_checked(length.into())?;
    let mut options = BuildOptions::from(Preset::from_name(std::str::from_utf8(name).ok()?)?);
    // Spent by the build; the byte weight says what came of it.
    options.max_tree = None;
    let (words, []) = numbers.as_chunks::<4>() else { return None };
    let words: Vec<u32> = words.iter().map(|&word| u32::from_le_bytes(word)).collect();
    let (
        &[
            traversal,
            intersection,
            empty_bonus,
            leaf_at_most,
            clipping,
            layout,
            collapse,
            byte_weight,
            hoists,
        ],
        rest,
    ) = words.split_first_chunk::<9>()?;
    // What is left behind the usual words.
    let usual = if hoists == 0 { 0 } else { 6 };
    let (rest, sweep) = rest.split_at_checked(usual)?;
    options.sweep = match sweep {
        [] => Sweep::Exact,
        &[least] => Sweep::BinnedFrom(least),
        _ => return None,
    };
    let choose = |word: u32| (word <= 1).then_some(word == 1);
    options.sah.traversal = f32::from_bits(traversal);
    options.sah.intersection = f32::from_bits(intersection);
    options.sah.empty_bonus = f32::from_bits(empty_bonus);
    options.leaf_at_most = leaf_at_most;
    options.clipping = match clipping {
        0 => Clipping::Exact,
        u32::MAX => Clipping::Box,
        least => Clipping::ExactFrom(least),
    };
    options.layout = match layout {
        0 => Layout::FourByte,
        1 => Layout::TwoByte,
        2 => Layout::Dense,
        _ => return None,
    };
    options.collapse = choose(collapse)?;
    options.byte_weight = f32::from_bits(byte_weight);
    options.hoisting = match (choose(hoists)?, rest) {
        (false, []) => None,
        (true, &[occupancy, frequency, algorithm, node_area, not_empty, drop_pick]) => {
            let mut hoisting = Hoisting::new(f32::from_bits(occupancy), f32::from_bits(frequency));
            hoisting.algorithm = match algorithm {
                0 => HoistAlgorithm::Strip,
                1 => HoistAlgorithm::Rebuild,
                2 => HoistAlgorithm::Predict,
                _ => return None,
            };
            if choose(node_area)? {
                hoisting.occupancy_base = OccupancyBase::NodeArea;
            }
            if choose(not_empty)? {
                hoisting.leaves = CountedLeaves::NotEmpty;
            }
            if choose(drop_pick)? {
                hoisting.when_leaf_remains = WhenLeafRemains::DropPick;
            }
            Some(hoisting)
        }
        _ => return None,
    };
    options.validate().ok()?;
    Some(options)
}
