//! The part of Embree 4's C interface that is used, declared by hand: the wheel that carries the library carries no
//! header. Names and values follow `include/embree4/rtcore*.h` of Embree 4.4 (Apache-2.0).

use std::ffi::{c_char, c_int, c_uint, c_void};

/// `RTC_INVALID_GEOMETRY_ID`
pub(super) const INVALID: u32 = u32::MAX;
/// `RTC_GEOMETRY_TYPE_TRIANGLE`
pub(super) const GEOMETRY_TRIANGLE: c_int = 0;
/// `RTC_BUFFER_TYPE_INDEX`
pub(super) const BUFFER_INDEX: c_int = 0;
/// `RTC_BUFFER_TYPE_VERTEX`
pub(super) const BUFFER_VERTEX: c_int = 1;
/// `RTC_FORMAT_UINT3`
pub(super) const FORMAT_UINT3: c_int = 0x5003;
/// `RTC_FORMAT_FLOAT3`
pub(super) const FORMAT_FLOAT3: c_int = 0x9003;
/// `RTC_SCENE_FLAG_COMPACT`
pub(super) const SCENE_COMPACT: c_int = 1 << 1;
/// `RTC_SCENE_FLAG_ROBUST`
pub(super) const SCENE_ROBUST: c_int = 1 << 2;
/// `RTC_BUILD_QUALITY_MEDIUM`
pub(super) const QUALITY_MEDIUM: c_int = 1;
/// `RTC_BUILD_QUALITY_HIGH`
pub(super) const QUALITY_HIGH: c_int = 2;
/// `RTC_DEVICE_PROPERTY_VERSION`
pub(super) const PROPERTY_VERSION: c_int = 0;
/// `RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED`
pub(super) const PROPERTY_RAY16: c_int = 34;
/// `RTC_RAY_QUERY_FLAG_COHERENT`
pub(super) const QUERY_COHERENT: c_int = 1 << 16;

/// `RTCDevice`, `RTCScene` and `RTCGeometry` are pointers to what only Embree knows.
pub(super) type Handle = *mut c_void;

/// `RTCRay`
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(super) struct RtcRay {
    pub(super) origin: [f32; 3],
    pub(super) tnear: f32,
    pub(super) direction: [f32; 3],
    pub(super) time: f32,
    pub(super) tfar: f32,
    pub(super) mask: u32,
    pub(super) id: u32,
    pub(super) flags: u32,
}

/// `RTCHit`, with instance arrays as the wheel's build has them.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(super) struct RtcHit {
    pub(super) normal: [f32; 3],
    pub(super) u: f32,
    pub(super) v: f32,
    pub(super) primitive: u32,
    pub(super) geometry: u32,
    pub(super) instance: u32,
    pub(super) instance_primitive: u32,
}

/// `RTCRayHit`
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(super) struct RtcRayHit {
    pub(super) ray: RtcRay,
    pub(super) hit: RtcHit,
}

/// `RTCRay16`, `RTCRay8`
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct RtcRayN<const N: usize> {
    pub(super) origin: [[f32; N]; 3],
    pub(super) tnear: [f32; N],
    pub(super) direction: [[f32; N]; 3],
    pub(super) time: [f32; N],
    pub(super) tfar: [f32; N],
    pub(super) mask: [u32; N],
    pub(super) id: [u32; N],
    pub(super) flags: [u32; N],
}

impl<const N: usize> RtcRayN<N> {
    /// No rays.
    pub(super) const NONE: Self = Self {
        origin: [[0.0; N]; 3],
        tnear: [0.0; N],
        direction: [[0.0; N]; 3],
        time: [0.0; N],
        tfar: [0.0; N],
        mask: [u32::MAX; N],
        id: [0; N],
        flags: [0; N],
    };

    /// Puts a ray into a lane.
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, ray: &slimkd::Ray) {
        for k in 0..3 {
            self.origin[k][lane] = ray.origin[k];
            self.direction[k][lane] = ray.direction[k];
        }
        (self.tnear[lane], self.tfar[lane]) = (ray.t_min, ray.t_max);
    }
}

/// `RTCHit16`, `RTCHit8`, as [`RtcHit`]
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct RtcHitN<const N: usize> {
    pub(super) normal: [[f32; N]; 3],
    pub(super) u: [f32; N],
    pub(super) v: [f32; N],
    pub(super) primitive: [u32; N],
    pub(super) geometry: [u32; N],
    pub(super) instance: [u32; N],
    pub(super) instance_primitive: [u32; N],
}

/// `RTCRayHit16`, `RTCRayHit8`
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct RtcRayHitN<const N: usize> {
    pub(super) ray: RtcRayN<N>,
    pub(super) hit: RtcHitN<N>,
}

