//! Intel Embree 4, loaded while running so that nobody needs it to build this crate.

mod abi;
mod library;
mod packet;

pub use library::{Library, LoadError};

use crate::bench::built::{Bytes, Contender, Found, Info, Interface, SizeSource, Traced};
use abi::*;
use slimkd::{InstructionSet, Ray, TriangleMesh};
use std::ffi::{CString, c_int, c_void};
use std::sync::Arc;
use std::sync::atomic::{AtomicIsize, Ordering::Relaxed};
use std::time::Duration;

/// The settings that are measured. HIGH has no effect together with COMPACT or ROBUST, so these are all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Defaults.
    Medium,
    /// Spatial splits.
    High,
    /// Compressed nodes, indexed leaves.
    Compact,
    /// Watertight tests.
    Robust,
}

impl Variant {
    /// All of them, in table order.
    pub const ALL: &[Self] = &[Self::Medium, Self::High, Self::Compact, Self::Robust];

    fn name(self) -> &'static str {
        match self {
            Self::Medium => super::EMBREE,
            Self::High => "embree-high",
            Self::Compact => "embree-compact",
            Self::Robust => "embree-robust",
        }
    }

    fn settings(self) -> (&'static str, c_int, c_int) {
        match self {
            Self::Medium => ("quality MEDIUM, no flags", QUALITY_MEDIUM, 0),
            Self::High => ("quality HIGH, no flags", QUALITY_HIGH, 0),
            Self::Compact => ("quality MEDIUM, COMPACT", QUALITY_MEDIUM, SCENE_COMPACT),
            Self::Robust => ("quality MEDIUM, ROBUST", QUALITY_MEDIUM, SCENE_ROBUST),
        }
    }

    /// Leaves of this one hold indices (Triangle4i); those of the others hold corners (Triangle4, and with ROBUST
    /// Triangle4v), as `Scene::createTriangleAccel` in Embree's kernels/common/scene.cpp chooses.
    fn reads_mesh(self) -> bool {
        self == Self::Compact
    }
}

/// Embree with one set of options.
pub struct Embree {
    library: Arc<Library>,
    variant: Variant,
    isa: Option<InstructionSet>,
}

impl Embree {
    /// One variant of a loaded library, held to an instruction set or free to choose.
    pub fn new(library: Arc<Library>, variant: Variant, isa: Option<InstructionSet>) -> Self {
        Self { library, variant, isa }
    }
}

impl Contender for Embree {
    fn info(&self) -> Info {
        let settings = self.variant.settings().0;
        Info {
            name: self.variant.name().into(),
            library: "embree",
            version: self.library.version.clone(),
            settings: format!(
                "{settings}; rtcIntersect1 / rtcOccluded1, packets of 16 with AVX-512 and of 8 below; returns u, v and a \
                 normal; instruction set {}; denormals not flushed",
                self.isa.map_or("chosen while running", InstructionSet::name)
            ),
            sah: "Embree's own (binned; spatial splits with HIGH), not settable here".into(),
        }
    }

    fn build(&self, mesh: &Arc<TriangleMesh>, threads: usize) -> Result<Box<dyn Traced>, String> {
        Ok(Box::new(Built::new(self, mesh, threads)?))
    }
}

/// A committed scene.
struct Built {
    library: Arc<Library>,
    variant: Variant,
    device: Handle,
    scene: Handle,
    /// Packets have 16 rays, not 8.
    wide: bool,
    /// x, y, z of each vertex, and 16 bytes that Embree may read past the end.
    _vertices: Vec<f32>,
    mesh: Arc<TriangleMesh>,
    /// Written by Embree's memory monitor until the device is gone.
    allocated: Box<AtomicIsize>,
}

// SAFETY: a committed scene may be traced by any number of threads, says Embree's API manual ("performing ray queries
// in a scene is thread-safe"); nothing else happens to it until it is dropped.
unsafe impl Send for Built {}
// SAFETY: as above.
unsafe impl Sync for Built {}

/// Adds up what Embree allocates and frees.
unsafe extern "C" fn monitor(user: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: `user` is `Built::allocated`, which outlives the device.
    let allocated = unsafe { &*user.cast::<AtomicIsize>() };
    allocated.fetch_add(bytes, Relaxed);
    true
}

