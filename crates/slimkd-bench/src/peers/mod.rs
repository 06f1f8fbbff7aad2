//! Everyone who is measured: a file each.

pub mod embree;
mod kdtree_ray;
mod obvhs;
pub mod own;
mod parry;
mod svenstaro;
#[cfg(feature = "tinybvh")]
mod tinybvh;
mod triangle;

use crate::built::Contender;
use crate::variant::Variant;
use crate::vector::bounds;
use slimkd::{InstructionSet, TriangleMesh};
use std::path::Path;
use std::sync::Arc;

/// Name of the contender that all ratios of the first kind refer to.
pub const STANDARD: &str = "slimkd-standard";
/// Name of the contender that all ratios of the second kind refer to.
pub const EMBREE: &str = "embree-medium";

/// Somebody who cannot take part, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Absent {
    /// Who.
    pub name: String,
    /// Why, and how to change that.
    pub reason: String,
}

/// slimkd's trees.
pub fn slimkd(trees: Vec<Variant>, isa: Option<InstructionSet>) -> Vec<Box<dyn Contender>> {
    trees.into_iter().map(|tree| Box::new(own::Own::new(tree, isa)) as Box<dyn Contender>).collect()
}

/// All other libraries, and those that are not there. `embree` is a file, a folder to search, or nothing: then the
/// usual places are searched. Embree uses nothing beyond `isa`; the peers in Rust, what they were compiled for.
pub fn others(embree: Option<&Path>, isa: Option<InstructionSet>) -> (Vec<Box<dyn Contender>>, Vec<Absent>) {
    let mut peers: Vec<Box<dyn Contender>> = Vec::new();
    let mut absent = Vec::new();
    match embree::Library::find(embree) {
        Ok(library) => {
            let library = Arc::new(library);
            for variant in embree::Variant::ALL {
                peers.push(Box::new(embree::Embree::new(library.clone(), *variant, isa)));
            }
        }
        Err(error) => absent.push(Absent { name: "embree".into(), reason: error.to_string() }),
    }
    for variant in obvhs::Variant::ALL {
        peers.push(Box::new(obvhs::Obvhs::new(*variant)));
    }
    #[cfg(feature = "tinybvh")]
    tinybvh::register(&mut peers, &mut absent);
    #[cfg(not(feature = "tinybvh"))]
    absent.push(Absent {
        name: "tinybvh".into(),
        reason: "not compiled in; needs C++ and `--features tinybvh`".into(),
    });
    peers.push(Box::new(parry::Parry));
    peers.push(Box::new(svenstaro::Svenstaro));
    peers.push(Box::new(kdtree_ray::KdTreeRay));
    (peers, absent)
}

/// The version of a crate that this program is linked with, from the workspace's lock file.
fn locked_version(name: &str) -> String {
    let lock = include_str!("../../../../Cargo.lock");
    let mut lines = lock.lines();
    let wanted = format!("name = \"{name}\"");
    lines
        .find(|line| *line == wanted)
        .and_then(|_| lines.next())
        .and_then(|line| line.strip_prefix("version = \""))
        .and_then(|line| line.strip_suffix('"'))
        .unwrap_or("unknown")
        .to_owned()
}

/// The mesh as peers get it: triangles with a not finite corner, over which some builders panic, shrink to a point and
/// keep their ids. The same mesh when there is none.
pub fn finite(mesh: &Arc<TriangleMesh>) -> Arc<TriangleMesh> {
    let broken = |id: u32| mesh.corners(id).iter().flatten().any(|x| !x.is_finite());
    if !(0..mesh.len() as u32).any(broken) {
        return mesh.clone();
    }
    let mut vertices = mesh.vertices().to_vec();
    let point = bounds(mesh);
    let point = if point.is_empty() { [0.0; 3] } else { point.min };
    let replacement = vertices.len() as u32;
    vertices.push(point);
    vertices.iter_mut().filter(|v| v.iter().any(|x| !x.is_finite())).for_each(|v| *v = point);
    let triangles = (0..mesh.len() as u32)
        .map(|id| if broken(id) { [replacement; 3] } else { mesh.triangles()[id as usize] })
        .collect();
    Arc::new(TriangleMesh::new(vertices, triangles).expect("the mesh was valid before, plus one vertex"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_come_from_the_lock_file() {
        assert!(locked_version("obvhs").starts_with("0."));
        assert_eq!(locked_version("no such crate"), "unknown");
    }

    #[test]
    fn broken_triangles_shrink_to_a_point() {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f32::NAN; 3]];
        let mesh = Arc::new(TriangleMesh::new(vertices, vec![[0, 1, 3], [0, 1, 2]]).unwrap());
        let clean = finite(&mesh);
        assert_eq!(clean.triangles(), [[4, 4, 4], [0, 1, 2]]);
        assert!(clean.vertices().iter().flatten().all(|x| x.is_finite()));
        let whole = Arc::new(crate::soup::soup(3, 1));
        assert!(Arc::ptr_eq(&whole, &finite(&whole)));
    }
}
