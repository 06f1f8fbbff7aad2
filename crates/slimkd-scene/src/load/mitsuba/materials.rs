//! Mitsuba's BSDFs to Whitted-style materials, as far as those go.

use super::xml::Document;
use crate::{
    Material, Warning, WarningKind,
    load::{LoadError, textures::Textures, warn},
};
use glam::Vec3;
use std::collections::{BTreeMap, HashMap};

/// BSDFs within BSDFs that are followed.
const MAX_DEPTH: usize = 16;

/// Indices of refraction by name, as in Mitsuba's manual.
const INDICES: [(&str, f32); 22] = [
    ("vacuum", 1.0),
    ("helium", 1.000_04),
    ("hydrogen", 1.000_13),
    ("air", 1.000_28),
    ("carbon dioxide", 1.000_45),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("pet", 1.575),
    ("diamond", 2.419),
];
/// What metals mirror, as linear sRGB.
const METALS: [(&str, [f32; 3]); 6] = [
    ("Ag", [0.97, 0.96, 0.91]),
    ("Al", [0.91, 0.92, 0.92]),
    ("Au", [1.0, 0.71, 0.29]),
    ("Cr", [0.55, 0.55, 0.55]),
    ("Cu", [0.95, 0.64, 0.54]),
    ("W", [0.5, 0.49, 0.48]),
];

/// The materials of a scene while it is read.
pub(super) struct Materials<'a> {
    document: &'a Document<'a>,
    pub(super) list: Vec<Material>,
    pub(super) textures: Textures<'a>,
    /// By BSDF, and the light that the shape gives off.
    known: HashMap<(Option<u32>, Option<u32>), u32>,
    /// By BSDF alone.
    converted: HashMap<u32, Material>,
    /// How many materials have something that was replaced, by what that is.
    replaced: BTreeMap<String, u64>,
    /// Of textures.
    warnings: Vec<Warning>,
}

fn share(value: f32) -> f32 {
    if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
}

/// What has no BSDF that is known.
fn grey() -> Material {
    Material { diffuse: Vec3::splat(0.5), ..Default::default() }
}

/// What is mirrored at normal incidence, by the index of refraction (Fresnel).
fn mirrored(ior: f32) -> f32 {
    let root = (ior - 1.0) / (ior + 1.0);
    root * root
}

/// The Blinn-Phong exponent of a GGX or Beckmann width.
fn shininess(alpha: f32) -> f32 {
    let alpha = alpha.max(0.01);
    (2.0 / (alpha * alpha) - 2.0).clamp(1.0, 1e4)
}

impl<'a> Materials<'a> {
    pub(super) fn new(document: &'a Document<'a>, textures: Textures<'a>) -> Self {
        Self {
            document,
            list: Vec::new(),
            textures,
            known: HashMap::new(),
            converted: HashMap::new(),
            replaced: BTreeMap::new(),
            warnings: Vec::new(),
        }
    }

    /// The material of a shape.
    pub(super) fn of_shape(&mut self, shape: u32) -> Result<u32, LoadError> {
        let document = self.document;
        let (mut bsdf, mut emitter) = (None, None);
        for (child, _) in document.children(shape) {
            let Some(target) = document.resolve(child) else { continue };
            match &*document.at(target).tag {
                "bsdf" => bsdf = Some(target),
                "emitter" | "luminaire" if document.at(target).plugin() == "area" => emitter = Some(target),
                _ => {}
            }
        }
        if let Some(&known) = self.known.get(&(bsdf, emitter)) {
            return Ok(known);
        }
        let mut material = match bsdf {
            Some(bsdf) => self.of_bsdf(bsdf, 0)?,
            None => grey(),
        };
        if let Some(emitter) = emitter {
            let radiance = document.colour(emitter, "radiance")?.unwrap_or(Vec3::ONE);
            material.emission = radiance.map(|x| if x.is_finite() { x.max(0.0) } else { 0.0 });
        }
        if let Some(bsdf) = bsdf
            && let Some(id) = document.at(bsdf).get("id")
        {
            material.name = id.to_owned();
        }
        self.list.push(material);
        let index = self.list.len() as u32 - 1;
        self.known.insert((bsdf, emitter), index);
        Ok(index)
    }

    fn note(&mut self, what: &str) {
        if self.replaced.len() < 32 {
            *self.replaced.entry(what.chars().take(40).collect()).or_default() += 1;
        }
    }