impl Built {
    fn new(embree: &Embree, mesh: &Arc<TriangleMesh>, threads: usize) -> Result<Self, String> {
        let api = &embree.library.api;
        let mut vertices: Vec<f32> = Vec::with_capacity(3 * mesh.vertices().len() + 4);
        vertices.extend(mesh.vertices().iter().flatten());
        vertices.extend([0.0; 4]);
        // `isa` alone would leave out the levels below it, which other parts of Embree are compiled for.
        let isa = embree.isa.map_or(String::new(), |isa| format!(",max_isa={}", isa.name()));
        let config = CString::new(format!("threads={threads}{isa}")).map_err(|error| error.to_string())?;
        let (_, quality, flags) = embree.variant.settings();
        let allocated = Box::new(AtomicIsize::new(0));
        // SAFETY: the calls and their order are those of the API manual. The counter, the vertices (padded) and the
        // mesh that holds the indices are stored in `Built` and so outlive scene and device.
        let (device, scene, wide, error) = unsafe {
            let device = (api.new_device)(config.as_ptr());
            if device.is_null() {
                return Err("Embree makes no device".into());
            }
            (api.set_memory_monitor)(device, Some(monitor), (&raw const *allocated).cast_mut().cast());
            let scene = (api.new_scene)(device);
            (api.set_scene_flags)(scene, flags);
            (api.set_scene_quality)(scene, quality);
            let geometry = (api.new_geometry)(device, GEOMETRY_TRIANGLE);
            let share = |kind, format, data: *const c_void, count| {
                (api.set_shared_buffer)(geometry, kind, 0, format, data, 0, 12, count);
            };
            share(BUFFER_VERTEX, FORMAT_FLOAT3, vertices.as_ptr().cast(), mesh.vertices().len());
            share(BUFFER_INDEX, FORMAT_UINT3, mesh.triangles().as_ptr().cast(), mesh.len());
            (api.commit_geometry)(geometry);
            (api.attach_geometry)(scene, geometry);
            (api.release_geometry)(geometry);
            (api.commit_scene)(scene);
            let wide = (api.device_property)(device, PROPERTY_RAY16) != 0;
            (device, scene, wide, (api.device_error)(device))
        };
        let (library, variant) = (embree.library.clone(), embree.variant);
        let built = Self {
            library,
            variant,
            device,
            scene,
            wide,
            _vertices: vertices,
            mesh: mesh.clone(),
            allocated,
        };
        if error == 0 { Ok(built) } else { Err(format!("Embree reports error {error}")) }
    }

    #[inline(always)]
    fn ray(ray: &Ray) -> RtcRay {
        RtcRay {
            origin: ray.origin,
            tnear: ray.t_min,
            direction: ray.direction,
            time: 0.0,
            tfar: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
        }
    }
}

impl Drop for Built {
    fn drop(&mut self) {
        let api = &self.library.api;
        // SAFETY: both are owned here and released once, the scene before its device.
        unsafe {
            (api.release_scene)(self.scene);
            (api.release_device)(self.device);
        }
    }
}

impl Traced for Built {
    fn closest(&self, rays: &[Ray], found: &mut [Found]) {
        let intersect = self.library.api.intersect;
        for (ray, slot) in rays.iter().zip(found) {
            let hit = RtcHit {
                normal: [0.0; 3],
                u: 0.0,
                v: 0.0,
                primitive: INVALID,
                geometry: INVALID,
                instance: INVALID,
                instance_primitive: INVALID,
            };
            let mut query = RtcRayHit { ray: Self::ray(ray), hit };
            // SAFETY: a committed scene, a query of the right size and alignment, default arguments (null).
            unsafe { intersect(self.scene, &mut query, std::ptr::null()) };
            *slot = if query.hit.geometry == INVALID {
                Found::MISS
            } else {
                Found { t: query.ray.tfar, triangle: query.hit.primitive }
            };
        }
    }

    fn any(&self, rays: &[Ray], blocked: &mut [bool]) {
        let occluded = self.library.api.occluded;
        for (ray, slot) in rays.iter().zip(blocked) {
            let mut query = Self::ray(ray);
            // SAFETY: as above; an occluded ray comes back with tfar = -inf.
            unsafe { occluded(self.scene, &mut query, std::ptr::null()) };
            *slot = query.tfar == f32::NEG_INFINITY;
        }
    }

    fn interfaces(&self) -> &'static [Interface] {
        &[Interface::Single, Interface::PacketCoherent, Interface::PacketDefault]
    }

    fn closest_through(&self, interface: Interface, rays: &[Ray], found: &mut [Found]) -> Duration {
        if interface == Interface::Single {
            self.closest(rays, found);
            return Duration::ZERO;
        }
        self.closest_packets(interface == Interface::PacketCoherent, rays, found)
    }

    fn any_through(&self, interface: Interface, rays: &[Ray], blocked: &mut [bool]) -> Duration {
        if interface == Interface::Single {
            self.any(rays, blocked);
            return Duration::ZERO;
        }
        self.any_packets(interface == Interface::PacketCoherent, rays, blocked)
    }

    fn bytes(&self, _counted: u64) -> Bytes {
        let mesh_read = if self.variant.reads_mesh() { self.mesh.memory_bytes() } else { 0 };
        let structure = self.allocated.load(Relaxed).max(0) as u64;
        Bytes { structure, copies: 0, mesh_read, source: SizeSource::OwnReport }
    }
}
