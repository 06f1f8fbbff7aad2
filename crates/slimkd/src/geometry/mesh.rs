//! The indexed triangle mesh: 12 bytes a vertex and 12 bytes a triangle, nothing else.

use super::buffer::Buffer;
use super::{Aabb, is_degenerate};
use crate::threads;
use std::fmt;
use std::sync::Arc;
use thiserror::Error;

/// Vertices and triangles, in the order of the input. A triangle's position in [`TriangleMesh::triangles`] is its
/// public id. Positions that are not finite and collinear triangles are allowed: such triangles are never hit.
#[derive(Clone)]
pub struct TriangleMesh {
    vertices: Buffer<[f32; 3]>,
    triangles: Buffer<[u32; 3]>,
    origin: [f64; 3],
}

/// Why a mesh was refused.
#[derive(Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshError {
    /// A corner points past the vertices: check the file's index base (OBJ counts from 1) or its vertex block.
    #[error(
        "triangle {triangle} uses vertex {vertex}, but there are {vertices} vertices; fix the index list"
    )]
    IndexOutOfRange {
        /// The triangle's id.
        triangle: usize,
        /// The index that it holds.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// Ids are 32 bits and 0xFFFFFFFF means "miss": split the scene into several meshes.
    #[error("{0} triangles or vertices are more than 32-bit ids can name; split the mesh")]
    TooLarge(usize),
}

impl TriangleMesh {
    /// Takes the arrays and checks every index. Cloning a mesh later copies nothing: clones share the arrays.
    ///
    /// ```
    /// use slimkd::TriangleMesh;
    /// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// assert_eq!(mesh.memory_bytes(), 3 * 12 + 12);
    /// # Ok::<(), slimkd::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] when a triangle names a vertex that is not there, and [`MeshError::TooLarge`] when there are
    /// 2³² − 1 vertices or triangles, or more.
    pub fn new(vertices: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        Self::check(&vertices, &triangles)?;
        Ok(Self { vertices: vertices.into(), triangles: triangles.into(), origin: [0.0; 3] })
    }

    /// Collects vertices and triangles of any type that turns into arrays: points of glam, nalgebra and mint, or your own. This copies
    /// them; [`TriangleMesh::new`] takes a `Vec` of arrays without a copy.
    ///
    /// ```
    /// use slimkd::TriangleMesh;
    /// struct Point(f32, f32, f32);
    /// impl From<Point> for [f32; 3] {
    ///     fn from(Point(x, y, z): Point) -> Self {
    ///         [x, y, z]
    ///     }
    /// }
    /// let corners = [Point(0.0, 0.0, 0.0), Point(1.0, 0.0, 0.0), Point(0.0, 1.0, 0.0)];
    /// assert_eq!(TriangleMesh::collect(corners, [[0, 1, 2]])?.len(), 1);
    /// # Ok::<(), slimkd::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`TriangleMesh::new`].
    pub fn collect(
        vertices: impl IntoIterator<Item = impl Into<[f32; 3]>>,
        triangles: impl IntoIterator<Item = impl Into<[u32; 3]>>,
    ) -> Result<Self, MeshError> {
        let vertices = vertices.into_iter().map(Into::into).collect();
        Self::new(vertices, triangles.into_iter().map(Into::into).collect())
    }

    /// A mesh over memory that someone else owns: arrays of another language, a mapped file, buffers that other code reads too. Nothing
    /// is copied. The owners are dropped when the mesh and every tree over it are gone.
    ///
    /// ```
    /// use slimkd::TriangleMesh;
    /// use std::sync::Arc;
    /// let vertices: Arc<Vec<[f32; 3]>> = Arc::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    /// let mesh = TriangleMesh::from_shared(vertices.clone(), Arc::new([[0, 1, 2]]))?;
    /// assert_eq!(mesh.vertices().as_ptr(), vertices.as_ptr());
    /// # Ok::<(), slimkd::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`TriangleMesh::new`].
    pub fn from_shared(
        vertices: Arc<dyn AsRef<[[f32; 3]]> + Send + Sync>,
        triangles: Arc<dyn AsRef<[[u32; 3]]> + Send + Sync>,
    ) -> Result<Self, MeshError> {
        let (vertices, triangles) = (Buffer::new(vertices), Buffer::new(triangles));
        let mesh = Self { vertices, triangles, origin: [0.0; 3] };
        Self::check(mesh.vertices(), mesh.triangles())?;
        Ok(mesh)
    }

