//! Which of a PLY's properties mean what.

use super::header::{Element, Property};

/// x y z, nx ny nz, u v.
pub(super) const SLOTS: usize = 8;

/// For each property of the vertex element the slot that it fills.
pub(super) struct Slots(pub(super) Vec<Option<usize>>);

impl Slots {
    pub(super) fn of(element: &Element) -> Self {
        // Texture coordinates go by several names: s t of Blender, u v, texture_u texture_v of MeshLab.
        let slot = |property: &Property| match property.name.as_str() {
            _ if property.length.is_some() => None,
            "x" => Some(0),
            "y" => Some(1),
            "z" => Some(2),
            "nx" => Some(3),
            "ny" => Some(4),
            "nz" => Some(5),
            "s" | "u" | "texture_u" => Some(6),
            "t" | "v" | "texture_v" => Some(7),
            _ => None,
        };
        Self(element.properties.iter().map(slot).collect())
    }

    /// True when all of these slots are filled.
    pub(super) fn has(&self, mut slots: std::ops::Range<usize>) -> bool {
        slots.all(|slot| self.0.contains(&Some(slot)))
    }
}

/// What the vertex element holds.
#[derive(Default)]
pub(super) struct VertexColumns {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) has_normals: bool,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) has_uvs: bool,
    pub(super) uvs: Vec<[f32; 2]>,
}

/// The face property that lists the corners.
pub(super) fn corner_list(element: &Element) -> Option<usize> {
    element.properties.iter().position(|property| {
        property.length.is_some() && matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
    })
}
