//! A scene: a mesh and what is needed to make a picture of it.

use crate::{Camera, Light, Material, Texture, UpAxis, Warning};
use slimkd::TriangleMesh;
use std::sync::Arc;

/// A value per vertex, or per corner through its own indices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribute<T> {
    /// The values.
    pub values: Vec<T>,
    /// Per triangle the three values' indices; `None`: the mesh's own vertex indices. An index of `u32::MAX` in the
    /// first corner means that this triangle has no such attribute.
    pub indices: Option<Vec<[u32; 3]>>,
}

impl<T: Copy> Attribute<T> {
    /// The values at the three corners of triangle `id`, in the order that [`slimkd::Hit::interpolate`] takes. `corners` are its vertex
    /// indices, from [`TriangleMesh::triangles`] or [`slimkd::OpenTree::triangle`]. `None` where the triangle has no such attribute.
    ///
    /// # Panics
    /// When the attribute has indices of its own and none for this id.
    pub fn corners(&self, id: u32, corners: [u32; 3]) -> Option<[T; 3]> {
        let index = self.indices.as_ref().map_or(corners, |indices| indices[id as usize]);
        let value = |k: usize| self.values.get(index[k] as usize).copied();
        Some([value(0)?, value(1)?, value(2)?])
    }
}

/// Everything that a scene file may say. Only the mesh is certain to be there.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// File stem, or the built-in scene's name.
    pub name: String,
    /// The geometry; triangle ids are positions in it. Its coordinates count from its [origin](TriangleMesh::origin), as do those of cameras and
    /// lights.
    pub mesh: Arc<TriangleMesh>,
    /// Where the mesh has an origin: no vertex was moved farther than this by rounding to f32, scene units.
    pub rounding: f64,
    /// At least one material once the scene is complete.
    pub materials: Vec<Material>,
    /// Material of each triangle; empty: material 0 for all.
    pub material_ids: Vec<u32>,
    /// Shading normals.
    pub normals: Option<Attribute<[f32; 3]>>,
    /// Texture coordinates.
    pub uvs: Option<Attribute<[f32; 2]>>,
    /// Colours of vertices or corners: sRGB and opacity, 0 to 255. The renderer does not show them yet.
    pub colours: Option<Attribute<[u8; 4]>>,
    /// Colour of each triangle, from formats that colour faces; empty: none has one.
    pub face_colours: Vec<[u8; 4]>,
    /// Textures that materials refer to.
    pub textures: Vec<Texture>,
    /// Views that the file names; may be empty.
    pub cameras: Vec<Camera>,
    /// Lights that the file names; may be empty.
    pub lights: Vec<Light>,
    /// Which way is up; `None` when the format does not say.
    pub up: Option<UpAxis>,
    /// What a file's loader left out, replaced or found odd: missing textures and the like.
    pub warnings: Vec<Warning>,
}

impl Scene {
    /// The material of triangle `id`.
    pub fn material(&self, id: u32) -> &Material {
        let material = self.material_ids.get(id as usize).copied().unwrap_or(0);
        &self.materials[material as usize]
    }
}
