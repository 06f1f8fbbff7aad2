//! SSE2: 4 lanes, what every x86-64 has. Gathers, permutes and compression go through memory.

use super::macros::{methods, operators, through_memory, vectors};
use super::{Quad, Shear, Simd, lanes, load_row, load_two, quad_one_by_one};
use std::arch::x86_64::*;

const WIDTH: usize = 4;

vectors! {
    Sse2 proves "SSE2";
    F32(__m128), F64(__m128d, __m128d), U32(__m128i), Mask(__m128)
}

operators! {
    F32 {
        Add::add = |a, b| F32(_mm_add_ps(a.0, b.0));
        Sub::sub = |a, b| F32(_mm_sub_ps(a.0, b.0));
        Mul::mul = |a, b| F32(_mm_mul_ps(a.0, b.0));
        Div::div = |a, b| F32(_mm_div_ps(a.0, b.0));
    }
    F64 {
        Add::add = |a, b| F64(_mm_add_pd(a.0, b.0), _mm_add_pd(a.1, b.1));
        Sub::sub = |a, b| F64(_mm_sub_pd(a.0, b.0), _mm_sub_pd(a.1, b.1));
        Mul::mul = |a, b| F64(_mm_mul_pd(a.0, b.0), _mm_mul_pd(a.1, b.1));
        Div::div = |a, b| F64(_mm_div_pd(a.0, b.0), _mm_div_pd(a.1, b.1));
    }
    U32 {
        Add::add = |a, b| U32(_mm_add_epi32(a.0, b.0));
        Sub::sub = |a, b| U32(_mm_sub_epi32(a.0, b.0));
        BitAnd::bitand = |a, b| U32(_mm_and_si128(a.0, b.0));
        BitOr::bitor = |a, b| U32(_mm_or_si128(a.0, b.0));
        BitXor::bitxor = |a, b| U32(_mm_xor_si128(a.0, b.0));
        Shl::shl = |a, by: u32| U32(_mm_sll_epi32(a.0, _mm_cvtsi32_si128(by as i32)));
        Shr::shr = |a, by: u32| U32(_mm_srl_epi32(a.0, _mm_cvtsi32_si128(by as i32)));
    }
    Mask {
        BitAnd::bitand = |a, b| Mask(_mm_and_ps(a.0, b.0));
        BitOr::bitor = |a, b| Mask(_mm_or_ps(a.0, b.0));
        Not::not = |a| Mask(_mm_xor_ps(a.0, _mm_castsi128_ps(_mm_set1_epi32(-1))));
    }
}

impl Simd for Sse2 {
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
        f32s(x: f32) -> F32 = F32(_mm_set1_ps(x));
        u32s(x: u32) -> U32 = U32(_mm_set1_epi32(x as i32));
        f64s(x: f64) -> F64 = F64(_mm_set1_pd(x), _mm_set1_pd(x));

        load(from: &[f32]) -> F32 = F32(_mm_loadu_ps(from[..WIDTH].as_ptr()));
        load_u32(from: &[u32]) -> U32 = U32(_mm_loadu_si128(from[..WIDTH].as_ptr().cast()));
        store(x: F32, to: &mut [f32]) = _mm_storeu_ps(to[..WIDTH].as_mut_ptr(), x.0);
        store_u32(x: U32, to: &mut [u32]) = _mm_storeu_si128(to[..WIDTH].as_mut_ptr().cast(), x.0);

        larger(a: F32, b: F32) -> F32 = F32(_mm_max_ps(a.0, b.0));
        smaller(a: F32, b: F32) -> F32 = F32(_mm_min_ps(a.0, b.0));
        abs(x: F32) -> F32 = F32(_mm_andnot_ps(_mm_set1_ps(-0.0), x.0));

        lt(a: F32, b: F32) -> Mask = Mask(_mm_cmplt_ps(a.0, b.0));
        le(a: F32, b: F32) -> Mask = Mask(_mm_cmple_ps(a.0, b.0));
        eq(a: F32, b: F32) -> Mask = Mask(_mm_cmpeq_ps(a.0, b.0));
        lt_f64(a: F64, b: F64) -> Mask = joined(_mm_cmplt_pd(a.0, b.0), _mm_cmplt_pd(a.1, b.1));
        eq_f64(a: F64, b: F64) -> Mask = joined(_mm_cmpeq_pd(a.0, b.0), _mm_cmpeq_pd(a.1, b.1));
        eq_u32(a: U32, b: U32) -> Mask = Mask(_mm_castsi128_ps(_mm_cmpeq_epi32(a.0, b.0)));
        lt_u32(a: U32, b: U32) -> Mask = {
            // Signed comparison of both sides moved down by 2³¹.
            let sign = _mm_set1_epi32(i32::MIN);
            Mask(_mm_castsi128_ps(_mm_cmplt_epi32(_mm_xor_si128(a.0, sign), _mm_xor_si128(b.0, sign))))
        };