    /// A colour or texture property.
    fn colour(&mut self, owner: u32, name: &str) -> Result<Option<(Vec3, Option<u32>)>, LoadError> {
        let document = self.document;
        let Some((property, _)) = document.property(owner, name) else { return Ok(None) };
        let Some(target) = document.resolve(property) else { return Ok(None) };
        let element = document.at(target);
        if let Some(colour) = document.colour_of(element)? {
            return Ok(Some((colour.map(share), None)));
        }
        let file = document.text(target, "filename");
        match (&*element.tag, element.plugin(), file) {
            ("texture", "bitmap", Some(file)) => {
                let place = document.find(file);
                let folder = self.textures.folder;
                let texture = self.textures.get(&place, &mut self.warnings, || folder.read(&place));
                Ok(Some((if texture.is_some() { Vec3::ONE } else { Vec3::splat(0.5) }, texture)))
            }
            ("texture", "checkerboard", _) => {
                let colour = |name: &str, missing: f32| {
                    Ok::<_, LoadError>(document.colour(target, name)?.unwrap_or(Vec3::splat(missing)))
                };
                let mean = 0.5 * (colour("color0", 0.4)? + colour("color1", 0.2)?);
                self.note("checkerboards, shown by their mean");
                Ok(Some((mean.map(share), None)))
            }
            (tag, plugin, _) => {
                self.note(&format!("<{tag} type={plugin:?}>, left out"));
                Ok(None)
            }
        }
    }

    /// An index of refraction, by its number or by the medium's name.
    fn ior(&self, bsdf: u32, name: &str) -> Option<f32> {
        let text = self.document.text(bsdf, name)?;
        let named = INDICES.iter().find(|(known, _)| known.eq_ignore_ascii_case(text.trim()));
        let index = named.map(|&(_, index)| index).or_else(|| text.trim().parse().ok());
        index.filter(|index: &f32| index.is_finite() && *index > 0.0)
    }

    /// The material of a BSDF that lies within `depth` others; each is converted once.
    fn of_bsdf(&mut self, bsdf: u32, depth: usize) -> Result<Material, LoadError> {
        if let Some(known) = self.converted.get(&bsdf) {
            return Ok(known.clone());
        }
        let plugin = self.document.at(bsdf).plugin();
        let covers = matches!(
            plugin,
            "twosided" | "mask" | "bumpmap" | "normalmap" | "blendbsdf" | "coating" | "roughcoating"
        );
        let material = if covers { self.covered(bsdf, depth)? } else { self.plain(bsdf)? };
        self.converted.insert(bsdf, material.clone());
        Ok(material)
    }

    /// The material of a BSDF that covers another one: the other one's.
    fn covered(&mut self, bsdf: u32, depth: usize) -> Result<Material, LoadError> {
        let document = self.document;
        let plugin = document.at(bsdf).plugin();
        if plugin != "twosided" {
            self.note(&format!("BSDFs of type {plugin:?}, shown as what they cover"));
        }
        let mut within = document.children(bsdf).filter_map(|(child, _)| document.resolve(child));
        let within = within.find(|&child| &*document.at(child).tag == "bsdf");
        match within {
            Some(within) if depth < MAX_DEPTH => self.of_bsdf(within, depth + 1),
            _ => Ok(grey()),
        }
    }