    /// Whether every index names a vertex.
    fn check(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
        for count in [vertices.len(), triangles.len()] {
            if count >= u32::MAX as usize {
                return Err(MeshError::TooLarge(count));
            }
        }
        let limit = vertices.len() as u32;
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&corner| corner >= limit) {
                return Err(MeshError::IndexOutOfRange { triangle, vertex, vertices: vertices.len() });
            }
        }
        Ok(())
    }

    /// Says where in the world the mesh's coordinates are 0, for meshes that are far from the world's origin: a vertex is at `origin + position`.
    /// Only what ends in `_f64` takes world coordinates; all else, [`Ray`](crate::Ray) too, stays in the coordinates of the mesh.
    ///
    /// ```
    /// use slimkd::TriangleMesh;
    /// let world = [[528_980.85, 183_526.1, 0.0], [528_982.3, 183_523.55, 0.0], [528_982.3, 183_523.55, 3.0]];
    /// let origin = [528_980.0, 183_524.0, 0.0];
    /// let vertices = world.map(|p: [f64; 3]| [0, 1, 2].map(|k| (p[k] - origin[k]) as f32));
    /// let mesh = TriangleMesh::new(vertices.into(), vec![[0, 1, 2]])?.with_origin(origin);
    /// assert_eq!(mesh.origin(), origin);
    /// # Ok::<(), slimkd::MeshError>(())
    /// ```
    #[must_use]
    pub fn with_origin(mut self, origin: [f64; 3]) -> Self {
        self.origin = origin;
        self
    }

    /// Where in the world the mesh's coordinates are 0; itself 0 unless [`TriangleMesh::with_origin`] set it.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// The positions of the vertices, in scene units.
    pub fn vertices(&self) -> &[[f32; 3]] {
        self.vertices.as_slice()
    }

    /// The three vertex indices of each triangle. A triangle's position in this slice is its public id, so
    /// `mesh.triangles()[hit.triangle as usize]` are the vertices of a hit triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.triangles.as_slice()
    }

    /// Number of triangles, degenerate ones included.
    pub fn len(&self) -> usize {
        self.triangles().len()
    }

    /// True when there is no triangle at all.
    pub fn is_empty(&self) -> bool {
        self.triangles().is_empty()
    }

    /// The three corners of triangle `id`.
    ///
    /// # Panics
    /// When `id` is not below [`TriangleMesh::len`].
    #[inline]
    pub fn corners(&self, id: u32) -> [[f32; 3]; 3] {
        self.triangles()[id as usize].map(|v| self.vertices()[v as usize])
    }

    /// Whether triangle `id` can never be hit: its corners are exactly collinear, or one has a coordinate that is not finite. A
    /// triangle that is merely tiny can be hit.
    ///
    /// # Panics
    /// When `id` is not below [`TriangleMesh::len`].
    pub fn is_degenerate(&self, id: u32) -> bool {
        is_degenerate(&self.corners(id))
    }

    /// Ids of the triangles that can be hit, ascending, and their bounds. The others are collinear or not finite.
    pub(crate) fn valid_triangles(&self) -> (Vec<u32>, Aabb) {
        self.valid_triangles_until(|| false).expect("memory for the ids")
    }

    /// [`TriangleMesh::valid_triangles`], but `None` once `stop` says so, or where there is no memory for the ids.
    pub(crate) fn valid_triangles_until(&self, stop: impl Fn() -> bool + Sync) -> Option<(Vec<u32>, Aabb)> {
        let mut keep: Vec<u32> = Vec::new();
        keep.try_reserve_exact(self.len()).ok()?;
        let mut bounds = Aabb::EMPTY;
        // A million triangles at a time: the ids are held twice only for those, once in pieces and once in `keep`.
        for first in (0..self.len()).step_by(1 << 20) {
            let ids = first as u32..self.len().min(first + (1 << 20)) as u32;
            let pieces = threads::map(ids.clone().step_by(1 << 14), |first| {
                if stop() {
                    return Err(());
                }
                let mut keep = Vec::new();
                keep.try_reserve_exact(1 << 14).map_err(|_| ())?;
                let mut bounds = Aabb::EMPTY;
                for id in first..ids.end.min(first + (1 << 14)) {
                    let corners = self.corners(id);
                    if !is_degenerate(&corners) {
                        keep.push(id);
                        corners.into_iter().for_each(|corner| bounds.include(corner));
                    }
                }
                Ok((keep, bounds))
            })
            .ok()?;
            for (ids, part) in pieces {
                keep.extend_from_slice(&ids);
                bounds = bounds.union(&part);
            }
        }
        Some((keep, bounds))
    }

    /// Bytes of the two buffers: 12 a vertex, 12 a triangle.
    pub fn memory_bytes(&self) -> u64 {
        12 * (self.vertices().len() as u64 + self.triangles().len() as u64)
    }
}

impl Default for TriangleMesh {
    /// A mesh without vertices and triangles.
    fn default() -> Self {
        Self { vertices: Vec::new().into(), triangles: Vec::new().into(), origin: [0.0; 3] }
    }
}

impl PartialEq for TriangleMesh {
    fn eq(&self, other: &Self) -> bool {
        self.vertices() == other.vertices()
            && self.triangles() == other.triangles()
            && self.origin == other.origin
    }
}

impl fmt::Debug for TriangleMesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "TriangleMesh({} vertices, {} triangles)", self.vertices().len(), self.triangles().len())
    }
}