        select(mask: Mask, yes: F32, no: F32) -> F32 =
            F32(_mm_or_ps(_mm_and_ps(mask.0, yes.0), _mm_andnot_ps(mask.0, no.0)));
        select_u32(mask: Mask, yes: U32, no: U32) -> U32 = {
            let mask = _mm_castps_si128(mask.0);
            U32(_mm_or_si128(_mm_and_si128(mask, yes.0), _mm_andnot_si128(mask, no.0)))
        };

        cast_u32(x: F32) -> U32 = U32(_mm_castps_si128(x.0));
        cast_f32(x: U32) -> F32 = F32(_mm_castsi128_ps(x.0));
        widen(x: F32) -> F64 = F64(_mm_cvtps_pd(x.0), _mm_cvtps_pd(_mm_movehl_ps(x.0, x.0)));
        narrow(x: F64) -> F32 = F32(_mm_movelh_ps(_mm_cvtpd_ps(x.0), _mm_cvtpd_ps(x.1)));

        mask(bits: u32) -> Mask = {
            let lane = _mm_setr_epi32(1, 2, 4, 8);
            let named = _mm_and_si128(_mm_set1_epi32(bits as i32), lane);
            Mask(_mm_castsi128_ps(_mm_cmpeq_epi32(named, lane)))
        };
        bits(mask: Mask) -> u32 = _mm_movemask_ps(mask.0) as u32;
    }

    through_memory! {}

    #[inline(always)]
    fn columns(self, records: &[[f32; 8]]) -> [F32; 8] {
        let [a, b, c, d] = [&records[0], &records[1], &records[2], &records[3]];
        // SAFETY: the token proves the instructions; each record is two vectors long.
        unsafe {
            let half = |k: usize| {
                let row = |record: &[f32; 8]| _mm_loadu_ps(record.as_ptr().add(k));
                let (low, high) = (_mm_unpacklo_ps(row(a), row(b)), _mm_unpackhi_ps(row(a), row(b)));
                let (low2, high2) = (_mm_unpacklo_ps(row(c), row(d)), _mm_unpackhi_ps(row(c), row(d)));
                [
                    F32(_mm_movelh_ps(low, low2)),
                    F32(_mm_movehl_ps(low2, low)),
                    F32(_mm_movelh_ps(high, high2)),
                    F32(_mm_movehl_ps(high2, high)),
                ]
            };
            let ([a, b, c, d], [e, f, g, h]) = (half(0), half(4));
            [a, b, c, d, e, f, g, h]
        }
    }

    #[inline(always)]
    unsafe fn gather_pairs<const SCALE: i32>(self, base: *const u8, index: U32) -> (U32, U32) {
        let (at, scale) = (lanes::<_, WIDTH>(self, index), SCALE as usize);
        // SAFETY: the token proves the instructions; the caller vouches for the addresses.
        unsafe {
            let a = _mm_castsi128_ps(load_two(base, scale, &at, 0));
            let b = _mm_castsi128_ps(load_two(base, scale, &at, 2));
            let even = _mm_shuffle_ps::<0b10_00_10_00>(a, b);
            let odd = _mm_shuffle_ps::<0b11_01_11_01>(a, b);
            (U32(_mm_castps_si128(even)), U32(_mm_castps_si128(odd)))
        }
    }
    #[inline(always)]
    unsafe fn gather_rows<const SCALE: i32>(self, base: *const u8, index: U32) -> [U32; 4] {
        let (at, scale) = (lanes::<_, WIDTH>(self, index), SCALE as usize);
        // SAFETY: the token proves the instructions; the caller vouches for the addresses.
        unsafe {
            let (first, second) = (load_row(base, scale, &at, 0), load_row(base, scale, &at, 1));
            let (third, fourth) = (load_row(base, scale, &at, 2), load_row(base, scale, &at, 3));
            let (low, high) = (_mm_unpacklo_epi32(first, second), _mm_unpackhi_epi32(first, second));
            let (low2, high2) = (_mm_unpacklo_epi32(third, fourth), _mm_unpackhi_epi32(third, fourth));
            [
                U32(_mm_unpacklo_epi64(low, low2)),
                U32(_mm_unpackhi_epi64(low, low2)),
                U32(_mm_unpacklo_epi64(high, high2)),
                U32(_mm_unpackhi_epi64(high, high2)),
            ]
        }
    }
}

/// Masks of f64 lanes as one of f32 lanes.
///
/// # Safety
/// The processor must have SSE2.
#[inline(always)]
unsafe fn joined(lower: __m128d, upper: __m128d) -> Mask {
    // SAFETY: the caller's promise.
    unsafe { Mask(_mm_shuffle_ps::<0b10_00_10_00>(_mm_castpd_ps(lower), _mm_castpd_ps(upper))) }
}
