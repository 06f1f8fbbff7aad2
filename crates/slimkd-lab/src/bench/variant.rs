//! Trees beside the presets: `NAME=PRESET[,KEY=VALUE]…`, for sweeps, ablations and the tuning of constants.

use anyhow::{Context, Result, bail, ensure};
use slimkd::{BuildOptions, Hoisting, Preset, TreeBudget};
use std::str::FromStr;

/// A named set of build options.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// What tables call it; `slimkd-` is put before it.
    pub name: String,
    /// The tree.
    pub options: BuildOptions,
}

impl From<Preset> for Variant {
    fn from(preset: Preset) -> Self {
        Self { name: preset.name().into(), options: preset.into() }
    }
}

impl FromStr for Variant {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let (name, rest) = text.split_once('=').context("expected NAME=PRESET[,KEY=VALUE]…")?;
        let mut words = rest.split(',');
        let preset: Preset =
            words.next().unwrap_or_default().parse().with_context(|| format!("in `{text}`"))?;
        let mut options = BuildOptions::from(preset);
        for word in words {
            let (key, value) = word.split_once('=').with_context(|| format!("`{word}` is not KEY=VALUE"))?;
            set(&mut options, key, value).with_context(|| format!("`{word}` in `{text}`"))?;
        }
        ensure!(!name.is_empty(), "the variant `{text}` has no name");
        Ok(Self { name: name.into(), options })
    }
}

fn set(options: &mut BuildOptions, key: &str, value: &str) -> Result<()> {
    match key {
        "traversal" => options.sah.traversal = value.parse()?,
        "intersection" => options.sah.intersection = value.parse()?,
        "empty-bonus" => options.sah.empty_bonus = value.parse()?,
        "leaf-at-most" => options.leaf_at_most = value.parse()?,
        "byte-weight" => {
            options.byte_weight = value.parse()?;
            options.collapse = true;
        }
        "collapse" => options.collapse = value.parse()?,
        "hoisting" => {
            options.hoisting = match value.split_once('/') {
                Some((occupancy, frequency)) => Some(Hoisting::new(occupancy.parse()?, frequency.parse()?)),
                None if value == "none" => None,
                None => bail!("expected OCCUPANCY/FREQUENCY or none"),
            }
        }
        "clipping" => options.clipping = value.parse()?,
        "layout" => options.layout = value.parse()?,
        "splits" => options.splits = value.parse()?,
        "per-triangle" => {
            options.max_tree = match value {
                "none" => None,
                bytes => Some(TreeBudget::BytesPerTriangle(bytes.parse()?)),
            }
        }
        _ => bail!(
            "no such key; there are traversal, intersection, empty-bonus, leaf-at-most, byte-weight, collapse, \
             hoisting, clipping, layout, splits, per-triangle"
        ),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use slimkd::{Layout, Splits};

    #[test]
    fn keys_change_the_preset() {
        let variant: Variant =
            "low=slim,intersection=9,byte-weight=0.2,layout=two-byte,per-triangle=none".parse().unwrap();
        assert_eq!(variant.name, "low");
        assert_eq!((variant.options.sah.intersection, variant.options.byte_weight), (9.0, 0.2));
        assert_eq!((variant.options.layout, variant.options.max_tree), (Layout::TwoByte, None));
        let cells: Variant = "cells=slim,layout=wide,splits=space".parse().unwrap();
        assert_eq!((cells.options.layout, cells.options.splits), (Layout::Wide, Splits::Space));
        let hoisted: Variant = "h=standard,hoisting=0.5/0.4,collapse=true".parse().unwrap();
        assert_eq!(hoisted.options.hoisting, Some(Hoisting::new(0.5, 0.4)));
        assert!(hoisted.options.collapse);
    }

    #[test]
    fn nonsense_is_refused() {
        for wrong in
            ["slim", "a=small", "a=slim,k", "a=slim,k=1", "a=slim,layout=flat", "=slim", "a=slim,traversal=x"]
        {
            assert!(wrong.parse::<Variant>().is_err(), "{wrong}");
        }
    }
}
