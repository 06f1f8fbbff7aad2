//! What a file says of its tree and mesh beside the arrays; all of it is proved on reading.
//!
//! Four u64: vertices, triangles, degenerate triangles, the mesh's hash; six f32: lower and upper corner of the bounds;
//! u32: depth of the deepest leaf; a zero u32.

use super::bytes::le_bytes;
use super::{FileError, damaged};
use crate::geometry::{Aabb, TriangleMesh};
use crate::tree::KdTree;
use xxhash_rust::xxh3::Xxh3;

/// Length of the section, bytes.
pub(super) const LENGTH: usize = 4 * 8 + 6 * 4 + 2 * 4;

/// The section's content.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub(super) vertices: u64,
    pub(super) triangles: u64,
    degenerate: u64,
    mesh_hash: u64,
    pub(super) bounds: Aabb,
    pub(super) depth: u32,
}

impl TriangleMesh {
    /// A hash of all vertices and triangles in their order, and of an origin that is not 0 (xxh3, 64 bits): the same on every machine. It finds mix-ups,
    /// not forgeries.
    ///
    /// ```
    /// use slimkd::TriangleMesh;
    /// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// assert_eq!(mesh.content_hash(), mesh.clone().content_hash());
    /// # Ok::<(), slimkd::MeshError>(())
    /// ```
    pub fn content_hash(&self) -> u64 {
        let mut hash = Xxh3::new();
        hash.update(&(self.vertices().len() as u64).to_le_bytes());
        hash.update(&le_bytes(self.vertices()));
        hash.update(&le_bytes(self.triangles()));
        if self.origin() != [0.0; 3] {
            hash.update(&put_origin(self.origin()));
        }
        hash.digest()
    }
}

/// The section of a mesh's origin: three f64.
pub(super) fn put_origin(origin: [f64; 3]) -> Vec<u8> {
    origin.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// Length of that section, bytes.
pub(super) const ORIGIN_LENGTH: usize = 24;

pub(super) fn get_origin(block: &[u8]) -> Result<[f64; 3], FileError> {
    let (words, rest) = block.as_chunks::<8>();
    let Ok(origin) = <[_; 3]>::try_from(words) else { return damaged("its origin is cut off") };
    let origin = origin.map(f64::from_le_bytes);
    if !rest.is_empty() || !origin.iter().all(|x| x.is_finite()) || origin == [0.0; 3] {
        return damaged("its origin makes no sense");
    }
    Ok(origin)
}

impl Shape {
    pub(super) fn of(tree: &KdTree) -> Self {
        Self {
            vertices: tree.mesh.vertices().len() as u64,
            triangles: tree.mesh.len() as u64,
            degenerate: tree.degenerate,
            mesh_hash: tree.mesh.content_hash(),
            bounds: tree.bounds,
            depth: tree.depth,
        }
    }

    pub(super) fn put(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(LENGTH);
        for number in [self.vertices, self.triangles, self.degenerate, self.mesh_hash] {
            out.extend_from_slice(&number.to_le_bytes());
        }
        for number in self.bounds.min.iter().chain(&self.bounds.max) {
            out.extend_from_slice(&number.to_le_bytes());
        }
        out.extend_from_slice(&u64::from(self.depth).to_le_bytes());
        out
    }

    pub(super) fn get(block: &[u8]) -> Result<Self, FileError> {
        if block.len() != LENGTH {
            return damaged("its shape is cut off");
        }
        let (words, _) = block.as_chunks::<8>();
        let [vertices, triangles, degenerate, mesh_hash] =
            std::array::from_fn(|k| u64::from_le_bytes(words[k]));
        let (floats, _) = block[32..56].as_chunks::<4>();
        let corner = |first: usize| std::array::from_fn(|k| f32::from_le_bytes(floats[first + k]));
        let bounds = Aabb { min: corner(0), max: corner(3) };
        let Ok(depth) = u32::try_from(u64::from_le_bytes(words[7])) else {
            return damaged("its depth is absurd");
        };
        Ok(Self { vertices, triangles, degenerate, mesh_hash, bounds, depth })
    }

    /// Whether this is the tree of `mesh`.
    pub(super) fn check_mesh(&self, mesh: &TriangleMesh) -> Result<(), FileError> {
        let found = mesh.content_hash();
        let counts = (mesh.vertices().len() as u64, mesh.len() as u64);
        if found == self.mesh_hash && counts == (self.vertices, self.triangles) {
            return Ok(());
        }
        let Self { vertices, triangles, mesh_hash: expected, .. } = *self;
        Err(FileError::MeshMismatch { vertices, triangles, expected, found })
    }

    /// Whether what it says is what was found, to the last bit.
    pub(super) fn check_facts(
        &self,
        mesh: &TriangleMesh,
        valid: usize,
        bounds: &Aabb,
        depth: u32,
    ) -> Result<(), FileError> {
        if self.degenerate != (mesh.len() - valid) as u64 {
            return damaged("the count of degenerate triangles is wrong");
        }
        let bits = |bounds: &Aabb| [bounds.min, bounds.max].map(|corner| corner.map(f32::to_bits));
        if bits(&self.bounds) != bits(bounds) {
            return damaged("its bounds are not the mesh's");
        }
        if self.depth != depth { damaged("its depth is wrong") } else { Ok(()) }
    }
}
