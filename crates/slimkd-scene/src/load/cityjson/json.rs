//! What is read of a CityJSON text; all else is passed over.

use serde::{
    Deserialize, Deserializer,
    de::{DeserializeSeed, Error, IgnoredAny, MapAccess, SeqAccess, Visitor},
};
use std::{borrow::Cow, fmt};

/// Lists within lists; a solid of solids has five.
const MAX_DEPTH: usize = 8;

/// A CityJSON object, or a feature of a sequence.
#[derive(Deserialize)]
pub(super) struct Root<'a> {
    #[serde(rename = "type", default, borrow)]
    pub(super) kind: Cow<'a, str>,
    #[serde(default)]
    pub(super) transform: Option<Transform>,
    #[serde(rename = "CityObjects", default, borrow)]
    pub(super) objects: Objects<'a>,
    #[serde(default)]
    pub(super) vertices: Vec<[f64; 3]>,
    #[serde(default, borrow)]
    pub(super) appearance: Option<Appearance<'a>>,
    #[serde(rename = "geometry-templates", default, borrow)]
    pub(super) templates: Option<Templates<'a>>,
}

#[derive(Clone, Copy, Deserialize)]
pub(super) struct Transform {
    pub(super) scale: [f64; 3],
    pub(super) translate: [f64; 3],
}

#[derive(Deserialize)]
pub(super) struct Templates<'a> {
    #[serde(default, borrow)]
    pub(super) templates: Vec<Geometry<'a>>,
    #[serde(rename = "vertices-templates", default)]
    pub(super) vertices: Vec<[f64; 3]>,
}

#[derive(Deserialize)]
pub(super) struct Appearance<'a> {
    #[serde(default, borrow)]
    pub(super) materials: Vec<Material<'a>>,
    #[serde(default)]
    pub(super) textures: Vec<IgnoredAny>,
}

#[derive(Deserialize)]
pub(super) struct Material<'a> {
    #[serde(default, borrow)]
    pub(super) name: Cow<'a, str>,
    #[serde(rename = "diffuseColor", default)]
    pub(super) diffuse: Option<[f32; 3]>,
    #[serde(rename = "emissiveColor", default)]
    pub(super) emissive: Option<[f32; 3]>,
    #[serde(default)]
    pub(super) transparency: Option<f32>,
}

/// The objects in the order of the file.
#[derive(Default)]
pub(super) struct Objects<'a>(pub(super) Vec<(Cow<'a, str>, CityObject<'a>)>);

#[derive(Deserialize)]
pub(super) struct CityObject<'a> {
    #[serde(rename = "type", default, borrow)]
    pub(super) kind: Cow<'a, str>,
    #[serde(default, borrow)]
    pub(super) geometry: Option<Vec<Geometry<'a>>>,
}

#[derive(Deserialize)]
pub(super) struct Geometry<'a> {
    #[serde(rename = "type", default, borrow)]
    pub(super) kind: Cow<'a, str>,
    #[serde(default)]
    pub(super) lod: Lod,
    #[serde(default)]
    pub(super) boundaries: Nested,
    #[serde(default, borrow)]
    pub(super) semantics: Option<Semantics<'a>>,
    #[serde(default)]
    pub(super) material: Option<Themes>,
    #[serde(default)]
    pub(super) template: Option<usize>,
    #[serde(rename = "transformationMatrix", default)]
    pub(super) matrix: Option<[f64; 16]>,
}

#[derive(Deserialize)]
pub(super) struct Semantics<'a> {
    #[serde(default, borrow)]
    pub(super) surfaces: Vec<Surface<'a>>,
    #[serde(default)]
    pub(super) values: Nested,
}

#[derive(Deserialize)]
pub(super) struct Surface<'a> {
    #[serde(rename = "type", default, borrow)]
    pub(super) kind: Cow<'a, str>,
}

/// The first theme of materials.
#[derive(Default)]
pub(super) struct Themes(pub(super) Option<Theme>);

#[derive(Default, Deserialize)]
pub(super) struct Theme {
    #[serde(default)]
    pub(super) value: Option<usize>,
    #[serde(default)]
    pub(super) values: Nested,
}

/// A level of detail: `"2.2"`, or 2 as in version 1.0; nothing counts as 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(super) struct Lod(pub(super) f64);

