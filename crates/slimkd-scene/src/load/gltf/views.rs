//! glTF cameras and lights.

use super::{json::Node, reader::Reader};
use crate::{Camera, Light, Scene, Warning, WarningKind, load::warn, origin::Frame};
use glam::{DMat4, DVec3, Vec3};

impl Reader<'_> {
    /// Adds the camera and the light of a node whose transform to world space is `world`.
    pub(super) fn view_of_node(&self, node: &Node, world: &DMat4, frame: &Frame, scene: &mut Scene) {
        // Both look along −z (glTF 2.0, section 3.10.1; KHR_lights_punctual).
        let position = world.transform_point3(DVec3::ZERO).to_array();
        let position = DVec3::from(frame.near_all(position)).as_vec3();
        let forward = world.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z).as_vec3();
        if let Some(camera) = node.camera {
            let up = world.transform_vector3(DVec3::Y).normalize_or(DVec3::Y).as_vec3();
            let perspective = self.root.cameras.get(camera.0).and_then(|camera| camera.perspective.as_ref());
            match perspective.map(|lens| lens.yfov) {
                Some(yfov) if yfov > 0.0 && yfov < std::f64::consts::PI && position.is_finite() => {
                    let (eye, target, fov) = (position, position + forward, yfov.to_degrees() as f32);
                    scene.cameras.push(Camera { eye, target, up, fov });
                }
                _ => {
                    let what = format!("cameras[{}] has no perspective and was left out", camera.0);
                    warn(&mut scene.warnings, Warning::new(WarningKind::Ignored, what));
                }
            }
        }
        let light = node.extensions.as_ref().and_then(|extensions| extensions.light.as_ref());
        let Some(index) = light.map(|light| light.light.0) else { return };
        let Some(light) = self.root.extensions.lights.lights.get(index) else {
            let what = format!("lights[{index}] is missing and was left out");
            warn(&mut scene.warnings, Warning::new(WarningKind::Missing, what));
            return;
        };
        let power = Vec3::from(light.color).max(Vec3::ZERO) * light.intensity.max(0.0);
        if !power.is_finite() || !position.is_finite() {
            let what = format!("lights[{index}] is not finite and was left out");
            warn(&mut scene.warnings, Warning::new(WarningKind::Invalid, what));
            return;
        }
        scene.lights.push(match light.kind.as_str() {
            "directional" => Light::Directional { direction: forward, irradiance: power },
            "point" => Light::Point { position, intensity: power },
            _ => {
                let what = format!("lights[{index}] is a spot light; it shines in all directions here");
                warn(&mut scene.warnings, Warning::new(WarningKind::Ignored, what));
                Light::Point { position, intensity: power }
            }
        });
    }
}
