//! What a smooth dielectric reflects and where the rest goes.

use glam::Vec3;

/// Share of unpolarised light that a dielectric boundary reflects: the exact Fresnel equations.
///
/// `cos_i` is the cosine between the incoming direction and the normal on its side, `eta` the index of refraction
/// behind the boundary over the one before it. 1 for total internal reflection.
///
/// ```
/// // Glass at normal incidence: ((1.5 − 1) / (1.5 + 1))² = 4 %.
/// assert!((slimkd_render::dielectric_reflectance(1.0, 1.5) - 0.04).abs() < 1e-6);
/// ```
pub fn dielectric_reflectance(cos_i: f32, eta: f32) -> f32 {
    let cos_i = cos_i.clamp(0.0, 1.0);
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// The refracted direction by Snell's law; `None` for total internal reflection.
///
/// `direction` and `normal` have unit length and face each other; `eta` as for [`dielectric_reflectance`].
pub fn refract(direction: Vec3, normal: Vec3, eta: f32) -> Option<Vec3> {
    let cos_i = -direction.dot(normal);
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) / (eta * eta);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    (direction / eta + normal * (cos_i / eta - cos_t)).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence() {
        for (eta, share) in [(1.0, 0.0), (1.5, 0.04), (1.0 / 1.5, 0.04), (2.42, 0.172_4), (1.333, 0.020_37)] {
            assert!((dielectric_reflectance(1.0, eta) - share).abs() < 1e-4, "{eta}");
        }
    }

    #[test]
    fn grazing_brewster_and_total() {
        assert!((dielectric_reflectance(0.0, 1.5) - 1.0).abs() < 1e-6);
        // At Brewster's angle the parallel part vanishes; the other is ((1 − eta²) / (1 + eta²))².
        let cos = 1.5_f32.atan().cos();
        let perpendicular = ((1.0 - 2.25) / (1.0 + 2.25_f32)).powi(2);
        assert!((dielectric_reflectance(cos, 1.5) - perpendicular / 2.0).abs() < 1e-5);
        // The critical angle of glass is asin(1 / 1.5) = 41.8°.
        assert_eq!(dielectric_reflectance(42.0_f32.to_radians().cos(), 1.0 / 1.5), 1.0);
        assert!(dielectric_reflectance(41.0_f32.to_radians().cos(), 1.0 / 1.5) < 1.0);
    }

    #[test]
    fn snell() {
        for degrees in [0.0_f32, 10.0, 45.0, 80.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let refracted = refract(Vec3::new(sin, 0.0, -cos), Vec3::Z, 1.5).unwrap();
            assert!((refracted.x - sin / 1.5).abs() < 1e-6 && refracted.z < 0.0);
            let back = refract(refracted, Vec3::Z, 1.0 / 1.5).unwrap();
            assert!(back.abs_diff_eq(Vec3::new(sin, 0.0, -cos), 1e-5));
        }
        let (sin, cos) = 42.0_f32.to_radians().sin_cos();
        assert_eq!(refract(Vec3::new(sin, 0.0, -cos), Vec3::Z, 1.0 / 1.5), None);
    }
}