impl<'de> Deserialize<'de> for Lod {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Any<'a> {
            Number(f64),
            #[serde(borrow)]
            Text(Cow<'a, str>),
            Other(IgnoredAny),
        }
        let lod = match Any::deserialize(deserializer)? {
            Any::Number(number) => number,
            Any::Text(text) => text.trim().parse().unwrap_or(0.0),
            Any::Other(_) => 0.0,
        };
        Ok(Self(if lod.is_finite() { lod } else { 0.0 }))
    }
}

impl<'de: 'a, 'a> Deserialize<'de> for Objects<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Objects<'de>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("city objects by their names")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut objects = Vec::new();
                while let Some(entry) = map.next_entry::<Key<'de>, CityObject<'de>>()? {
                    objects.push((entry.0.0, entry.1));
                }
                Ok(Objects(objects))
            }
        }
        #[derive(Deserialize)]
        struct Key<'a>(#[serde(borrow)] Cow<'a, str>);
        deserializer.deserialize_map(InOrder)
    }
}

impl<'de> Deserialize<'de> for Themes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct First;
        impl<'de> Visitor<'de> for First {
            type Value = Themes;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("materials by their themes")
            }
            fn visit_unit<E: Error>(self) -> Result<Themes, E> {
                Ok(Themes(None))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Themes, A::Error> {
                let first = map.next_entry::<IgnoredAny, Theme>()?;
                while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
                Ok(Themes(first.map(|(_, theme)| theme)))
            }
        }
        deserializer.deserialize_any(First)
    }
}

/// No index.
pub(super) const NONE: u32 = u32::MAX;

/// Lists of lists of indices, flat: `ends[d]` says where each list at depth d ends among those at d + 1, or among the values.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Nested {
    pub(super) values: Vec<u32>,
    pub(super) ends: Vec<Vec<u32>>,
    /// Depth at which values stand; 0 while there are none.
    depth: usize,
}

impl Nested {
    /// The range of list `index` at depth `depth`.
    pub(super) fn range(&self, depth: usize, index: usize) -> std::ops::Range<usize> {
        let ends = &self.ends[depth];
        let start = if index == 0 { 0 } else { ends[index - 1] as usize };
        start..ends[index] as usize
    }

    /// How many lists enclose each other around a value.
    pub(super) fn depth(&self) -> usize {
        self.depth
    }

    /// How many lists there are at a depth.
    pub(super) fn count(&self, depth: usize) -> usize {
        self.ends.get(depth).map_or(0, Vec::len)
    }
}

impl<'de> Deserialize<'de> for Nested {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut nested = Self::default();
        Level { nested: &mut nested, depth: 0 }.deserialize(deserializer)?;
        Ok(nested)
    }
}

/// One value or list at that depth.
struct Level<'a> {
    nested: &'a mut Nested,
    depth: usize,
}

impl<'de> DeserializeSeed<'de> for Level<'_> {
    type Value = ();
    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl Level<'_> {
    fn value<E: Error>(self, value: u32) -> Result<(), E> {
        let Nested { values, ends, depth } = self.nested;
        if *depth == 0 {
            *depth = self.depth;
        }
        if self.depth != *depth || ends.len() > self.depth {
            return Err(E::custom("numbers stand beside lists"));
        }
        values.push(value);
        Ok(())
    }
}

impl<'de> Visitor<'de> for Level<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("lists of indices")
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<(), E> {
        let index = u32::try_from(value).ok().filter(|&index| index != NONE);
        let index = index.ok_or_else(|| E::custom(format!("{value} is no index")))?;
        self.value(index)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<(), E> {
        // Some programs write whole numbers as 3.0.
        if value.fract() == 0.0 && (0.0..f64::from(NONE)).contains(&value) {
            return self.value(value as u32);
        }
        Err(E::custom(format!("{value} is no index")))
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        // Nothing instead of a list stands for all that it would hold; those who ask find that the counts differ.
        if self.depth > 0 && (self.nested.depth == 0 || self.depth == self.nested.depth) {
            self.nested.values.push(NONE);
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let Self { nested, depth } = self;
        if depth >= MAX_DEPTH {
            return Err(A::Error::custom("lists are nested too deep"));
        }
        if nested.ends.len() <= depth {
            nested.ends.resize_with(depth + 1, Vec::new);
        }
        if nested.depth != 0 && depth >= nested.depth {
            return Err(A::Error::custom("lists stand beside numbers"));
        }
        while list.next_element_seed(Level { nested, depth: depth + 1 })?.is_some() {}
        let end = nested.ends.get(depth + 1).map_or(nested.values.len(), Vec::len);
        nested.ends[depth].push(end as u32);
        Ok(())
    }
}
