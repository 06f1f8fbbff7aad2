//! What elements say: numbers, points, colours, transforms.

use super::xml::{Document, Element};
use crate::load::{LoadError, error::quoted, text};
use glam::{DMat3, DMat4, DVec3, Vec3};

const NUMBERS: &str = "write numbers with commas or blanks between them, and give parameters a <default>";

/// The numbers of a value, separated by commas or white space.
fn numbers(document: &Document<'_>, element: &Element, value: &str) -> Result<Vec<f64>, LoadError> {
    let words =
        value.split(|c: char| c == ',' || c == ';' || c.is_whitespace()).filter(|word| !word.is_empty());
    words
        .map(|word| {
            text::number(word.as_bytes()).ok_or_else(|| {
                document.invalid(element, format!("{} is no number", quoted(word.as_bytes())), NUMBERS)
            })
        })
        .collect()
}

fn wrong_count(document: &Document<'_>, element: &Element, wanted: &str) -> LoadError {
    let what = format!("<{}> needs {wanted}", element.tag.chars().take(40).collect::<String>());
    document.invalid(element, what, NUMBERS)
}

/// A vector out of `value` or out of x, y and z; what is not said is `missing`.
fn vector(document: &Document<'_>, element: &Element, missing: f64) -> Result<DVec3, LoadError> {
    if let Some(value) = element.get("value") {
        return match numbers(document, element, value)?[..] {
            [all] => Ok(DVec3::splat(all)),
            [x, y, z] => Ok(DVec3::new(x, y, z)),
            _ => Err(wrong_count(document, element, "one number or three")),
        };
    }
    let mut out = DVec3::splat(missing);
    for (axis, key) in ["x", "y", "z"].into_iter().enumerate() {
        if let Some(value) = element.get(key) {
            match numbers(document, element, value)?[..] {
                [number] => out[axis] = number,
                _ => return Err(wrong_count(document, element, "one number each of x, y and z")),
            }
        }
    }
    Ok(out)
}

impl Document<'_> {
    /// A property that is one number.
    pub(super) fn number(&self, owner: u32, name: &str) -> Result<Option<f64>, LoadError> {
        let Some((_, element)) = self.property(owner, name) else { return Ok(None) };
        let Some(value) = element.get("value") else { return Ok(None) };
        match numbers(self, element, value)?[..] {
            [number] => Ok(Some(number)),
            _ => Err(wrong_count(self, element, "one number")),
        }
    }

    /// A property that is a point or a vector.
    pub(super) fn point(&self, owner: u32, name: &str) -> Result<Option<DVec3>, LoadError> {
        let Some((_, element)) = self.property(owner, name) else { return Ok(None) };
        vector(self, element, 0.0).map(Some)
    }

    /// A property that is text.
    pub(super) fn text(&self, owner: u32, name: &str) -> Option<&str> {
        self.property(owner, name)?.1.get("value")
    }

    /// A property that is yes or no.
    pub(super) fn is(&self, owner: u32, name: &str, otherwise: bool) -> bool {
        self.text(owner, name).map_or(otherwise, |value| value.trim().eq_ignore_ascii_case("true"))
    }

    /// A transform, the first step first; the identity where there is none.
    pub(super) fn transform(&self, owner: u32, name: &str) -> Result<DMat4, LoadError> {
        let Some((transform, _)) = self.property(owner, name) else { return Ok(DMat4::IDENTITY) };
        let mut whole = DMat4::IDENTITY;
        for (_, step) in self.children(transform) {
            whole = self.step(step)? * whole;
        }
        Ok(whole)
    }

    fn step(&self, step: &Element) -> Result<DMat4, LoadError> {
        Ok(match &*step.tag {
            "translate" => DMat4::from_translation(vector(self, step, 0.0)?),
            "scale" => DMat4::from_scale(vector(self, step, 1.0)?),
            "rotate" => {
                let axis = vector(self, step, 0.0)?;
                let angle = numbers(self, step, step.get("angle").unwrap_or("0"))?;
                let (Some(axis), [angle]) = (axis.try_normalize(), &angle[..]) else {
                    return Err(wrong_count(self, step, "an axis that is not zero and one angle in degrees"));
                };
                DMat4::from_axis_angle(axis, angle.to_radians())
            }
            "matrix" => match &numbers(self, step, step.get("value").unwrap_or_default())?[..] {
                rows @ [_, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _] => {
                    DMat4::from_cols_slice(rows).transpose()
                }
                rows @ [_, _, _, _, _, _, _, _, _] => {
                    DMat4::from_mat3(DMat3::from_cols_slice(rows).transpose())
                }
                _ => return Err(wrong_count(self, step, "16 numbers, row by row, or 9")),
            },
            "lookat" => {
                let point = |key: &str| match step.get(key) {
                    None => Ok(None),
                    Some(value) => match numbers(self, step, value)?[..] {
                        [x, y, z] => Ok(Some(DVec3::new(x, y, z))),
                        _ => Err(wrong_count(self, step, "three numbers each of origin, target and up")),
                    },
                };
                let origin = point("origin")?.unwrap_or_default();
                let target = point("target")?.unwrap_or(DVec3::Z);
                let degenerate = || {
                    wrong_count(self, step, "a target apart from its origin, and an up that points elsewhere")
                };
                let forward = (target - origin).try_normalize().ok_or_else(degenerate)?;
                let up = point("up")?.filter(|up| *up != DVec3::ZERO);
                let up = up.unwrap_or_else(|| forward.any_orthonormal_vector());
                let left = up.cross(forward).try_normalize().ok_or_else(degenerate)?;
                let turned = DMat4::from_mat3(DMat3::from_cols(left, forward.cross(left), forward));
                DMat4::from_translation(origin) * turned
            }
            _ => DMat4::IDENTITY,
        })
    }

    /// A property that is a colour, as linear sRGB; a spectrum counts by its mean. `None`: it is not said, or not as a number.
    pub(super) fn colour(&self, owner: u32, name: &str) -> Result<Option<Vec3>, LoadError> {
        match self.property(owner, name) {
            Some((_, element)) => self.colour_of(element),
            None => Ok(None),
        }
    }

    pub(super) fn colour_of(&self, element: &Element) -> Result<Option<Vec3>, LoadError> {
        if !matches!(&*element.tag, "rgb" | "srgb" | "spectrum" | "float" | "color") {
            return Ok(None);
        }
        let Some(value) = element.get("value") else { return Ok(None) };
        if let Some(hex) = value.trim().strip_prefix('#')
            && hex.len() == 6
            && let Ok(bits) = u32::from_str_radix(hex, 16)
        {
            let byte = |shift: u32| f32::from((bits >> shift) as u8) / 255.0;
            return Ok(Some(Vec3::new(byte(16), byte(8), byte(0)).map(crate::load::textures::linear)));
        }
        if value.contains(':') {
            // Wavelengths and values.
            let values = value.split([',', ' ', '\t', '\n']).filter_map(|pair| pair.split_once(':'));
            let values: Vec<f64> =
                values.filter_map(|(_, value)| text::number(value.trim().as_bytes())).collect();
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            return Ok((!values.is_empty()).then(|| Vec3::splat(mean as f32)));
        }
        match numbers(self, element, value)?[..] {
            [all] => Ok(Some(Vec3::splat(all as f32))),
            [r, g, b] => {
                let colour = Vec3::new(r as f32, g as f32, b as f32);
                let is_srgb = &*element.tag == "srgb";
                Ok(Some(if is_srgb { colour.map(crate::load::textures::linear) } else { colour }))
            }
            _ => Err(wrong_count(self, element, "one number or three")),
        }
    }
}
