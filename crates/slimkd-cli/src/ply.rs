//! Binary PLY files of bare meshes: float32 positions, triangle lists of int32.

use slimkd::TriangleMesh;
use std::io::{self, Write};

/// Writes `mesh`; triangle ids are face order.
pub(crate) fn write(mesh: &TriangleMesh, to: &mut impl Write) -> io::Result<()> {
    write!(
        to,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.vertices().len(),
        mesh.len()
    )?;
    for vertex in mesh.vertices() {
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
