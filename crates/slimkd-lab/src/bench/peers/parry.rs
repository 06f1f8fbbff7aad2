//! parry3d: the collision library's triangle mesh with its BVH2.

use super::locked_version;
use crate::bench::built::{Bytes, Contender, Found, Info, SizeSource, Traced};
use parry3d::math::Vector;
use parry3d::query::{Ray as ParryRay, RayCast};
use parry3d::shape::{CompositeShapeRef, TriMesh};
use slimkd::{Ray, TriangleMesh};
use std::sync::Arc;

pub(super) struct Parry;

impl Contender for Parry {
    fn info(&self) -> Info {
        Info {
            name: "parry3d".into(),
            library: "parry3d",
            version: locked_version("parry3d"),
            settings: "TriMesh without flags; no any-hit call, so a cast up to t_max; returns a normal"
                .into(),
            sah: "binned, one triangle a leaf, no constants".into(),
        }
    }

    fn build(&self, mesh: &Arc<TriangleMesh>, _threads: usize) -> Result<Box<dyn Traced>, String> {
        let vertices = mesh.vertices().iter().map(|&[x, y, z]| Vector::new(x, y, z)).collect();
        let mesh = TriMesh::new(vertices, mesh.triangles().to_vec()).map_err(|error| error.to_string())?;
        Ok(Box::new(Built(mesh)))
    }
}

struct Built(TriMesh);

fn convert(ray: &Ray) -> (ParryRay, f32) {
    let vector = |[x, y, z]: [f32; 3]| Vector::new(x, y, z);
    (ParryRay::new(vector(ray.origin), vector(ray.direction)), ray.t_max.min(f32::MAX))
}

impl Traced for Built {
    fn closest(&self, rays: &[Ray], found: &mut [Found]) {
        for (ray, slot) in rays.iter().zip(found) {
            let (theirs, t_max) = convert(ray);
            *slot = CompositeShapeRef(&self.0)
                .cast_local_ray(&theirs, t_max, false)
                .map_or(Found::MISS, |(triangle, t)| Found { t, triangle });
        }
    }

    fn any(&self, rays: &[Ray], blocked: &mut [bool]) {
        for (ray, slot) in rays.iter().zip(blocked) {
            let (theirs, t_max) = convert(ray);
            *slot = self.0.cast_local_ray(&theirs, t_max, false).is_some();
        }
    }

    fn bytes(&self, _counted: u64) -> Bytes {
        let mesh = size_of_val(self.0.vertices()) + size_of_val(self.0.indices());
        Bytes {
            structure: self.0.bvh().total_memory_size() as u64,
            copies: 0,
            mesh_read: mesh as u64,
            source: SizeSource::OwnReport,
        }
    }
}
