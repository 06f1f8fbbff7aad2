//! glTF accessors: typed views into buffers (glTF 2.0, section 3.6.2), sparse and quantised ones too.
//!
//! Deviation: INT (5124) and DOUBLE (5130) of drafts are read as well.

use super::reader::{DAMAGED, Reader};
use crate::load::{LoadError, Place, error::quoted};

/// The type of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn of(component_type: usize) -> Option<Self> {
        Some(match component_type {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5124 => Self::I32,
            5125 => Self::U32,
            5126 => Self::F32,
            5130 => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The component at the start of `raw`, which holds at least its size. `f64` holds each type exactly.
    pub(super) fn value(self, raw: &[u8], normalized: bool) -> f64 {
        let word = || [raw[0], raw[1], raw[2], raw[3]];
        let (value, range) = match self {
            Self::I8 => (f64::from(raw[0] as i8), 127.0),
            Self::U8 => (f64::from(raw[0]), 255.0),
            Self::I16 => (f64::from(i16::from_le_bytes([raw[0], raw[1]])), 32_767.0),
            Self::U16 => (f64::from(u16::from_le_bytes([raw[0], raw[1]])), 65_535.0),
            Self::I32 => (f64::from(i32::from_le_bytes(word())), f64::from(i32::MAX)),
            Self::U32 => (f64::from(u32::from_le_bytes(word())), f64::from(u32::MAX)),
            Self::F32 => return f64::from(f32::from_le_bytes(word())),
            Self::F64 => {
                return f64::from_le_bytes([raw[0], raw[1], raw[2], raw[3], raw[4], raw[5], raw[6], raw[7]]);
            }
        };
        if normalized { (value / range).max(-1.0) } else { value }
    }
}

fn components(kind: &str) -> Option<usize> {
    Some(match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => return None,
    })
}

/// Entries of equal size at equal distances.
struct Entries<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Entries<'a> {
    fn get(&self, index: usize) -> &'a [u8] {
        &self.bytes[index * self.stride..][..self.size]
    }
}

impl Reader<'_> {
    /// How many entries an accessor says that it has.
    pub(super) fn count(&self, index: usize) -> Result<u64, LoadError> {
        let accessor = self.root.accessors.get(index);
        let there = accessor.map(|accessor| accessor.count.0 as u64);
        there.ok_or_else(|| self.invalid(Place::Entry("accessors", index), "there is none", DAMAGED))
    }

    /// The largest index that an accessor's components can hold.
    pub(super) fn largest_index(&self, index: usize) -> Option<u32> {
        match Number::of(self.root.accessors.get(index)?.component_type.0)? {
            Number::U8 => Some(u32::from(u8::MAX)),
            Number::U16 => Some(u32::from(u16::MAX)),
            Number::U32 => Some(u32::MAX),
            _ => None,
        }
    }

    /// How many components each entry has.
    pub(super) fn width(&self, index: usize) -> usize {
        self.root.accessors.get(index).and_then(|accessor| components(&accessor.kind)).unwrap_or(0)
    }

    /// Calls `each` with the components of every entry. Entries must have `N` components at least. The caller has checked
    /// the count against a budget: an accessor without a view is zeros that take no bytes.
    pub(super) fn read<const N: usize, T>(
        &self,
        index: usize,
        each: impl Fn([f64; N]) -> T,
    ) -> Result<Vec<T>, LoadError> {
        let place = Place::Entry("accessors", index);
        let wrong = |what: String| self.invalid(place, what, DAMAGED);
        let count = self.count(index)?;
        let accessor = &self.root.accessors[index];
        let kind = quoted(accessor.kind.as_bytes());
        let width = components(&accessor.kind).ok_or_else(|| wrong(format!("an unknown type {kind}")))?;
        let number = Number::of(accessor.component_type.0)
            .ok_or_else(|| wrong(format!("an unknown componentType {}", accessor.component_type.0)))?;
        if width < N {
            return Err(wrong(format!("{kind} where {N} components are needed")));
        }
        let value = |raw: &[u8]| -> T {
            each(std::array::from_fn(|k| number.value(&raw[k * number.size()..], accessor.normalized)))
        };
        let entry = width * number.size();
        let mut out: Vec<T> = Vec::new();
        match accessor.buffer_view {
            Some(view) => {
                let entries = self.entries(place, view.0, accessor.byte_offset.0, count, entry)?;
                out.extend((0..count as usize).map(|k| value(entries.get(k))));
            }
            None => {
                let taken = usize::try_from(count).map_err(|_| wrong("too many entries".into()))?;
                out.try_reserve_exact(taken).map_err(|error| wrong(error.to_string()))?;
                out.extend((0..count).map(|_| each([0.0; N])));
            }
        }
        if let Some(sparse) = &accessor.sparse {
            let (at, changed) = (&sparse.indices, sparse.count.0 as u64);
            let index_type = Number::of(at.component_type.0)
                .ok_or_else(|| wrong(format!("an unknown componentType {}", at.component_type.0)))?;
            let indices =
                self.entries(place, at.buffer_view.0, at.byte_offset.0, changed, index_type.size())?;
            let values = &sparse.values;
            let values = self.entries(place, values.buffer_view.0, values.byte_offset.0, changed, entry)?;
            for k in 0..changed as usize {
                let target = index_type.value(indices.get(k), false) as usize;
                let slot = out.get_mut(target);
                *slot.ok_or_else(|| wrong(format!("sparse index {target} of {count} entries")))? =
                    value(values.get(k));
            }
        }
        Ok(out)
    }

    fn entries(
        &self,
        place: Place,
        view: usize,
        offset: usize,
        count: u64,
        size: usize,
    ) -> Result<Entries<'_>, LoadError> {
        let (bytes, stride) = self.view(view)?;
        // Some exporters write a stride of 0 for "none".
        let stride = stride.filter(|&stride| stride > 0).unwrap_or(size);
        let needed = || match count {
            0 => Some(offset as u64),
            _ => (count - 1).checked_mul(stride as u64)?.checked_add(size as u64)?.checked_add(offset as u64),
        };
        if stride < size || needed().is_none_or(|needed| needed > bytes.len() as u64) {
            let there = bytes.len();
            let what = format!(
                "{count} entries of {size} bytes, {stride} apart, from byte {offset} on are not in the {there} bytes \
                 of bufferViews[{view}]"
            );
            return Err(self.invalid(place, what, DAMAGED));
        }
        Ok(Entries { bytes: &bytes[offset..], stride, size })
    }
}
