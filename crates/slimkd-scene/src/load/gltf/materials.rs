//! glTF's metallic-roughness materials to Whitted-style ones.

use super::{Reader, container::resource};
use crate::{
    Material, Warning, WarningKind,
    load::{textures::Textures, warn},
};
use glam::Vec3;
use gltf::json::{material::AlphaMode, texture::Info, validation::Checked};

/// Reflectance of dielectrics at normal incidence (glTF 2.0, appendix B.2.1), for an index of 1.5.
const DIELECTRIC: f32 = 0.04;

impl Reader<'_> {
    /// All materials of the file, in order, then a plain one for primitives without.
    pub(super) fn materials(
        &self,
        textures: &mut Textures<'_>,
        warnings: &mut Vec<Warning>,
    ) -> Vec<Material> {
        let mut materials = Vec::with_capacity(self.root.materials.len() + 1);
        for source in &self.root.materials {
            let pbr = &source.pbr_metallic_roughness;
            let extensions = source.extensions.as_ref();
            let [r, g, b, alpha] = pbr.base_color_factor.0.map(share);
            let base = Vec3::new(r, g, b);
            let (metallic, roughness) = (share(pbr.metallic_factor.0), share(pbr.roughness_factor.0));
            let smooth = 1.0 - roughness;
            let alpha = match source.alpha_mode {
                Checked::Valid(AlphaMode::Blend) => alpha,
                _ => 1.0,
            };
            let glass = extensions.and_then(|extensions| extensions.transmission.as_ref());
            let glass = glass.map_or(0.0, |glass| share(glass.transmission_factor.0)) * (1.0 - metallic);
            let ior = extensions.and_then(|extensions| extensions.ior.as_ref()).map(|ior| ior.ior.0);
            materials.push(Material {
                name: source.name.clone().unwrap_or_default(),
                diffuse: base,
                texture: pbr
                    .base_color_texture
                    .as_ref()
                    .and_then(|info| self.texture(info, textures, warnings)),
                specular: Vec3::splat(DIELECTRIC).lerp(base, metallic) * smooth,
                shininess: shininess(roughness),
                // Only smooth metals are mirrors; rough ones look rather like their diffuse colour.
                reflection: metallic * smooth * smooth,
                transmission: glass.max(1.0 - alpha),
                // Alpha blending does not bend light.
                ior: match ior {
                    Some(ior) if ior.is_finite() => ior.clamp(1.0, 10.0),
                    _ if glass > 0.0 => 1.5,
                    _ if alpha < 1.0 => 1.0,
                    _ => 1.5,
                },
                emission: Vec3::from(source.emissive_factor.0.map(share)),
            });
        }
        materials.push(Material { diffuse: Vec3::ONE, ..Default::default() });
        materials
    }

    fn texture(&self, info: &Info, textures: &mut Textures<'_>, warnings: &mut Vec<Warning>) -> Option<u32> {
        let source = self.root.textures.get(info.index.value()).map(|texture| texture.source.value());
        let image = source.and_then(|source| Some((source, self.root.images.get(source)?)));
        let Some((source, image)) = image else {
            let what = format!("textures[{}] names no image and was left out", info.index.value());
            warn(warnings, Warning::new(WarningKind::Missing, what));
            return None;
        };
        let folder = textures.folder;
        textures.get(&format!("images[{source}]"), warnings, || match (&image.uri, image.buffer_view) {
            (Some(uri), _) => resource(uri, folder),
            (None, Some(view)) => {
                self.view(view.value()).map(|(bytes, _)| bytes.to_vec()).map_err(|error| error.to_string())
            }
            (None, None) => Err("it has neither uri nor bufferView".to_owned()),
        })
    }
}

/// The Blinn-Phong exponent of a GGX roughness: 2 / α² − 2 with α the roughness squared (Karis 2013).
fn shininess(roughness: f32) -> f32 {
    let alpha = (roughness * roughness).max(0.01);
    (2.0 / (alpha * alpha) - 2.0).clamp(1.0, 1e4)
}

fn share(value: f32) -> f32 {
    if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
}