impl<const N: usize> RtcRayHitN<N> {
    /// No rays, no hits.
    pub(super) const NONE: Self = Self {
        ray: RtcRayN::NONE,
        hit: RtcHitN {
            normal: [[0.0; N]; 3],
            u: [0.0; N],
            v: [0.0; N],
            primitive: [INVALID; N],
            geometry: [INVALID; N],
            instance: [INVALID; N],
            instance_primitive: [INVALID; N],
        },
    };
}

/// `RTCIntersectArguments`, `RTCOccludedArguments`
#[repr(C)]
pub(super) struct RtcArguments {
    pub(super) flags: c_int,
    pub(super) features: c_int,
    pub(super) context: *mut c_void,
    pub(super) filter: *const c_void,
    pub(super) callback: *const c_void,
    /// Only where Embree was compiled with `RTC_MIN_WIDTH`.
    pub(super) min_width: f32,
}

impl RtcArguments {
    /// As `rtcInitIntersectArguments`.
    pub(super) const DEFAULT: Self = Self {
        flags: 0,
        features: -1,
        context: std::ptr::null_mut(),
        filter: std::ptr::null(),
        callback: std::ptr::null(),
        min_width: 0.0,
    };
}

// Embree writes into these: a wrong size would be memory corruption.
const _: () = assert!(size_of::<RtcRay>() == 48 && size_of::<RtcRayHit>() == 96);
const _: () = assert!(size_of::<RtcRayN<16>>() == 768 && size_of::<RtcRayHitN<16>>() == 1344);
const _: () = assert!(size_of::<RtcRayN<8>>() == 384 && size_of::<RtcHitN<8>>() == 288);

/// `RTCMemoryMonitorFunction`
pub(super) type Monitor = unsafe extern "C" fn(user: *mut c_void, bytes: isize, post: bool) -> bool;

/// Declares the table of entry points and how it is filled from a library.
macro_rules! entry_points {
    ($($field:ident = $symbol:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The entry points in use; valid as long as the library stays loaded.
        pub(super) struct Api {
            $(pub(super) $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Api {
            /// # Safety
            /// `library` must be an Embree 4, and must outlive the table.
            pub(super) unsafe fn new(library: &libloading::Library) -> Result<Self, libloading::Error> {
                Ok(Self {
                    // SAFETY: the caller says that it is Embree 4, whose header gives these signatures.
                    $($field: unsafe { *library.get(concat!($symbol, "\0").as_bytes())? },)*
                })
            }
        }
    };
}

entry_points! {
    new_device = "rtcNewDevice": fn(*const c_char) -> Handle;
    release_device = "rtcReleaseDevice": fn(Handle);
    device_error = "rtcGetDeviceError": fn(Handle) -> c_int;
    device_property = "rtcGetDeviceProperty": fn(Handle, c_int) -> isize;
    set_memory_monitor = "rtcSetDeviceMemoryMonitorFunction": fn(Handle, Option<Monitor>, *mut c_void);
    new_scene = "rtcNewScene": fn(Handle) -> Handle;
    set_scene_flags = "rtcSetSceneFlags": fn(Handle, c_int);
    set_scene_quality = "rtcSetSceneBuildQuality": fn(Handle, c_int);
    commit_scene = "rtcCommitScene": fn(Handle);
    release_scene = "rtcReleaseScene": fn(Handle);
    new_geometry = "rtcNewGeometry": fn(Handle, c_int) -> Handle;
    set_shared_buffer = "rtcSetSharedGeometryBuffer":
        fn(Handle, c_int, c_uint, c_int, *const c_void, usize, usize, usize);
    commit_geometry = "rtcCommitGeometry": fn(Handle);
    attach_geometry = "rtcAttachGeometry": fn(Handle, Handle) -> c_uint;
    release_geometry = "rtcReleaseGeometry": fn(Handle);
    intersect = "rtcIntersect1": fn(Handle, *mut RtcRayHit, *const c_void);
    occluded = "rtcOccluded1": fn(Handle, *mut RtcRay, *const c_void);
    intersect16 = "rtcIntersect16": fn(*const c_int, Handle, *mut RtcRayHitN<16>, *const c_void);
    occluded16 = "rtcOccluded16": fn(*const c_int, Handle, *mut RtcRayN<16>, *const c_void);
    intersect8 = "rtcIntersect8": fn(*const c_int, Handle, *mut RtcRayHitN<8>, *const c_void);
    occluded8 = "rtcOccluded8": fn(*const c_int, Handle, *mut RtcRayN<8>, *const c_void);
}
