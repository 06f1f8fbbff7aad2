//! Packets: 16 rays where Embree says that it supports them natively, else 8.

use super::Built;
use super::abi::*;
use crate::bench::built::{Found, PIECE};
use slimkd::Ray;
use std::ffi::{c_int, c_void};
use std::time::{Duration, Instant};

/// `rtcIntersect16` or `rtcIntersect8`; `rtcOccluded` alike.
type Trace<T> = unsafe extern "C" fn(*const c_int, Handle, *mut T, *const c_void);

/// Which of a packet's rays are there.
#[repr(C, align(64))]
struct Valid<const N: usize>([c_int; N]);

/// Packets of a piece, packed before the clock runs and unpacked after it stops: each library gets its own layout, out of
/// the cache. Returns the time that was not tracing.
fn in_pieces<const N: usize, T: Copy, O>(
    rays: &[Ray],
    answers: &mut [O],
    (none, trace): (T, impl Fn(&Valid<N>, &mut T)),
    pack: impl Fn(&mut T, usize, &Ray),
    unpack: impl Fn(&T, usize) -> O,
) -> Duration {
    let start = Instant::now();
    let mut tracing = Duration::ZERO;
    let mut packets = vec![none; PIECE / N];
    for (rays, answers) in rays.chunks(PIECE).zip(answers.chunks_mut(PIECE)) {
        let packets = &mut packets[..rays.len().div_ceil(N)];
        for (packet, rays) in packets.iter_mut().zip(rays.chunks(N)) {
            *packet = none;
            rays.iter().enumerate().for_each(|(lane, ray)| pack(packet, lane, ray));
        }
        let clock = Instant::now();
        for (index, packet) in packets.iter_mut().enumerate() {
            let valid = Valid(std::array::from_fn(|lane| -c_int::from(index * N + lane < rays.len())));
            trace(&valid, packet);
        }
        tracing += clock.elapsed();
        for (index, slot) in answers.iter_mut().enumerate() {
            *slot = unpack(&packets[index / N], index % N);
        }
    }
    start.elapsed() - tracing
}

fn arguments(coherent: bool) -> RtcArguments {
    RtcArguments { flags: if coherent { QUERY_COHERENT } else { 0 }, ..RtcArguments::DEFAULT }
}

impl Built {
    pub(super) fn closest_packets(&self, coherent: bool, rays: &[Ray], found: &mut [Found]) -> Duration {
        let api = &self.library.api;
        match self.wide {
            true => self.closest_by(api.intersect16, coherent, rays, found),
            false => self.closest_by(api.intersect8, coherent, rays, found),
        }
    }

    pub(super) fn any_packets(&self, coherent: bool, rays: &[Ray], blocked: &mut [bool]) -> Duration {
        let api = &self.library.api;
        match self.wide {
            true => self.any_by(api.occluded16, coherent, rays, blocked),
            false => self.any_by(api.occluded8, coherent, rays, blocked),
        }
    }

    fn closest_by<const N: usize>(
        &self,
        call: Trace<RtcRayHitN<N>>,
        coherent: bool,
        rays: &[Ray],
        found: &mut [Found],
    ) -> Duration {
        let arguments = arguments(coherent);
        // SAFETY: a committed scene, a packet of the right size and alignment, arguments as the header has them.
        let trace = |valid: &Valid<N>, packet: &mut RtcRayHitN<N>| unsafe {
            call(valid.0.as_ptr(), self.scene, packet, (&raw const arguments).cast());
        };
        let pack = |packet: &mut RtcRayHitN<N>, lane, ray: &Ray| packet.ray.set(lane, ray);
        let unpack = |packet: &RtcRayHitN<N>, lane: usize| match packet.hit.geometry[lane] {
            INVALID => Found::MISS,
            _ => Found { t: packet.ray.tfar[lane], triangle: packet.hit.primitive[lane] },
        };
        in_pieces(rays, found, (RtcRayHitN::NONE, trace), pack, unpack)
    }

    fn any_by<const N: usize>(
        &self,
        call: Trace<RtcRayN<N>>,
        coherent: bool,
        rays: &[Ray],
        blocked: &mut [bool],
    ) -> Duration {
        let arguments = arguments(coherent);
        // SAFETY: as above.
        let trace = |valid: &Valid<N>, packet: &mut RtcRayN<N>| unsafe {
            call(valid.0.as_ptr(), self.scene, packet, (&raw const arguments).cast());
        };
        let pack = |packet: &mut RtcRayN<N>, lane, ray: &Ray| packet.set(lane, ray);
        // An occluded ray comes back with tfar = -inf.
        let unpack = |packet: &RtcRayN<N>, lane: usize| packet.tfar[lane] == f32::NEG_INFINITY;
        in_pieces(rays, blocked, (RtcRayN::NONE, trace), pack, unpack)
    }
}
