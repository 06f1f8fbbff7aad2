//! Several scenes as one.

use crate::{Attribute, Scene};
use slimkd::{MeshError, TriangleMesh};
use std::sync::Arc;

/// A corner without that attribute.
const NONE: u32 = u32::MAX;

impl Scene {
    /// Puts scenes into one: triangles, vertices and materials of the first come first. Nothing is moved in the world or welded. The
    /// result has the first scene's name and its way up, and the first origin that is not 0; fails when there are more vertices or triangles than ids can name.
    ///
    /// ```
    /// use slimkd_scene::{Format, Scene, load_bytes};
    /// let one = load_bytes(Format::Obj, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")?;
    /// let both = Scene::merge(vec![one.clone(), one])?;
    /// assert_eq!(both.mesh.triangles(), [[0, 1, 2], [3, 4, 5]]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn merge(mut scenes: Vec<Self>) -> Result<Self, MeshError> {
        if scenes.len() < 2 {
            return Ok(scenes.pop().unwrap_or_default());
        }
        let origins = scenes.iter().map(|scene| scene.mesh.origin());
        let origin = origins.into_iter().find(|origin| *origin != [0.0; 3]).unwrap_or_default();
        let meshes: Vec<Arc<TriangleMesh>> = scenes.iter().map(|scene| Arc::clone(&scene.mesh)).collect();
        let mut vertices: Vec<[f32; 3]> = Vec::new();
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        let mut rounding = 0.0f64;
        for (mesh, scene) in meshes.iter().zip(&mut scenes) {
            // Where the sum is more than ids can name, `TriangleMesh::new` refuses it.
            let offset = u32::try_from(vertices.len()).unwrap_or(NONE);
            if mesh.origin() == origin {
                vertices.extend_from_slice(mesh.vertices());
                rounding = rounding.max(scene.rounding);
            } else {
                let (moved, by_rounding) = scene.move_to(origin);
                vertices.extend(moved);
                rounding = rounding.max(by_rounding);
            }
            triangles
                .extend(mesh.triangles().iter().map(|corners| corners.map(|c| c.saturating_add(offset))));
        }
        let mut whole = Self {
            name: scenes[0].name.clone(),
            rounding,
            up: scenes.iter().find_map(|scene| scene.up),
            normals: attribute(&meshes, scenes.iter_mut().map(|scene| scene.normals.take())),
            uvs: attribute(&meshes, scenes.iter_mut().map(|scene| scene.uvs.take())),
            colours: attribute(&meshes, scenes.iter_mut().map(|scene| scene.colours.take())),
            ..Self::default()
        };
        let has_colours = scenes.iter().any(|scene| !scene.face_colours.is_empty());
        let mut count = 0;
        for scene in scenes {
            let (materials, textures) = (whole.materials.len() as u32, whole.textures.len() as u32);
            count += scene.mesh.len();
            whole.materials.extend(scene.materials.into_iter().map(|mut material| {
                material.texture = material.texture.map(|texture| texture + textures);
                material
            }));
            whole.textures.extend(scene.textures);
            whole.material_ids.extend(scene.material_ids.iter().map(|id| id + materials));
            whole.material_ids.resize(count, materials);
            whole.face_colours.extend(scene.face_colours);
            if has_colours {
                whole.face_colours.resize(count, [255; 4]);
            }
            whole.cameras.extend(scene.cameras);
            whole.lights.extend(scene.lights);
            whole.warnings.extend(scene.warnings);
        }
        whole.mesh = Arc::new(TriangleMesh::new(vertices, triangles)?.with_origin(origin));
        Ok(whole)
    }
}

fn attribute<T>(
    meshes: &[Arc<TriangleMesh>],
    parts: impl Iterator<Item = Option<Attribute<T>>>,
) -> Option<Attribute<T>> {
    let parts: Vec<_> = parts.collect();
    if parts.iter().all(Option::is_none) {
        return None;
    }
    let mut whole = Attribute { values: Vec::new(), indices: None };
    let mut indices: Vec<[u32; 3]> = Vec::new();
    for (mesh, part) in meshes.iter().zip(parts) {
        let Some(part) = part else {
            indices.resize(indices.len() + mesh.len(), [NONE; 3]);
            continue;
        };
        let offset = u32::try_from(whole.values.len()).unwrap_or(NONE);
        let own = part.indices.as_deref().unwrap_or(mesh.triangles());
        indices.extend(own.iter().map(|corners| corners.map(|corner| corner.saturating_add(offset))));
        whole.values.extend(part.values);
    }
    whole.indices = Some(indices);
    Some(whole)
}
