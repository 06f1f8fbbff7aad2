//! obvhs: PLOC with reinsertion, BVH2 and eight-wide compressed CWBVH.
//!
//! Triangles are the library's 64-byte `RtTriangle`, laid out in the order of the leaves as its documentation advises;
//! one variant reads the caller's indexed mesh instead, which is the smallest that the library can be.

use super::locked_version;
use crate::bench::built::{Bytes, Contender, Found, Info, SizeSource, Traced};
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris, node::Bvh2Node};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris, node::CwBvhNode};
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use slimkd::{Ray, TriangleMesh};
use std::sync::Arc;
use std::time::Duration;

#[derive(Clone, Copy)]
pub(super) enum Variant {
    Bvh2Medium,
    Bvh2VerySlow,
    CwMedium,
    CwMediumMesh,
}

impl Variant {
    pub(super) const ALL: &[Self] =
        &[Self::Bvh2Medium, Self::Bvh2VerySlow, Self::CwMedium, Self::CwMediumMesh];
}

pub(super) struct Obvhs {
    variant: Variant,
}

impl Obvhs {
    pub(super) fn new(variant: Variant) -> Self {
        Self { variant }
    }

    fn parameters(&self) -> BvhBuildParams {
        match self.variant {
            Variant::Bvh2VerySlow => BvhBuildParams::very_slow_build(),
            _ => BvhBuildParams::medium_build(),
        }
    }
}

impl Contender for Obvhs {
    fn info(&self) -> Info {
        let (name, settings) = match self.variant {
            Variant::Bvh2Medium => ("obvhs-bvh2-medium", "medium_build; RtTriangle copies in leaf order"),
            Variant::Bvh2VerySlow => {
                ("obvhs-bvh2-very-slow", "very_slow_build (pre-splits); RtTriangle copies in leaf order")
            }
            Variant::CwMedium => ("obvhs-cwbvh-medium", "medium_build; RtTriangle copies in leaf order"),
            Variant::CwMediumMesh => ("obvhs-cwbvh-medium-mesh", "medium_build; reads the caller's mesh"),
        };
        Info {
            name: name.into(),
            library: "obvhs",
            version: locked_version("obvhs"),
            settings: settings.into(),
            sah: format!(
                "PLOC; leaf collapse with traversal cost {}, at most {} a leaf (CWBVH: 3)",
                self.parameters().collapse_traversal_cost,
                self.parameters().max_prims_per_leaf
            ),
        }
    }

    fn build(&self, mesh: &Arc<TriangleMesh>, _threads: usize) -> Result<Box<dyn Traced>, String> {
        if mesh.is_empty() {
            return Err("obvhs is not built over an empty mesh".into());
        }
        let triangles: Vec<Triangle> = (0..mesh.len() as u32).map(|id| triangle(mesh, id)).collect();
        let mut unused = Duration::ZERO;
        let copies = |order: &[u32]| -> Vec<RtTriangle> {
            order.iter().map(|&id| RtTriangle::from(&triangles[id as usize])).collect()
        };
        Ok(match self.variant {
            Variant::Bvh2Medium | Variant::Bvh2VerySlow => {
                let mut bvh = build_bvh2_from_tris(&triangles, self.parameters(), &mut unused);
                // Only edits of the tree need these.
                bvh.parents = Vec::new();
                bvh.primitives_to_nodes = Vec::new();
                bvh.primitive_indices_freelist = Vec::new();
                Box::new(Two { copies: copies(&bvh.primitive_indices), bvh })
            }
            Variant::CwMedium => {
                let bvh = build_cwbvh_from_tris(&triangles, self.parameters(), &mut unused);
                Box::new(Wide { copies: copies(&bvh.primitive_indices), bvh })
            }
            Variant::CwMediumMesh => {
                let bvh = build_cwbvh_from_tris(&triangles, self.parameters(), &mut unused);
                Box::new(WideMesh { mesh: mesh.clone(), bvh })
            }
        })
    }
}

#[inline(always)]
fn triangle(mesh: &TriangleMesh, id: u32) -> Triangle {
    let [a, b, c] = mesh.corners(id);
    Triangle { v0: Vec3A::from(a), v1: Vec3A::from(b), v2: Vec3A::from(c) }
}

#[inline(always)]
fn convert(ray: &Ray) -> ObvhsRay {
    ObvhsRay::new(Vec3A::from(ray.origin), Vec3A::from(ray.direction), ray.t_min, ray.t_max)
}

fn found(hit: bool, record: &RayHit, indices: &[u32]) -> Found {
    if hit { Found { t: record.t, triangle: indices[record.primitive_id as usize] } } else { Found::MISS }
}

struct Two {
    bvh: Bvh2,
    copies: Vec<RtTriangle>,
}

struct Wide {
    bvh: CwBvh,
    copies: Vec<RtTriangle>,
}

struct WideMesh {
    bvh: CwBvh,
    mesh: Arc<TriangleMesh>,
}

/// The three differ in types only; `$test` gives t for a position in the leaves' order.
macro_rules! traced {
    ($type:ty, $node:ty, $test:expr, $bytes:expr) => {
        impl Traced for $type {
            fn closest(&self, rays: &[Ray], slots: &mut [Found]) {
                let test = $test;
                for (ray, slot) in rays.iter().zip(slots) {
                    let mut record = RayHit::none();
                    let hit = self.bvh.ray_traverse(convert(ray), &mut record, |r, k| test(self, r, k));
                    *slot = found(hit, &record, &self.bvh.primitive_indices);
                }
            }

            fn any(&self, rays: &[Ray], blocked: &mut [bool]) {
                let test = $test;
                for (ray, slot) in rays.iter().zip(blocked) {
                    *slot = !self.bvh.ray_traverse_miss(convert(ray), |r, k| test(self, r, k));
                }
            }

            fn bytes(&self, _counted: u64) -> Bytes {
                let nodes = self.bvh.nodes.len() * size_of::<$node>();
                let indices = self.bvh.primitive_indices.len() * size_of::<u32>();
                let (copies, mesh_read) = $bytes(self);
                Bytes { structure: (nodes + indices) as u64, copies, mesh_read, source: SizeSource::Exact }
            }
        }
    };
}

traced!(Two, Bvh2Node, |this: &Two, ray: &ObvhsRay, k: usize| this.copies[k].intersect(ray), |this: &Two| (
    (this.copies.len() * size_of::<RtTriangle>()) as u64,
    0
));
traced!(
    Wide,
    CwBvhNode,
    |this: &Wide, ray: &ObvhsRay, k: usize| this.copies[k].intersect(ray),
    |this: &Wide| ((this.copies.len() * size_of::<RtTriangle>()) as u64, 0)
);
traced!(
    WideMesh,
    CwBvhNode,
    |this: &WideMesh, ray: &ObvhsRay, k: usize| {
        triangle(&this.mesh, this.bvh.primitive_indices[k]).intersect(ray)
    },
    |this: &WideMesh| (0, this.mesh.memory_bytes())
);
