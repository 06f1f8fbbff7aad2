//! Shapes that a scene describes by numbers, as meshes.

use crate::{Attribute, Scene, origin::Frame};
use glam::DVec3;
use slimkd::{MeshError, TriangleMesh};
use std::{f64::consts::TAU, sync::Arc};

/// Corners around spheres, cylinders and discs: edges lie 0.2 % of the radius inside.
pub(super) const AROUND: u32 = 48;

fn scene(
    vertices: Vec<DVec3>,
    normals: Vec<DVec3>,
    uvs: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
    frame: &Frame,
) -> Result<Scene, MeshError> {
    let single = |points: Vec<DVec3>| points.into_iter().map(|p| p.as_vec3().to_array()).collect::<Vec<_>>();
    let vertices = vertices.into_iter().map(|p| frame.put(p.to_array())).collect();
    let mut scene = Scene {
        mesh: Arc::new(TriangleMesh::new(vertices, triangles)?),
        normals: Some(Attribute { values: single(normals), indices: None }),
        uvs: Some(Attribute { values: uvs, indices: None }),
        ..Default::default()
    };
    frame.finish(&mut scene);
    Ok(scene)
}

/// A circle's point.
fn around(k: u32) -> (f64, f64) {
    // Whole and half turns are exact.
    match 4 * (k % AROUND) / AROUND {
        quarter if (4 * k).is_multiple_of(AROUND) => {
            [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][quarter as usize]
        }
        _ => {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(AROUND)).sin_cos();
            (cos, sin)
        }
    }
}

/// The square from −1 to 1 in z = 0, seen from +z.
pub(super) fn rectangle() -> Result<Scene, MeshError> {
    let uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let corners =
        uvs.iter().map(|&[u, v]| DVec3::new(f64::from(2.0 * u - 1.0), f64::from(2.0 * v - 1.0), 0.0));
    scene(corners.collect(), vec![DVec3::Z; 4], uvs, vec![[0, 1, 2], [2, 3, 0]], &Frame::default())
}

/// The cube from −1 to 1, seen from outside.
pub(super) fn cube() -> Result<Scene, MeshError> {
    let (mut vertices, mut normals, mut uvs, mut triangles) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let first = vertices.len() as u32;
            for [u, v] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
                let mut corner = DVec3::ZERO;
                corner[axis] = side;
                corner[(axis + 1) % 3] = side * (2.0 * u - 1.0);
                corner[(axis + 2) % 3] = 2.0 * v - 1.0;
                let mut normal = DVec3::ZERO;
                normal[axis] = side;
                vertices.push(corner);
                normals.push(normal);
                uvs.push([u as f32, v as f32]);
            }
            triangles.extend([[first, first + 1, first + 2], [first + 2, first + 3, first]]);
        }
    }
    scene(vertices, normals, uvs, triangles, &Frame::default())
}

/// A sphere, seen from outside, with its poles along z.
pub(super) fn sphere(centre: DVec3, radius: f64, frame: &Frame) -> Result<Scene, MeshError> {
    let rings = AROUND / 2;
    let (mut normals, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    // The seam has its vertices twice, for the texture coordinates.
    for ring in 0..=rings {
        let (z, away) = around(ring);
        for k in 0..=AROUND {
            let (x, y) = around(k);
            normals.push(DVec3::new(away * x, away * y, z));
            uvs.push([k as f32 / AROUND as f32, ring as f32 / rings as f32]);
        }
    }
    let row = AROUND + 1;
    for ring in 0..rings {
        for k in 0..AROUND {
            let (a, b) = (ring * row + k, ring * row + k + 1);
            // At the poles, one of a square's triangles has no area.
            if ring + 1 < rings {
                triangles.push([a, a + row, b + row]);
            }
            if ring > 0 {
                triangles.push([a, b + row, b]);
            }
        }
    }
    let vertices = normals.iter().map(|&normal| centre + radius * normal).collect();
    scene(vertices, normals, uvs, triangles, frame)
}

/// A cylinder without its ends, seen from outside.
pub(super) fn cylinder(from: DVec3, to: DVec3, radius: f64, frame: &Frame) -> Result<Scene, MeshError> {
    let axis = (to - from).try_normalize().unwrap_or(DVec3::Z);
    let (side, up) = axis.any_orthonormal_pair();
    let (mut vertices, mut normals, mut uvs, mut triangles) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for k in 0..=AROUND {
        let (x, y) = around(k);
        let normal = x * side + y * up;
        for (end, v) in [(from, 0.0), (to, 1.0)] {
            vertices.push(end + radius * normal);
            normals.push(normal);
            uvs.push([k as f32 / AROUND as f32, v]);
        }
    }
    for k in 0..AROUND {
        let a = 2 * k;
        triangles.extend([[a, a + 2, a + 3], [a, a + 3, a + 1]]);
    }
    scene(vertices, normals, uvs, triangles, frame)
}

/// The disc of radius 1 in z = 0, seen from +z.
pub(super) fn disc(frame: &Frame) -> Result<Scene, MeshError> {
    let mut vertices = vec![DVec3::ZERO];
    let mut uvs = vec![[0.0, 0.0]];
    for k in 0..=AROUND {
        let (x, y) = around(k);
        vertices.push(DVec3::new(x, y, 0.0));
        // Mitsuba's are polar: the distance from the middle, and the angle.
        uvs.push([1.0, k as f32 / AROUND as f32]);
    }
    let triangles = (1..=AROUND).map(|k| [0, k, k + 1]).collect();
    scene(vertices.clone(), vec![DVec3::Z; vertices.len()], uvs, triangles, frame)
}
