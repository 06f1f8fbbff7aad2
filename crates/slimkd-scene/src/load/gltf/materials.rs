//! glTF's metallic-roughness materials to Whitted-style ones.

use super::{
    container::resource,
    json::{self, TextureInfo},
    reader::Reader,
};
use crate::{
    Material, Warning, WarningKind,
    load::{textures::Textures, warn},
};
use glam::{DAffine2, DVec2, Vec3};

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
            let texture = source.texture().and_then(|info| self.texture(info, textures, warnings));
            materials.push(Material { texture, ..convert(source) });
        }
        materials.push(Material { diffuse: Vec3::ONE, ..Default::default() });
        materials
    }

    fn texture(
        &self,
        info: &TextureInfo,
        textures: &mut Textures<'_>,
        warnings: &mut Vec<Warning>,
    ) -> Option<u32> {
        let index = info.index.0;
        let source = self.root.textures.get(index).and_then(json::Texture::image);
        let image = source.and_then(|source| Some((source, self.root.images.get(source)?)));
        let Some((source, image)) = image else {
            let what = format!("textures[{index}] names no image and was left out");
            warn(warnings, Warning::new(WarningKind::Missing, what));
            return None;
        };
        let folder = textures.folder;
        textures.get(&format!("images[{source}]"), warnings, || match (&image.uri, image.buffer_view) {
            (Some(uri), _) => resource(uri, folder),
            (None, Some(view)) => {
                self.view(view.0).map(|(bytes, _)| bytes.to_vec()).map_err(|error| error.to_string())
            }
            (None, None) => Err("it has neither uri nor bufferView".to_owned()),
        })
    }
}

fn convert(source: &json::Material) -> Material {
    let pbr = &source.pbr_metallic_roughness;
    let extensions = source.extensions.as_deref();
    let glossy = source.glossy();
    let [r, g, b, alpha] = glossy.map_or(pbr.base_color_factor, |glossy| glossy.diffuse_factor).map(share);
    let base = Vec3::new(r, g, b);
    let (metallic, roughness) = match glossy {
        Some(glossy) => (0.0, 1.0 - share(glossy.glossiness_factor)),
        None => (share(pbr.metallic_factor), share(pbr.roughness_factor)),
    };
    let smooth = 1.0 - roughness;
    // What a smooth surface mirrors, and how much of that is a mirror: only smooth metals are; rough ones look rather like
    // their diffuse colour.
    let mirrored = match glossy {
        Some(glossy) => Vec3::from(glossy.specular_factor.map(share)),
        None => Vec3::splat(DIELECTRIC).lerp(base, metallic),
    };
    let reflection = match glossy {
        // The specular colour of a metal is far above that of anything else.
        Some(_) => (mirrored.element_sum() / 3.0 - DIELECTRIC).max(0.0),
        None => metallic,
    };
    let alpha = if source.alpha_mode == "BLEND" { alpha } else { 1.0 };
    let glass = extensions.and_then(|extensions| extensions.transmission.as_ref());
    let glass = glass.map_or(0.0, |glass| share(glass.transmission_factor)) * (1.0 - metallic);
    let ior = extensions.and_then(|extensions| extensions.ior.as_ref()).map(|ior| ior.ior);
    let strength = extensions.and_then(|extensions| extensions.emission.as_ref());
    let strength = strength.map_or(1.0, |emission| emission.emissive_strength);
    let strength = if strength.is_finite() { strength.max(0.0) } else { 1.0 };
    Material {
        name: source.name.clone(),
        diffuse: base,
        texture: None,
        specular: mirrored * smooth,
        shininess: shininess(roughness),
        reflection: reflection * smooth * smooth,
        transmission: glass.max(1.0 - alpha),
        // Alpha blending does not bend light.
        ior: match ior {
            Some(ior) if ior.is_finite() => ior.clamp(1.0, 10.0),
            _ if glass > 0.0 => 1.5,
            _ if alpha < 1.0 => 1.0,
            _ => 1.5,
        },
        emission: Vec3::from(source.emissive_factor.map(share)) * strength,
    }
}

impl json::TextureTransform {
    /// As a map of texture coordinates, whose origin is the upper left corner.
    pub(super) fn map(&self) -> DAffine2 {
        // Counter-clockwise as seen, where v goes down; the README's lower left quadrant comes out so, its GLSL the other way.
        DAffine2::from_scale_angle_translation(
            DVec2::from(self.scale),
            -self.rotation,
            DVec2::from(self.offset),
        )
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
