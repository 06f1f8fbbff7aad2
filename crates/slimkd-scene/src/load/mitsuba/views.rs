//! Mitsuba's sensors and emitters that are no shapes.

use super::Reader;
use crate::{Camera, Light, UpAxis, load::LoadError};
use glam::{DVec3, Vec3};

impl Reader<'_> {
    /// Adds a light.
    pub(super) fn light(&mut self, element: u32) -> Result<(), LoadError> {
        let document = self.document;
        self.counts.lights += 1;
        let colour = |name: &str| Ok::<_, LoadError>(document.colour(element, name)?.unwrap_or(Vec3::ONE));
        let world = document.transform(element, "to_world")?;
        match document.at(element).plugin() {
            "point" => {
                let position = document.point(element, "position")?.unwrap_or(DVec3::ZERO);
                let position =
                    DVec3::from(self.frame.near_all(world.transform_point3(position).to_array())).as_vec3();
                self.scene.lights.push(Light::Point { position, intensity: colour("intensity")? });
            }
            "directional" => {
                let direction = document.point(element, "direction")?.unwrap_or(DVec3::Z);
                let direction = world.transform_vector3(direction).as_vec3();
                if direction != Vec3::ZERO && direction.is_finite() {
                    let irradiance = colour("irradiance")?;
                    self.scene.lights.push(Light::Directional { direction, irradiance });
                }
            }
            other => {
                let left_out = &mut self.counts.lights_left_out;
                if left_out.len() < 32 {
                    *left_out.entry(other.chars().take(40).collect()).or_default() += 1;
                }
            }
        }
        Ok(())
    }

    /// Adds a camera.
    pub(super) fn camera(&mut self, element: u32) -> Result<(), LoadError> {
        let document = self.document;
        self.counts.cameras += 1;
        if !matches!(document.at(element).plugin(), "perspective" | "thinlens") {
            self.counts.cameras_left_out += 1;
            return Ok(());
        }
        let world = document.transform(element, "to_world")?;
        let film = document.children(element).find(|(_, child)| &*child.tag == "film").map(|(film, _)| film);
        let size = |name: &str, missing: f64| -> Result<f64, LoadError> {
            let size = film.map(|film| document.number(film, name)).transpose()?.flatten();
            Ok(size.filter(|size| *size >= 1.0).unwrap_or(missing))
        };
        let aspect = size("width", 768.0)? / size("height", 576.0)?;
        let axis = document.text(element, "fov_axis").unwrap_or("x");
        let fov = document.number(element, "fov")?.unwrap_or(39.6);
        let half = (0.5 * fov.clamp(0.01, 179.0)).to_radians().tan();
        // The angle that is given may be that of the width, or of the diagonal.
        let half = match axis {
            "y" => half,
            "smaller" if aspect >= 1.0 => half,
            "larger" if aspect < 1.0 => half,
            "diagonal" => half / (1.0 + aspect * aspect).sqrt(),
            _ => half / aspect,
        };
        let eye = DVec3::from(self.frame.near_all(world.transform_point3(DVec3::ZERO).to_array()));
        let forward = world.transform_vector3(DVec3::Z);
        let up = world.transform_vector3(DVec3::Y).as_vec3();
        // Scenes do not say what is up, but the first sensor mostly stands upright.
        let axes = [UpAxis::X, UpAxis::Y, UpAxis::Z];
        let upright = axes.into_iter().find(|axis| axis.vector().dot(up.normalize_or_zero()) > 0.7);
        self.scene.up = self.scene.up.or(upright);
        self.scene.cameras.push(Camera {
            eye: eye.as_vec3(),
            target: (eye + forward).as_vec3(),
            up,
            fov: (2.0 * half.atan()).to_degrees() as f32,
        });
        Ok(())
    }
}
