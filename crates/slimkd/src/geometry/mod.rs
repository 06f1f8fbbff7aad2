//! Points, rays, boxes, triangles and the indexed mesh that a tree is built over.

mod aabb;
mod mesh;
mod ray;

pub use aabb::Aabb;
pub use mesh::{MeshError, TriangleMesh};
pub use ray::Ray;
