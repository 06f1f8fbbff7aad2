//! From linear light to what a screen shows.

use glam::Vec3;

/// How bright linear light is folded into 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum ToneMap {
    /// Cut at 1.
    Clamp,
    /// Reinhard et al. 2002, eq. 3, on luminance: x / (1 + x).
    Reinhard,
    /// Khronos PBR Neutral (2024): colours below 0.8 stay as they are, highlights roll off and lose saturation.
    #[default]
    Neutral,
}

impl ToneMap {
    /// Maps one colour, linear in and linear out.
    pub fn apply(self, colour: Vec3) -> Vec3 {
        let colour = colour.max(Vec3::ZERO);
        match self {
            Self::Clamp => colour,
            Self::Reinhard => colour / (1.0 + colour.dot(Vec3::new(0.2126, 0.7152, 0.0722))),
            Self::Neutral => neutral(colour),
        }
        .min(Vec3::ONE)
    }
}

/// Khronos PBR Neutral Tone Mapper, specification of 2024, with its constants.
fn neutral(colour: Vec3) -> Vec3 {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let least = colour.min_element();
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let colour = colour - offset;
    let peak = colour.max_element();
    if peak < START {
        return colour;
    }
    let d = 1.0 - START;
    let folded = 1.0 - d * d / (peak + d - START);
    let grey = 1.0 - 1.0 / (DESATURATION * (peak - folded) + 1.0);
    (colour * (folded / peak)).lerp(Vec3::splat(folded), grey)
}

/// How a film becomes an 8- or 16-bit picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Development {
    /// Exposure, stops: light is multiplied by 2^exposure.
    pub exposure: f32,
    /// Applied after the exposure.
    pub tone_map: ToneMap,
}

impl Development {
    /// The sRGB-encoded colour, 0 to 1.
    pub fn develop(&self, colour: Vec3) -> Vec3 {
        let exposed = colour * self.exposure.exp2();
        let exposed = Vec3::from(exposed.to_array().map(|x| if x.is_nan() { 0.0 } else { x.min(1e6) }));
        self.tone_map.apply(exposed).map(srgb)
    }
}

/// The sRGB transfer curve, IEC 61966-2-1.
fn srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_rise_and_stay_within_range() {
        for tone_map in [ToneMap::Clamp, ToneMap::Reinhard, ToneMap::Neutral] {
            let mut last = -1.0;
            for step in 0..2000 {
                let mapped = tone_map.apply(Vec3::splat(step as f32 * 0.01));
                assert!(mapped.x >= last && mapped.x <= 1.0, "{tone_map:?} at {step}");
                last = mapped.x;
            }
        }
    }

    #[test]
    fn known_points() {
        let plain = Development { exposure: 0.0, tone_map: ToneMap::Clamp };
        assert!((plain.develop(Vec3::splat(0.214_04)).x - 0.5).abs() < 1e-4);
        let brighter = Development { exposure: 1.0, ..plain };
        assert_eq!(brighter.develop(Vec3::splat(0.25)), plain.develop(Vec3::splat(0.5)));
        let odd = plain.develop(Vec3::new(f32::NAN, f32::INFINITY, -1.0));
        assert!(odd.abs_diff_eq(Vec3::new(0.0, 1.0, 0.0), 1e-6), "{odd}");
        // Highlights keep their order instead of all being white.
        assert!(ToneMap::Neutral.apply(Vec3::splat(2.0)).x < ToneMap::Neutral.apply(Vec3::splat(4.0)).x);
    }
}
