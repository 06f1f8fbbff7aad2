//! From a hit to the surface there: position, normals, texture coordinate.

use glam::{DVec3, Vec2, Vec3};
use slimkd::{Hit, TriangleMesh};
use slimkd_scene::Scene;

/// The least cosine that a shading normal keeps towards the viewer.
const MIN_FACING: f32 = 1e-3;

/// A point on a triangle, seen from somewhere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// The hit point, scene units.
    pub(crate) position: Vec3,
    /// The triangle's own unit normal, on the viewer's side.
    pub(crate) geometric: Vec3,
    /// The unit normal to shade with; faces the viewer too.
    pub(crate) shading: Vec3,
    /// Texture coordinate, if there is one.
    pub(crate) uv: Option<Vec2>,
    /// True when the viewer is on the outer side: where vertex normals point, or else counter-clockwise corners.
    pub(crate) outside: bool,
    /// How far a ray starts off the surface, scene units.
    pub(crate) offset: f32,
    /// Where shadow rays start before their offset: on the curved surface that smooth normals pretend.
    pub(crate) shadow_origin: Vec3,
}

impl Surface {
    /// The surface at `hit`, seen along the unit vector `direction`. `None` for a triangle too thin to have a normal.
    pub(crate) fn new(scene: &Scene, mesh: &TriangleMesh, hit: &Hit, direction: Vec3) -> Option<Self> {
        let corners = mesh.corners(hit.triangle).map(Vec3::from);
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let (u, v) = (f64::from(hit.u), f64::from(hit.v));
        let offset = crate::offset::distance(&corners);
        let position = crate::offset::inwards(a * (1.0 - u - v) + b * u + c * v, (a + b + c) / 3.0, offset);
        let mut geometric = (b - a).cross(c - a).try_normalize()?.as_vec3();

        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let indices = mesh.triangles()[hit.triangle as usize];
        let vertex_normals = scene
            .normals
            .as_ref()
            .and_then(|normals| normals.corners(hit.triangle, indices))
            .and_then(|normals| unit_normals(normals.map(Vec3::from)));
        let mut shading = vertex_normals
            .and_then(|[a, b, c]| (a * weights[0] + b * weights[1] + c * weights[2]).try_normalize())
            .unwrap_or(geometric);
        // Files get their winding wrong more often than their normals.
        if geometric.dot(shading) < 0.0 {
            geometric = -geometric;
        }
        let outside = geometric.dot(direction) <= 0.0;
        if !outside {
            (geometric, shading) = (-geometric, -shading);
        }
        shading = facing(shading, geometric, direction);

        let shadow_origin = match vertex_normals {
            Some(normals) => {
                let side = if outside { 1.0 } else { -1.0 };
                smooth_position(position, &corners, &normals.map(|n| n * side), weights)
            }
            None => position,
        };
        let uv = scene.uvs.as_ref().and_then(|uvs| uvs.corners(hit.triangle, indices)).map(|uvs| {
            let [a, b, c] = uvs.map(Vec2::from);
            a * weights[0] + b * weights[1] + c * weights[2]
        });
        Some(Self { position, geometric, shading, uv, outside, offset, shadow_origin })
    }

    /// Where shadow rays start.
    pub(crate) fn outer(&self) -> Vec3 {
        self.shadow_origin + self.geometric * self.offset
    }

    /// Where a ray starts that leaves in `direction`, to either side.
    pub(crate) fn start(&self, direction: Vec3) -> Vec3 {
        crate::offset::leave(self.position, self.geometric, self.offset, direction)
    }
}

/// All three at unit length, or `None` when one of them is zero or not finite.
fn unit_normals(normals: [Vec3; 3]) -> Option<[Vec3; 3]> {
    let [a, b, c] = normals.map(|normal| normal.as_dvec3().try_normalize().map(DVec3::as_vec3));
    Some([a?, b?, c?])
}

/// Turns a shading normal that faces away from the viewer just far enough back.
fn facing(shading: Vec3, geometric: Vec3, direction: Vec3) -> Vec3 {
    let cos = -shading.dot(direction);
    if cos >= MIN_FACING {
        return shading;
    }
    (shading - direction * (MIN_FACING - cos)).try_normalize().unwrap_or(geometric)
}

/// Hanika, *Hacking the Shadow Terminator*, Ray Tracing Gems II (2021), ch. 4: lifts the point towards the tangent
/// planes at the corners, so that a coarsely tessellated round body does not throw jagged shadows on itself.
fn smooth_position(position: Vec3, corners: &[Vec3; 3], normals: &[Vec3; 3], weights: [f32; 3]) -> Vec3 {
    (0..3).fold(position, |lifted, k| {
        let below = (position - corners[k]).dot(normals[k]).min(0.0);
        lifted - normals[k] * (below * weights[k])
    })
}
