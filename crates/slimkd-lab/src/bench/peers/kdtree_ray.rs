//! kdtree-ray: an SAH kd-tree that returns every triangle of the leaves along a ray; the user intersects them.

use super::locked_version;
use super::triangle::{Corners, all_corners, intersect};
use crate::bench::built::{Bytes, Contender, Found, Info, SizeSource, Traced};
use cgmath::Vector3;
use kdtree_ray::{AABB, Bounded, BuilderConfig, KDTree};
use slimkd::{Ray, TriangleMesh};
use std::sync::Arc;

/// Its build takes half a minute for a million triangles and traces a hundredth of the others' rate there.
const MOST_TRIANGLES: usize = 300_000;

pub(super) struct KdTreeRay;

struct Boxed<'a>(&'a Corners);

impl Bounded for Boxed<'_> {
    fn bound(&self) -> AABB {
        let low = |k: usize| self.0.iter().map(|c| c[k]).fold(f32::INFINITY, f32::min);
        let high = |k: usize| self.0.iter().map(|c| c[k]).fold(f32::NEG_INFINITY, f32::max);
        AABB::new(Vector3::new(low(0), low(1), low(2)), Vector3::new(high(0), high(1), high(2)))
    }
}

impl Contender for KdTreeRay {
    fn info(&self) -> Info {
        let config = BuilderConfig::default();
        Info {
            name: "kdtree-ray".into(),
            library: "kdtree-ray",
            version: locked_version("kdtree-ray"),
            settings: "defaults; own loop over the returned candidates; own two-sided triangle test".into(),
            sah: format!(
                "traversal {}, intersection {}, empty bonus {}",
                config.cost_traversal(),
                config.cost_intersection(),
                1.0 - config.empty_cut_bonus()
            ),
        }
    }

    fn too_slow(&self, mesh: &TriangleMesh) -> Option<String> {
        (mesh.len() > MOST_TRIANGLES).then(|| {
            format!("builds for minutes over more than {MOST_TRIANGLES} triangles; `--all` takes it in")
        })
    }

    fn threads_controllable(&self) -> bool {
        false
    }

    fn build(&self, mesh: &Arc<TriangleMesh>, _threads: usize) -> Result<Box<dyn Traced>, String> {
        if mesh.is_empty() {
            return Err("kdtree-ray panics over an empty mesh".into());
        }
        let copies = all_corners(mesh);
        let boxed: Vec<Boxed<'_>> = copies.iter().map(Boxed).collect();
        let tree = KDTree::build(&boxed);
        drop(boxed);
        Ok(Box::new(Built { tree, copies }))
    }
}

struct Built {
    tree: KDTree,
    copies: Vec<Corners>,
}

impl Traced for Built {
    fn closest(&self, rays: &[Ray], found: &mut [Found]) {
        for (ray, slot) in rays.iter().zip(found) {
            *slot = Found::MISS;
            for id in self.tree.intersect(&ray.origin.into(), &ray.direction.into()) {
                let t = intersect(&self.copies[id], ray);
                if t < slot.t {
                    *slot = Found { t, triangle: id as u32 };
                }
            }
        }
    }

    fn any(&self, rays: &[Ray], blocked: &mut [bool]) {
        for (ray, slot) in rays.iter().zip(blocked) {
            let candidates = self.tree.intersect(&ray.origin.into(), &ray.direction.into());
            *slot = candidates.into_iter().any(|id| intersect(&self.copies[id], ray) < f32::INFINITY);
        }
    }

    fn bytes(&self, counted: u64) -> Bytes {
        let copies = (self.copies.len() * size_of::<Corners>()) as u64;
        Bytes { structure: counted.saturating_sub(copies), copies, mesh_read: 0, source: SizeSource::Counted }
    }
}
