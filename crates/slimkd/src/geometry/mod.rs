//! Points, rays, boxes, triangles and the indexed mesh that a tree is built over.

mod aabb;
mod buffer;
mod clip;
mod closest_point;
mod double;
pub(crate) mod estimate;
mod exact;
mod expansion;
mod hit;
mod intersect;
mod mesh;
mod ray;
mod ray_f64;
mod refine;
mod surface;

pub use aabb::Aabb;
pub(crate) use clip::{Clipper, Polygon};
pub(crate) use closest_point::{Nearest, nearest_on_triangle};
pub(crate) use estimate::Estimate;
pub(crate) use exact::{ExactRay, above};
pub use hit::Hit;
pub(crate) use intersect::{Intersection, Shear, is_degenerate};
pub use mesh::{MeshError, TriangleMesh};
pub use ray::Ray;
pub use ray_f64::{HitF64, RayF64};
pub use refine::RefinedHit;
pub use surface::Surface;
