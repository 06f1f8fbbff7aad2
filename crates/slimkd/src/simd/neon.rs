//! NEON: 4 lanes, what every 64-bit ARM has. Gathers, permutes and compression go through memory.
//!
//! Compiles with the toolchain's target; untested, for want of such a machine.

use super::macros::{methods, operators, through_memory, vectors};
use super::{Quad, Shear, Simd, lanes, quad_one_by_one};
use std::arch::aarch64::*;
use std::array::from_fn;

const WIDTH: usize = 4;

vectors! {
    Neon proves "NEON";
    F32(float32x4_t), F64(float64x2_t, float64x2_t), U32(uint32x4_t), Mask(uint32x4_t)
}

operators! {
    F32 {
        Add::add = |a, b| F32(vaddq_f32(a.0, b.0));
        Sub::sub = |a, b| F32(vsubq_f32(a.0, b.0));
        Mul::mul = |a, b| F32(vmulq_f32(a.0, b.0));
        Div::div = |a, b| F32(vdivq_f32(a.0, b.0));
    }
    F64 {
        Add::add = |a, b| F64(vaddq_f64(a.0, b.0), vaddq_f64(a.1, b.1));
        Sub::sub = |a, b| F64(vsubq_f64(a.0, b.0), vsubq_f64(a.1, b.1));
        Mul::mul = |a, b| F64(vmulq_f64(a.0, b.0), vmulq_f64(a.1, b.1));
        Div::div = |a, b| F64(vdivq_f64(a.0, b.0), vdivq_f64(a.1, b.1));
    }
    U32 {
        Add::add = |a, b| U32(vaddq_u32(a.0, b.0));
        Sub::sub = |a, b| U32(vsubq_u32(a.0, b.0));
        BitAnd::bitand = |a, b| U32(vandq_u32(a.0, b.0));
        BitOr::bitor = |a, b| U32(vorrq_u32(a.0, b.0));
        BitXor::bitxor = |a, b| U32(veorq_u32(a.0, b.0));
        Shl::shl = |a, by: u32| U32(vshlq_u32(a.0, vdupq_n_s32(by as i32)));
        Shr::shr = |a, by: u32| U32(vshlq_u32(a.0, vdupq_n_s32(-(by as i32))));
    }
    Mask {
        BitAnd::bitand = |a, b| Mask(vandq_u32(a.0, b.0));
        BitOr::bitor = |a, b| Mask(vorrq_u32(a.0, b.0));
        Not::not = |a| Mask(vmvnq_u32(a.0));
    }
}

impl Simd for Neon {
    const WIDTH: usize = WIDTH;
    type F = F32;
    type D = F64;
    type U = U32;
    type Frame = Shear;
    type M = Mask;

    #[inline(always)]
    fn frame(self, shear: &Shear) -> Shear {
        *shear
    }
    #[inline(always)]
    unsafe fn quad(
        self,
        frame: &Shear,
        corners: &[[*const [f32; 3]; 3]; 4],
        limit: f32,
        quad: &mut Quad,
    ) -> u32 {
        // SAFETY: the caller's promise.
        unsafe { quad_one_by_one(frame, corners, limit, quad) }
    }

    methods! {
        f32s(x: f32) -> F32 = F32(vdupq_n_f32(x));
        u32s(x: u32) -> U32 = U32(vdupq_n_u32(x));
        f64s(x: f64) -> F64 = F64(vdupq_n_f64(x), vdupq_n_f64(x));

        load(from: &[f32]) -> F32 = F32(vld1q_f32(from[..WIDTH].as_ptr()));
        load_u32(from: &[u32]) -> U32 = U32(vld1q_u32(from[..WIDTH].as_ptr()));
        store(x: F32, to: &mut [f32]) = vst1q_f32(to[..WIDTH].as_mut_ptr(), x.0);
        store_u32(x: U32, to: &mut [u32]) = vst1q_u32(to[..WIDTH].as_mut_ptr(), x.0);

        abs(x: F32) -> F32 = F32(vabsq_f32(x.0));

        lt(a: F32, b: F32) -> Mask = Mask(vcltq_f32(a.0, b.0));
        le(a: F32, b: F32) -> Mask = Mask(vcleq_f32(a.0, b.0));
        eq(a: F32, b: F32) -> Mask = Mask(vceqq_f32(a.0, b.0));
        lt_f64(a: F64, b: F64) -> Mask = joined(vcltq_f64(a.0, b.0), vcltq_f64(a.1, b.1));
        eq_f64(a: F64, b: F64) -> Mask = joined(vceqq_f64(a.0, b.0), vceqq_f64(a.1, b.1));
        eq_u32(a: U32, b: U32) -> Mask = Mask(vceqq_u32(a.0, b.0));
        lt_u32(a: U32, b: U32) -> Mask = Mask(vcltq_u32(a.0, b.0));

        select(mask: Mask, yes: F32, no: F32) -> F32 = F32(vbslq_f32(mask.0, yes.0, no.0));
        select_u32(mask: Mask, yes: U32, no: U32) -> U32 = U32(vbslq_u32(mask.0, yes.0, no.0));

        cast_u32(x: F32) -> U32 = U32(vreinterpretq_u32_f32(x.0));
        cast_f32(x: U32) -> F32 = F32(vreinterpretq_f32_u32(x.0));
        widen(x: F32) -> F64 = F64(vcvt_f64_f32(vget_low_f32(x.0)), vcvt_high_f64_f32(x.0));
        narrow(x: F64) -> F32 = F32(vcvt_high_f32_f64(vcvt_f32_f64(x.0), x.1));

        mask(bits: u32) -> Mask = {
            let lane = vld1q_u32([1, 2, 4, 8].as_ptr());
            Mask(vtstq_u32(vdupq_n_u32(bits), lane))
        };
        bits(mask: Mask) -> u32 = vaddvq_u32(vandq_u32(mask.0, vld1q_u32([1, 2, 4, 8].as_ptr())));
    }

    // The instructions for min and max return a NaN wherever one stands.
    #[inline(always)]
    fn larger(self, a: F32, b: F32) -> F32 {
        self.select(self.lt(b, a), a, b)
    }
    #[inline(always)]
    fn smaller(self, a: F32, b: F32) -> F32 {
        self.select(self.lt(a, b), a, b)
    }

    through_memory! {}

    #[inline(always)]
    fn columns(self, records: &[[f32; 8]]) -> [F32; 8] {
        let records = &records[..WIDTH];
        from_fn(|k| self.load(&from_fn::<f32, WIDTH, _>(|lane| records[lane][k])))
    }

    #[inline(always)]
    unsafe fn gather_pairs<const SCALE: i32>(self, base: *const u8, index: U32) -> (U32, U32) {
        let index = lanes::<_, WIDTH>(self, index);
        let x: [u64; WIDTH] = from_fn(|lane| {
            // SAFETY: the caller says that these bytes are readable.
            unsafe { base.add(index[lane] as usize * SCALE as usize).cast::<u64>().read_unaligned() }
        });
        (self.load_u32(&x.map(|x| x as u32)), self.load_u32(&x.map(|x| (x >> 32) as u32)))
    }
}

/// Masks of f64 lanes as one of f32 lanes.
///
/// # Safety
/// The processor must have NEON.
#[inline(always)]
unsafe fn joined(lower: uint64x2_t, upper: uint64x2_t) -> Mask {
    // SAFETY: the caller's promise.
    unsafe { Mask(vcombine_u32(vmovn_u64(lower), vmovn_u64(upper))) }
}
