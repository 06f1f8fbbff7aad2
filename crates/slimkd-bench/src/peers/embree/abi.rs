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

// Embree writes into these: a wrong size would be memory corruption.
const _: () = assert!(size_of::<RtcRay>() == 48 && size_of::<RtcRayHit>() == 96);

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
}
