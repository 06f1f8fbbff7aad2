//! glTF accessors: typed views into buffers (glTF 2.0, section 3.6.2), sparse and quantised ones too.

use super::Reader;
use crate::load::{LoadError, Place};
use gltf::json::{
    accessor::{ComponentType, Type},
    validation::Checked,
};

const DAMAGED: &str = "the file is damaged: export or download it again";

fn size(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

fn components(kind: Type) -> usize {
    match kind {
        Type::Scalar => 1,
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        Type::Vec4 | Type::Mat2 => 4,
        Type::Mat3 => 9,
        Type::Mat4 => 16,
    }
}

/// The component at the start of `raw`, which holds at least its size. `f64` holds each type exactly.
fn component(raw: &[u8], kind: ComponentType, normalized: bool) -> f64 {
    let (value, range) = match kind {
        ComponentType::I8 => (f64::from(raw[0] as i8), 127.0),
        ComponentType::U8 => (f64::from(raw[0]), 255.0),
        ComponentType::I16 => (f64::from(i16::from_le_bytes([raw[0], raw[1]])), 32_767.0),
        ComponentType::U16 => (f64::from(u16::from_le_bytes([raw[0], raw[1]])), 65_535.0),
        ComponentType::U32 => (f64::from(u32::from_le_bytes([raw[0], raw[1], raw[2], raw[3]])), 1.0),
        ComponentType::F32 => (f64::from(f32::from_le_bytes([raw[0], raw[1], raw[2], raw[3]])), 1.0),
    };
    if normalized { (value / range).max(-1.0) } else { value }
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
        let there = accessor.map(|accessor| accessor.count.0);
        there.ok_or_else(|| self.invalid(Place::Entry("accessors", index), "there is none", DAMAGED))
    }

    /// Calls `each` with the number and the components of every entry. Entries must have `N` components at least.
    pub(super) fn read<const N: usize, T>(
        &self,
        index: usize,
        each: impl Fn([f64; N]) -> T,
    ) -> Result<Vec<T>, LoadError> {
        let place = Place::Entry("accessors", index);
        let wrong = |what: String| self.invalid(place, what, DAMAGED);
        let count = self.count(index)?;
        let accessor = &self.root.accessors[index];
        let (Checked::Valid(kind), Checked::Valid(number)) = (&accessor.type_, &accessor.component_type)
        else {
            return Err(wrong("an unknown type".into()));
        };
        let number = number.0;
        if components(*kind) < N {
            return Err(wrong(format!("{kind:?} where {N} components are needed")));
        }
        let value = |raw: &[u8]| -> T {
            each(std::array::from_fn(|k| component(&raw[k * size(number)..], number, accessor.normalized)))
        };
        let entry = components(*kind) * size(number);
        let mut out: Vec<T> = Vec::new();
        match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                let entries = self.entries(place, view.value(), offset, count, entry)?;
                out.extend((0..count as usize).map(|k| value(entries.get(k))));
            }
            None if accessor.sparse.is_none() => return Err(wrong("it has no bufferView".into())),
            // All 0, but for the sparse entries. The caller has checked the count against the budget.
            None => out.extend((0..count).map(|_| each([0.0; N]))),
        }
        if let Some(sparse) = &accessor.sparse {
            let Checked::Valid(index_type) = &sparse.indices.component_type else {
                return Err(wrong("an unknown type of sparse index".into()));
            };
            let index_type = index_type.0;
            let (at, changed) = (&sparse.indices, sparse.count.0);
            let view = at.buffer_view.value();
            let indices = self.entries(place, view, at.byte_offset.0, changed, size(index_type))?;
            let view = sparse.values.buffer_view.value();
            let values = self.entries(place, view, sparse.values.byte_offset.0, changed, entry)?;
            for k in 0..changed as usize {
                let target = component(indices.get(k), index_type, false) as usize;
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
        offset: u64,
        count: u64,
        size: usize,
    ) -> Result<Entries<'_>, LoadError> {
        let (bytes, stride) = self.view(view)?;
        let stride = stride.unwrap_or(size);
        let needed = || match count {
            0 => Some(offset),
            _ => (count - 1).checked_mul(stride as u64)?.checked_add(size as u64)?.checked_add(offset),
        };
        if stride < size || needed().is_none_or(|needed| needed > bytes.len() as u64) {
            let there = bytes.len();
            let what = format!(
                "{count} entries of {size} bytes, {stride} apart, from byte {offset} on are not in the {there} bytes \
                 of bufferViews[{view}]"
            );
            return Err(self.invalid(place, what, DAMAGED));
        }
        Ok(Entries { bytes: &bytes[offset as usize..], stride, size })
    }
}
