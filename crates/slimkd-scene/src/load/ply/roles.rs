//! Which of a PLY's properties mean what.

use super::header::{Element, Number, Property};

/// x y z, nx ny nz, u v, red green blue alpha.
pub(super) const SLOTS: usize = 12;

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
            name => colour_slot(name).map(|slot| 8 + slot),
        };
        Self(element.properties.iter().map(slot).collect())
    }

    /// True when all of these slots are filled.
    pub(super) fn has(&self, mut slots: std::ops::Range<usize>) -> bool {
        slots.all(|slot| self.0.contains(&Some(slot)))
    }
}

/// Red 0, green 1, blue 2, opacity 3.
pub(super) fn colour_slot(name: &str) -> Option<usize> {
    match name {
        "red" | "r" | "diffuse_red" => Some(0),
        "green" | "g" | "diffuse_green" => Some(1),
        "blue" | "b" | "diffuse_blue" => Some(2),
        "alpha" | "a" | "diffuse_alpha" => Some(3),
        _ => None,
    }
}

/// A colour's share as a byte; integers go to their type's greatest value, the others to 1.
pub(super) fn colour_byte(value: f64, number: Number) -> u8 {
    let scale = match number {
        Number::U8 | Number::I8 => 1.0,
        Number::U16 => 1.0 / 257.0,
        Number::F32 | Number::F64 => 255.0,
        // Wider integers are bytes that a program wrote wastefully.
        _ => 1.0,
    };
    (value * scale).round() as u8
}

/// What the vertex element holds.
#[derive(Default)]
pub(super) struct VertexColumns {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) has_normals: bool,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) has_uvs: bool,
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) has_colours: bool,
    pub(super) colours: Vec<[u8; 4]>,
}

/// The face property that lists the corners' texture coordinates, two numbers a corner.
pub(super) fn corner_uvs(element: &Element) -> Option<usize> {
    element.properties.iter().position(|property| property.length.is_some() && property.name == "texcoord")
}

/// The face property that lists the corners.
pub(super) fn corner_list(element: &Element) -> Option<usize> {
    element.properties.iter().position(|property| {
        property.length.is_some() && matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
    })
}
