//! Points, rays, boxes, triangles and the indexed mesh that a tree is built over.

mod aabb;
mod intersect;
mod mesh;
mod ray;

pub use aabb::Aabb;
pub(crate) use intersect::{Intersection, Shear, is_degenerate};
pub use mesh::{MeshError, TriangleMesh};
pub use ray::Ray;
