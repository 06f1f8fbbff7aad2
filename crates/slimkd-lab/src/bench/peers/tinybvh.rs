//! tinybvh through tinybvh-rs: BVH8_CPU, binned and with spatial splits.

use super::{Absent, locked_version};
use crate::bench::built::Contender;
#[cfg(target_feature = "avx2")]
use crate::bench::built::{Bytes, Found, Info, SizeSource, Traced};

/// The wrapper traces BVH8_CPU only where the whole program is compiled for AVX2.
#[cfg(not(target_feature = "avx2"))]
pub(super) fn register(_peers: &mut Vec<Box<dyn Contender>>, absent: &mut Vec<Absent>) {
    absent.push(Absent {
        name: "tinybvh".into(),
        reason: format!(
            "tinybvh-rs {} traces only in programs compiled for AVX2; set RUSTFLAGS=\"-C target-cpu=native\"",
            locked_version("tinybvh-rs")
        ),
    });
}

/// Adds both variants.
#[cfg(target_feature = "avx2")]
pub(super) fn register(peers: &mut Vec<Box<dyn Contender>>, _absent: &mut Vec<Absent>) {
    peers.push(Box::new(measured::TinyBvh { splits: false }));
    peers.push(Box::new(measured::TinyBvh { splits: true }));
}

#[cfg(target_feature = "avx2")]
mod measured {
    use super::*;
    use slimkd::{Ray, TriangleMesh};
    use std::sync::Arc;
    use tinybvh_rs::{Intersection, Intersector, Ray as TinyRay, bvh, bvh8_cpu, mbvh};

    pub(super) struct TinyBvh {
        pub(super) splits: bool,
    }

    impl Contender for TinyBvh {
        fn info(&self) -> Info {
            let (name, build) =
                if self.splits { ("tinybvh-bvh8-hq", "BuildHQ") } else { ("tinybvh-bvh8", "Build") };
            Info {
                name: name.into(),
                library: "tinybvh-rs",
                version: locked_version("tinybvh-rs"),
                settings: format!("{build}, split leaves of 4, BVH8_CPU; no occlusion call; returns u, v"),
                sah: "C_TRAV 1, C_INT 1 (its defaults)".into(),
            }
        }

        fn threads_controllable(&self) -> bool {
            false
        }

        fn build(&self, mesh: &Arc<TriangleMesh>, _threads: usize) -> Result<Box<dyn Traced>, String> {
            let before = allocated();
            let corners: Vec<[f32; 4]> = (0..mesh.len() as u32)
                .flat_map(|id| mesh.corners(id))
                .map(|[x, y, z]| [x, y, z, 0.0])
                .collect();
            let text = |error: tinybvh_rs::Error| error.to_string();
            let tree = {
                let positions = pas::Slice::from(corners.as_slice());
                let mut two =
                    if self.splits { bvh::BVH::new_hq(positions) } else { bvh::BVH::new(positions) }
                        .map_err(text)?;
                two.split_leaves(4);
                bvh8_cpu::BVH::new(&mbvh::BVH::new(&two)).map_err(text)?
            };
            drop(corners);
            Ok(Box::new(Built { tree, bytes: allocated().saturating_sub(before) }))
        }
    }

    /// Bytes that the C allocator has handed out: the wrapper tells no size. Freed and mapped blocks are counted right.
    fn allocated() -> u64 {
        // SAFETY: takes nothing, returns figures.
        let info = unsafe { libc::mallinfo2() };
        (info.uordblks + info.hblkhd) as u64
    }

    struct Built {
        tree: bvh8_cpu::BVH,
        bytes: u64,
    }

    // SAFETY: tracing reads the C++ tree and writes the ray alone; nothing changes the tree after its build.
    unsafe impl Send for Built {}
    // SAFETY: as above.
    unsafe impl Sync for Built {}

    /// The C++ `Ray` is aligned to 64 bytes, the wrapper's to 16: aligned stores would fault.
    #[repr(C, align(64))]
    struct Aligned(TinyRay);

    impl Built {
        #[inline(always)]
        fn trace(&self, ray: &Ray) -> Found {
            let mut query = Aligned(TinyRay {
                origin: ray.origin,
                dir: ray.direction,
                // tinybvh's own rcp for zero components is 1e30 too; infinities would turn into NaN inside.
                r_d: ray.direction.map(|x| if x.abs() > 1e-12 { 1.0 / x } else { 1e30f32.copysign(x) }),
                hit: Intersection { t: ray.t_max.min(tinybvh_rs::INFINITE), ..Intersection::default() },
                ..TinyRay::default()
            });
            let limit = query.0.hit.t;
            self.tree.intersect(&mut query.0);
            let hit = query.0.hit;
            if hit.t < limit { Found { t: hit.t, triangle: hit.prim } } else { Found::MISS }
        }
    }

    impl Traced for Built {
        fn closest(&self, rays: &[Ray], found: &mut [Found]) {
            rays.iter().zip(found).for_each(|(ray, slot)| *slot = self.trace(ray));
        }

        fn any(&self, rays: &[Ray], blocked: &mut [bool]) {
            rays.iter().zip(blocked).for_each(|(ray, slot)| *slot = self.trace(ray).is_hit());
        }

        fn bytes(&self, _counted: u64) -> Bytes {
            Bytes { structure: self.bytes, copies: 0, mesh_read: 0, source: SizeSource::Counted }
        }
    }
}