    /// The material of a BSDF that covers no other.
    fn plain(&mut self, bsdf: u32) -> Result<Material, LoadError> {
        let (document, grey) = (self.document, grey());
        let plugin = document.at(bsdf).plugin();
        let (diffuse, texture) = {
            let name = match plugin {
                "principled" | "principledthin" => "base_color",
                "plastic" | "roughplastic" | "phong" | "ward" => "diffuse_reflectance",
                _ => "reflectance",
            };
            let (colour, texture) = self.colour(bsdf, name)?.unwrap_or((Vec3::splat(0.5), None));
            (colour, texture)
        };
        let tint = match document.property(bsdf, "specular_reflectance") {
            Some(_) => self.colour(bsdf, "specular_reflectance")?.map_or(Vec3::ONE, |(colour, _)| colour),
            None => Vec3::ONE,
        };
        let is_rough = plugin.starts_with("rough");
        let alpha = match document.number(bsdf, "alpha")? {
            Some(alpha) if is_rough => share(alpha as f32),
            _ if is_rough => 0.1,
            _ => 0.0,
        };
        // A GGX width is the square of a roughness.
        let smooth = 1.0 - alpha.sqrt();
        let (named, outside) = (self.ior(bsdf, "int_ior"), self.ior(bsdf, "ext_ior").unwrap_or(1.000_28));
        let inside = |missing| named.unwrap_or(missing);
        Ok(match plugin {
            "diffuse" => Material { diffuse, texture, ..grey },
            "roughdiffuse" | "difftrans" => {
                self.note(&format!("BSDFs of type {plugin:?}, shown as \"diffuse\""));
                Material { diffuse, texture, ..grey }
            }
            "plastic" | "roughplastic" => {
                let mirrored = mirrored(inside(1.49) / outside);
                Material {
                    diffuse,
                    texture,
                    specular: mirrored * tint * smooth,
                    shininess: shininess(alpha),
                    ior: inside(1.49).clamp(1.0, 10.0),
                    ..grey
                }
            }
            "conductor" | "roughconductor" => {
                let name = document.text(bsdf, "material").unwrap_or("none").trim();
                let metal = METALS.iter().find(|(metal, _)| name.starts_with(metal));
                let (eta, k) = (document.colour(bsdf, "eta")?, document.colour(bsdf, "k")?);
                let colour = match (eta, k, metal) {
                    (Some(eta), Some(k), _) => {
                        let squared = k * k;
                        let (less, more) = (eta - Vec3::ONE, eta + Vec3::ONE);
                        (less * less + squared) / (more * more + squared)
                    }
                    (_, _, Some(&(_, colour))) => Vec3::from(colour),
                    _ => Vec3::ONE,
                };
                let colour = (colour * tint).map(share);
                Material {
                    diffuse: colour,
                    specular: colour * smooth,
                    shininess: shininess(alpha),
                    reflection: smooth * smooth,
                    ..grey
                }
            }
            "dielectric" | "thindielectric" | "roughdielectric" | "null" => {
                if plugin == "roughdielectric" {
                    self.note("BSDFs of type \"roughdielectric\", shown smooth");
                }
                let thin = matches!(plugin, "thindielectric" | "null");
                let ior = if thin { 1.0 } else { inside(1.5046) / outside };
                Material {
                    diffuse: Vec3::ONE,
                    specular: mirrored(ior) * tint * smooth,
                    shininess: shininess(alpha),
                    transmission: 1.0,
                    ior: ior.clamp(1.0, 10.0),
                    ..grey
                }
            }
            "principled" | "principledthin" => {
                let number = |name: &str, missing: f32| {
                    Ok::<f32, LoadError>(document.number(bsdf, name)?.map_or(missing, |x| share(x as f32)))
                };
                let (metallic, roughness) = (number("metallic", 0.0)?, number("roughness", 0.5)?);
                let smooth = 1.0 - roughness;
                let ior = document.number(bsdf, "eta")?.map_or(1.5, |ior| ior as f32).clamp(1.0, 10.0);
                Material {
                    diffuse,
                    texture,
                    specular: Vec3::splat(mirrored(ior)).lerp(diffuse, metallic) * smooth,
                    shininess: shininess(roughness * roughness),
                    reflection: metallic * smooth * smooth,
                    transmission: number("spec_trans", 0.0)? * (1.0 - metallic),
                    ior,
                    ..grey
                }
            }
            "phong" => {
                let exponent = document.number(bsdf, "exponent")?.unwrap_or(30.0) as f32;
                let specular = document.colour(bsdf, "specular_reflectance")?.unwrap_or(Vec3::splat(0.2));
                let shininess = if exponent.is_finite() { exponent.clamp(1.0, 1e4) } else { 30.0 };
                Material { diffuse, texture, specular: specular.map(share), shininess, ..grey }
            }
            // Materials of radio waves have no colour.
            "radio-material" | "itu-radio-material" => grey,
            _ => {
                self.note(&format!("BSDFs of type {plugin:?}, shown in grey"));
                Material { diffuse, texture, ..grey }
            }
        })
    }

    /// Warns of textures, and of what was replaced.
    pub(super) fn warn(&mut self, warnings: &mut Vec<Warning>) {
        std::mem::take(&mut self.warnings).into_iter().for_each(|warning| warn(warnings, warning));
        let total = self.list.len() as u64;
        for (what, &count) in &self.replaced {
            let warning = Warning::counted(
                WarningKind::Ignored,
                count,
                total.max(count),
                format!("materials have {what}"),
            );
            warn(warnings, warning);
        }
    }
}
