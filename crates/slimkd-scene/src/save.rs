//! Scenes written to files: binary PLY, float32 positions (float64 where the mesh has an origin) and triangle lists of int32, with
//! the scene's colours.

use crate::{Attribute, Scene, Warning, WarningKind};
use slimkd::TriangleMesh;
use std::io::{self, Write};

/// What has no colour of its own is white, as readers take it where a file has no colours.
const WHITE: [u8; 4] = [255; 4];

/// Writes `mesh` as a binary PLY. Triangle ids are face order, so that a tree of the file has the ids of this mesh. Positions are those
/// of the world: where the mesh has an origin, as doubles.
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
    write(mesh, None, &[], to)
}

impl Scene {
    /// Writes the mesh as [`write_ply`] does, with the colours that vertices and triangles have. Returns warnings of colours that PLY
    /// cannot hold: it has one a vertex, so of several corners' colours at one vertex the first is written. Materials, normals,
    /// texture coordinates, cameras and lights are not written.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn write_ply(&self, to: &mut impl Write) -> io::Result<Vec<Warning>> {
        let (colours, torn) = match &self.colours {
            Some(colours) => vertex_colours(&self.mesh, colours),
            None => (Vec::new(), 0),
        };
        let of_vertices = self.colours.is_some().then_some(&colours[..]);
        write(&self.mesh, of_vertices, &self.face_colours, to)?;
        let total = self.mesh.vertices().len() as u64;
        let what = "vertices have several colours, of which PLY holds one: the first was written";
        Ok((torn > 0)
            .then(|| Warning::counted(WarningKind::Ignored, torn, total, what))
            .into_iter()
            .collect())
    }
}

/// A colour for each vertex, and how many vertices have several.
fn vertex_colours(mesh: &TriangleMesh, colours: &Attribute<[u8; 4]>) -> (Vec<[u8; 4]>, u64) {
    let mut first: Vec<Option<[u8; 4]>> = vec![None; mesh.vertices().len()];
    let mut is_torn = vec![false; first.len()];
    for (id, &corners) in (0..).zip(mesh.triangles()) {
        let Some(of_corners) = colours.corners(id, corners) else { continue };
        for (corner, colour) in corners.into_iter().zip(of_corners) {
            let vertex = corner as usize;
            is_torn[vertex] |= *first[vertex].get_or_insert(colour) != colour;
        }
    }
    // Vertices of no triangle have theirs by their own index.
    if colours.indices.is_none() {
        first.iter_mut().zip(&colours.values).for_each(|(first, &colour)| *first = Some(colour));
    }
    let torn = is_torn.into_iter().filter(|&torn| torn).count() as u64;
    (first.into_iter().map(|colour| colour.unwrap_or(WHITE)).collect(), torn)
}

/// `faces` is empty where triangles have no colours.
fn write(
    mesh: &TriangleMesh,
    vertices: Option<&[[u8; 4]]>,
    faces: &[[u8; 4]],
    to: &mut impl Write,
) -> io::Result<()> {
    const COLOURS: &str =
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
    let colours_if = |there: bool| if there { COLOURS } else { "" };
    let origin = mesh.origin();
    let is_far = origin != [0.0; 3];
    let real = if is_far { "double" } else { "float" };
    write!(
        to,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty {real} x\nproperty {real} y\n\
         property {real} z\n{}element face {}\nproperty list uchar int vertex_indices\n{}end_header\n",
        mesh.vertices().len(),
        colours_if(vertices.is_some()),
        mesh.len(),
        colours_if(!faces.is_empty()),
    )?;
    for (index, vertex) in mesh.vertices().iter().enumerate() {
        if is_far {
            for (origin, x) in origin.iter().zip(vertex) {
                to.write_all(&(origin + f64::from(*x)).to_le_bytes())?;
            }
        } else {
            let mut record = [0; 12];
            for (bytes, x) in record.chunks_exact_mut(4).zip(vertex) {
                bytes.copy_from_slice(&x.to_le_bytes());
            }
            to.write_all(&record)?;
        }
        if let Some(colours) = vertices {
            to.write_all(&colours[index])?;
        }
    }
    for (id, corners) in mesh.triangles().iter().enumerate() {
        let mut record = [3; 13];
        for (bytes, corner) in record[1..].chunks_exact_mut(4).zip(corners) {
            bytes.copy_from_slice(&corner.to_le_bytes());
        }
        to.write_all(&record)?;
        if !faces.is_empty() {
            to.write_all(faces.get(id).unwrap_or(&WHITE))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Format, load_bytes};

    fn again(scene: &Scene) -> (Scene, Vec<Warning>) {
        let mut ply = Vec::new();
        let warnings = scene.write_ply(&mut ply).unwrap();
        (load_bytes(Format::Ply, &ply).unwrap(), warnings)
    }

    #[test]
    fn colours_survive() {
        let obj = b"v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 9 9 9 1 1 0\nf 1 2 3\n";
        let coloured = load_bytes(Format::Obj, obj).unwrap();
        let off = b"OFF\n3 2 0\n0 0 1\n1 0 1\n0 1 1\n3 0 1 2 9 8 7\n3 0 2 1\n";
        let plain = load_bytes(Format::Obj, b"v 0 0 5\nv 1 0 5\nv 0 1 5\nf 1 2 3\n").unwrap();
        let faces = load_bytes(Format::Off, off).unwrap();
        assert!(coloured.colours.is_some() && faces.face_colours.len() == 2);
        for scene in [coloured.clone(), faces.clone(), plain.clone()] {
            let (read, warnings) = again(&scene);
            assert_eq!((&read.colours, &read.face_colours), (&scene.colours, &scene.face_colours));
            assert!(read.mesh == scene.mesh && warnings.is_empty());
        }
        // Merged, the colours of vertices have indices of their own.
        let (read, warnings) = again(&Scene::merge(vec![coloured, plain, faces]).unwrap());
        let red = [255, 0, 0, 255];
        assert_eq!((read.colours.unwrap().values[0], warnings), (red, Vec::new()));
        assert_eq!(read.face_colours, [WHITE, WHITE, [9, 8, 7, 255], WHITE]);
    }

    #[test]
    fn a_vertex_of_several_colours_is_counted() {
        let mut scene =
            load_bytes(Format::Obj, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n").unwrap();
        let values = vec![[1, 1, 1, 255], [2, 2, 2, 255]];
        scene.colours = Some(Attribute { values, indices: Some(vec![[0; 3], [1; 3]]) });
        let (read, warnings) = again(&scene);
        assert_eq!(
            read.colours.unwrap().values.iter().map(|colour| colour[0]).collect::<Vec<_>>(),
            [1, 1, 1, 2]
        );
        assert_eq!(warnings.len(), 1);
        assert_eq!(warnings[0].count(), Some((2, 4)));
    }
}
