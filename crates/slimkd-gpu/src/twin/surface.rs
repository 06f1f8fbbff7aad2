//! `shaders/surface.wgsl` in Rust; sums of two floats are f64.

use super::picture::Picture;
use glam::{DVec3, Vec2, Vec3};
use slimkd::Hit;

const RELATIVE: f32 = 1.0 / (1 << 19) as f32;
const MIN_FACING: f32 = 1e-3;

/// What a ray finds where it hits.
pub(super) struct Surface {
    pub(super) position: Vec3,
    pub(super) geometric: Vec3,
    pub(super) shading: Vec3,
    pub(super) shadow_origin: Vec3,
    pub(super) offset: f32,
    pub(super) uv: Option<Vec2>,
    pub(super) outside: bool,
}

impl Surface {
    pub(super) fn new(picture: &Picture<'_>, hit: &Hit, direction: Vec3) -> Option<Self> {
        let (frame, twin) = (picture.frame, &picture.twin);
        let ids = twin.triple(twin.image.params.triangles + 3 * hit.triangle);
        let corners = ids.map(|id| Vec3::from(twin.vertex(id)));
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let mut geometric = (b - a).cross(c - a).try_normalize()?.as_vec3();
        let offset =
            corners.iter().fold(0.0f32, |most, corner| most.max(corner.abs().max_element())) * RELATIVE;
        let (u, v) = (f64::from(hit.u), f64::from(hit.v));
        let point = a * (1.0 - u - v) + b * u + c * v;
        let way = (a + b + c) / 3.0 - point;
        let step = way.try_normalize().map_or(DVec3::ZERO, |unit| unit * f64::from(offset).min(way.length()));
        let position = (point + step).as_vec3();
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];

        let values = |indices: u32, count: u32| {
            let index = if indices == u32::MAX { ids } else { twin.triple(indices + 3 * hit.triangle) };
            index.iter().all(|&index| index < count).then_some(index)
        };
        let normals = match frame.normals {
            u32::MAX => None,
            at => values(frame.normal_indices, frame.normal_count).and_then(|index| {
                let [a, b, c] = index.map(|k| Vec3::from(twin.floats(at + 3 * k)).as_dvec3().try_normalize());
                Some([a?, b?, c?].map(DVec3::as_vec3))
            }),
        };
        let mut shading = normals
            .and_then(|[a, b, c]| (a * weights[0] + b * weights[1] + c * weights[2]).try_normalize())
            .unwrap_or(geometric);
        if geometric.dot(shading) < 0.0 {
            geometric = -geometric;
        }
        let outside = geometric.dot(direction) <= 0.0;
        let side = if outside { 1.0 } else { -1.0 };
        (geometric, shading) = (geometric * side, shading * side);
        let cosine = -shading.dot(direction);
        if cosine < MIN_FACING {
            shading = (shading - direction * (MIN_FACING - cosine)).try_normalize().unwrap_or(geometric);
        }
        let mut shadow_origin = position;
        for (normals, (k, &weight)) in normals.iter().flat_map(|n| [n; 3]).zip(weights.iter().enumerate()) {
            let normal = normals[k] * side;
            shadow_origin -= normal * ((position - corners[k]).dot(normal).min(0.0) * weight);
        }
        let uv = match frame.uvs {
            u32::MAX => None,
            at => values(frame.uv_indices, frame.uv_count).map(|index| {
                let [a, b, c] =
                    index.map(|k| Vec2::from([twin.float(at + 2 * k), twin.float(at + 2 * k + 1)]));
                a * weights[0] + b * weights[1] + c * weights[2]
            }),
        };
        Some(Self { position, geometric, shading, shadow_origin, offset, uv, outside })
    }

    /// Where a ray starts that leaves in `direction`, to either side.
    pub(super) fn start(&self, direction: Vec3) -> Vec3 {
        let step = self.geometric * self.offset;
        if direction.dot(self.geometric) >= 0.0 { self.position + step } else { self.position - step }
    }

    /// Where rays to lights start.
    pub(super) fn lifted(&self) -> Vec3 {
        self.shadow_origin + self.geometric * self.offset
    }
}
