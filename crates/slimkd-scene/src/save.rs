//! Scenes written to files: binary PLY of bare meshes, float32 positions and triangle lists of int32; float64 where the mesh has an origin.

use slimkd::TriangleMesh;
use std::io::{self, Write};

/// Writes `mesh` as a binary PLY. Triangle ids are face order, so that a tree of the file has the ids of this mesh. Positions are those of the world:
/// where the mesh has an origin, as doubles.
///
/// ```
/// use slimkd_scene::{Format, load_bytes, write_ply};
/// let scene = load_bytes(Format::Obj, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")?;
/// let mut ply = Vec::new();
/// write_ply(&scene.mesh, &mut ply)?;
/// assert_eq!(load_bytes(Format::Ply, &ply)?.mesh.triangles(), [[0, 1, 2]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_ply(mesh: &TriangleMesh, to: &mut impl Write) -> io::Result<()> {
    let origin = mesh.origin();
    let is_far = origin != [0.0; 3];
    let real = if is_far { "double" } else { "float" };
    write!(
        to,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty {real} x\nproperty {real} y\n\
         property {real} z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.vertices().len(),
        mesh.len()
    )?;
    for vertex in mesh.vertices() {
        if is_far {
            for (origin, x) in origin.iter().zip(vertex) {
                to.write_all(&(origin + f64::from(*x)).to_le_bytes())?;
            }
            continue;
        }
        let mut record = [0; 12];
        for (bytes, x) in record.chunks_exact_mut(4).zip(vertex) {
            bytes.copy_from_slice(&x.to_le_bytes());
        }
        to.write_all(&record)?;
    }
    for corners in mesh.triangles() {
        let mut record = [3; 13];
        for (bytes, corner) in record[1..].chunks_exact_mut(4).zip(corners) {
            bytes.copy_from_slice(&corner.to_le_bytes());
        }
        to.write_all(&record)?;
    }
    Ok(())
}
