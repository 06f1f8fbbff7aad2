//! MTL materials to ours.

use super::super::{error::quoted, text, textures::Textures, warn};
use crate::{Material, Warning, WarningKind};
use glam::Vec3;
use std::collections::HashMap;

/// The materials of MTL files by name; a name's first definition counts.
#[derive(Default)]
pub(super) struct Library(HashMap<String, tobj::Material>);

impl Library {
    /// Adds what `bytes` define. One broken material costs itself, not the file.
    pub(super) fn add(&mut self, file: &str, bytes: &[u8], warnings: &mut Vec<Warning>) {
        let text = String::from_utf8_lossy(bytes);
        let mut chunk = String::new();
        let mut define = |chunk: &str| match tobj::load_mtl_buf(&mut chunk.as_bytes()) {
            Ok((materials, _)) => {
                for material in materials {
                    self.0.entry(material.name.clone()).or_insert(material);
                }
            }
            Err(error) => {
                let start = chunk.lines().next().unwrap_or_default();
                let (start, file) = (quoted(start.as_bytes()), quoted(file.as_bytes()));
                let what = format!("{start} in {file} was left out: {error}");
                warn(warnings, Warning::new(WarningKind::Invalid, what));
            }
        };
        for line in text.lines() {
            if line.split_whitespace().next() == Some("newmtl") {
                define(&chunk);
                chunk.clear();
            }
            chunk.push_str(line);
            chunk.push('\n');
        }
        define(&chunk);
    }

    /// The named material, or a plain one with a warning.
    pub(super) fn material(
        &self,
        name: &str,
        textures: &mut Textures<'_>,
        warnings: &mut Vec<Warning>,
    ) -> Material {
        let Some(source) = self.0.get(name) else {
            let quoted = quoted(name.as_bytes());
            let what = format!("material {quoted} is in no MTL file; a plain one stands in");
            warn(warnings, Warning::new(WarningKind::Missing, what));
            return Material { name: name.to_owned(), ..Default::default() };
        };
        convert(source, textures, warnings)
    }
}

fn convert(source: &tobj::Material, textures: &mut Textures<'_>, warnings: &mut Vec<Warning>) -> Material {
    let colour = |value: [f32; 3]| Vec3::from(value.map(share));
    let other = |name: &str| source.unknown_param.get(name).map(|value| text::words(value.as_bytes()));
    let mut material = Material {
        name: source.name.clone(),
        specular: source.specular.map_or(Vec3::ZERO, colour),
        // Exponents below 1 are no Blinn-Phong, and a mirror's highlight needs no more than 10⁴.
        shininess: finite(source.shininess).unwrap_or(32.0).clamp(1.0, 1e4),
        ior: finite(source.optical_density).filter(|ior| *ior >= 1.0).unwrap_or(1.0).min(10.0),
        emission: source.emissive.map_or(Vec3::ZERO, |value| Vec3::from(value.map(positive))),
        ..Default::default()
    };
    if let Some(diffuse) = source.diffuse {
        material.diffuse = colour(diffuse);
    }
    let opacity = finite(source.dissolve)
        .or_else(|| other("Tr").and_then(|mut words| text::number(words.next()?)).map(|tr: f32| 1.0 - tr));
    material.transmission = 1.0 - share(opacity.unwrap_or(1.0));
    // Bourke's MTL page: 3 and up reflect, by the specular colour; 4, 6, 7 and 9 are glass, filtered by Tf.
    let model = source.illumination_model.unwrap_or(2);
    if (3..=9).contains(&model) {
        material.reflection = material.specular.element_sum() / 3.0;
    }
    if matches!(model, 4 | 6 | 7 | 9)
        && material.transmission == 0.0
        && let Some([r, g, b]) = other("Tf").and_then(text::numbers)
    {
        material.transmission = share((r + g + b) / 3.0);
    }
    if material.transmission > 0.0 {
        // What light goes through is split by Fresnel, so nothing of it is a mirror's share.
        material.reflection = material.reflection.min(1.0 - material.transmission);
    }
    if let Some(map) = &source.diffuse_texture {
        if source.diffuse.is_none() || material.diffuse == Vec3::ZERO {
            // Exporters write Kd 0 beside a map that is meant to be seen as it is.
            material.diffuse = Vec3::ONE;
        }
        let name = map_file(map, textures);
        let folder = textures.folder;
        material.texture = textures.get(&name, warnings, || folder.read(&name));
    }
    material
}

/// The file of a map statement: all of it, or, where that is no file, what follows its options.
fn map_file(map: &str, textures: &Textures<'_>) -> String {
    if map.starts_with('-')
        && !textures.folder.has(map)
        && let Some(last) = map.split_whitespace().next_back()
    {
        return last.replace('\\', "/");
    }
    map.replace('\\', "/")
}

fn finite(value: Option<f32>) -> Option<f32> {
    value.filter(|value| value.is_finite())
}

fn positive(value: f32) -> f32 {
    if value.is_finite() { value.max(0.0) } else { 0.0 }
}

fn share(value: f32) -> f32 {
    positive(value).min(1.0)
}
