//! bvh (svenstaro): a BVH2 over shapes. It has no closest-hit call, so this is the loop that a user would write: boxes
//! from near to far until the next one lies behind the best hit.

use super::locked_version;
use super::triangle::{Corners, intersect};
use crate::bench::built::{Bytes, Contender, Found, Info, SizeSource, Traced};
use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::{Bvh, BvhNode, rayon_executor};
use bvh::ray::Ray as BvhRay;
use nalgebra::{Point3, Vector3};
use slimkd::{Ray, TriangleMesh};
use std::sync::Arc;

pub(super) struct Svenstaro;

struct Shape {
    corners: Corners,
    id: u32,
    node: usize,
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Aabb<f32, 3> {
        let low = |k: usize| self.corners.iter().map(|c| c[k]).fold(f32::INFINITY, f32::min);
        let high = |k: usize| self.corners.iter().map(|c| c[k]).fold(f32::NEG_INFINITY, f32::max);
        Aabb::with_bounds(Point3::new(low(0), low(1), low(2)), Point3::new(high(0), high(1), high(2)))
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

impl Contender for Svenstaro {
    fn info(&self) -> Info {
        Info {
            name: "bvh".into(),
            library: "bvh",
            version: locked_version("bvh"),
            settings:
                "default features; own loop over nearest_traverse_iterator (closest) and traverse_iterator \
                       (any); own two-sided triangle test"
                    .into(),
            sah: "6 buckets, one triangle a leaf, no constants".into(),
        }
    }

    fn build(&self, mesh: &Arc<TriangleMesh>, _threads: usize) -> Result<Box<dyn Traced>, String> {
        let mut shapes: Vec<Shape> =
            (0..mesh.len() as u32).map(|id| Shape { corners: mesh.corners(id), id, node: 0 }).collect();
        let bvh = Bvh::build_with_executor(&mut shapes, rayon_executor);
        Ok(Box::new(Built { bvh, shapes }))
    }
}

struct Built {
    bvh: Bvh<f32, 3>,
    shapes: Vec<Shape>,
}

/// The library would normalise the direction once more; rays here are of unit length already.
fn convert(ray: &Ray) -> BvhRay<f32, 3> {
    let direction = Vector3::from(ray.direction);
    BvhRay { origin: Point3::from(ray.origin), direction, inv_direction: direction.map(|x| 1.0 / x) }
}

impl Traced for Built {
    fn closest(&self, rays: &[Ray], found: &mut [Found]) {
        for (ray, slot) in rays.iter().zip(found) {
            let theirs = convert(ray);
            let mut shortened = *ray;
            *slot = Found::MISS;
            for shape in self.bvh.nearest_traverse_iterator(&theirs, &self.shapes) {
                let entry = theirs.intersection_slice_for_aabb(&shape.aabb()).map_or(0.0, |slice| slice.0);
                if entry > shortened.t_max {
                    break;
                }
                let t = intersect(&shape.corners, &shortened);
                if t < slot.t {
                    *slot = Found { t, triangle: shape.id };
                    shortened.t_max = t;
                }
            }
        }
    }

    fn any(&self, rays: &[Ray], blocked: &mut [bool]) {
        for (ray, slot) in rays.iter().zip(blocked) {
            let theirs = convert(ray);
            *slot = self
                .bvh
                .traverse_iterator(&theirs, &self.shapes)
                .any(|shape| intersect(&shape.corners, ray) < f32::INFINITY);
        }
    }

    fn bytes(&self, _counted: u64) -> Bytes {
        Bytes {
            structure: (self.bvh.nodes.len() * size_of::<BvhNode<f32, 3>>()) as u64,
            copies: (self.shapes.len() * size_of::<Shape>()) as u64,
            mesh_read: 0,
            source: SizeSource::Exact,
        }
    }
}
