//! AVX-512 (F, BW, DQ, VL): 16 lanes, masks in registers of their own.

use super::avx2::decide_by_lanes;
use super::macros::{methods, operators, vectors};
use super::{Intersection, Quad, Shear, Simd, lane_at, load_row, load_two, order};
use crate::geometry::estimate::{DISTANCE, LEAST_REACH, LEAST_SCALE, LEAST_SUM, MOST_SCALE, SIGN};
use std::arch::x86_64::*;

const WIDTH: usize = 16;

vectors! {
    Avx512 proves "AVX-512 F, BW, DQ, VL and AVX2";
    F32(__m512), F64(__m512d, __m512d), U32(__m512i), Bits(__mmask16)
}

operators! {
    F32 {
        Add::add = |a, b| F32(_mm512_add_ps(a.0, b.0));
        Sub::sub = |a, b| F32(_mm512_sub_ps(a.0, b.0));
        Mul::mul = |a, b| F32(_mm512_mul_ps(a.0, b.0));
        Div::div = |a, b| F32(_mm512_div_ps(a.0, b.0));
    }
    F64 {
        Add::add = |a, b| F64(_mm512_add_pd(a.0, b.0), _mm512_add_pd(a.1, b.1));
        Sub::sub = |a, b| F64(_mm512_sub_pd(a.0, b.0), _mm512_sub_pd(a.1, b.1));
        Mul::mul = |a, b| F64(_mm512_mul_pd(a.0, b.0), _mm512_mul_pd(a.1, b.1));
        Div::div = |a, b| F64(_mm512_div_pd(a.0, b.0), _mm512_div_pd(a.1, b.1));
    }
    U32 {
        Add::add = |a, b| U32(_mm512_add_epi32(a.0, b.0));
        Sub::sub = |a, b| U32(_mm512_sub_epi32(a.0, b.0));
        BitAnd::bitand = |a, b| U32(_mm512_and_si512(a.0, b.0));
        BitOr::bitor = |a, b| U32(_mm512_or_si512(a.0, b.0));
        BitXor::bitxor = |a, b| U32(_mm512_xor_si512(a.0, b.0));
        Shl::shl = |a, by: u32| U32(_mm512_sll_epi32(a.0, _mm_cvtsi32_si128(by as i32)));
        Shr::shr = |a, by: u32| U32(_mm512_srl_epi32(a.0, _mm_cvtsi32_si128(by as i32)));
    }
    Bits {
        BitAnd::bitand = |a, b| Bits(a.0 & b.0);
        BitOr::bitor = |a, b| Bits(a.0 | b.0);
        Not::not = |a| Bits(!a.0);
    }
}

impl Simd for Avx512 {
    const WIDTH: usize = WIDTH;
    type F = F32;
    type D = F64;
    type U = U32;
    type Frame = Frame;
    type M = Bits;

    methods! {
        f32s(x: f32) -> F32 = F32(_mm512_set1_ps(x));
        u32s(x: u32) -> U32 = U32(_mm512_set1_epi32(x as i32));
        f64s(x: f64) -> F64 = F64(_mm512_set1_pd(x), _mm512_set1_pd(x));

        load(from: &[f32]) -> F32 = F32(_mm512_loadu_ps(from[..WIDTH].as_ptr()));
        load_u32(from: &[u32]) -> U32 = U32(_mm512_loadu_si512(from[..WIDTH].as_ptr().cast()));
        store(x: F32, to: &mut [f32]) = _mm512_storeu_ps(to[..WIDTH].as_mut_ptr(), x.0);
        store_u32(x: U32, to: &mut [u32]) = to[..WIDTH].as_mut_ptr().cast::<__m512i>().write_unaligned(x.0);

        larger(a: F32, b: F32) -> F32 = F32(_mm512_max_ps(a.0, b.0));
        smaller(a: F32, b: F32) -> F32 = F32(_mm512_min_ps(a.0, b.0));
        least(x: F32) -> f32 = _mm512_reduce_min_ps(x.0);
        most(x: F32) -> f32 = _mm512_reduce_max_ps(x.0);
        abs(x: F32) -> F32 = F32(_mm512_abs_ps(x.0));

        lt(a: F32, b: F32) -> Bits = Bits(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a.0, b.0));
        le(a: F32, b: F32) -> Bits = Bits(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(a.0, b.0));
        eq(a: F32, b: F32) -> Bits = Bits(_mm512_cmp_ps_mask::<_CMP_EQ_OQ>(a.0, b.0));
        lt_f64(a: F64, b: F64) -> Bits = joined(
            _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a.0, b.0),
            _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a.1, b.1),
        );
        eq_f64(a: F64, b: F64) -> Bits = joined(
            _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a.0, b.0),
            _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a.1, b.1),
        );
        eq_u32(a: U32, b: U32) -> Bits = Bits(_mm512_cmpeq_epu32_mask(a.0, b.0));
        lt_u32(a: U32, b: U32) -> Bits = Bits(_mm512_cmplt_epu32_mask(a.0, b.0));

        select(mask: Bits, yes: F32, no: F32) -> F32 = F32(_mm512_mask_blend_ps(mask.0, no.0, yes.0));
        select_u32(mask: Bits, yes: U32, no: U32) -> U32 = U32(_mm512_mask_blend_epi32(mask.0, no.0, yes.0));

        cast_u32(x: F32) -> U32 = U32(_mm512_castps_si512(x.0));
        cast_f32(x: U32) -> F32 = F32(_mm512_castsi512_ps(x.0));
        widen(x: F32) -> F64 = F64(
            _mm512_cvtps_pd(_mm512_castps512_ps256(x.0)),
            _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(x.0)),
        );
        narrow(x: F64) -> F32 = F32(_mm512_insertf32x8::<1>(
            _mm512_castps256_ps512(_mm512_cvtpd_ps(x.0)),
            _mm512_cvtpd_ps(x.1),
        ));

        permute(x: F32, from: U32) -> F32 = F32(_mm512_permutexvar_ps(from.0, x.0));
        permute_u32(x: U32, from: U32) -> U32 = U32(_mm512_permutexvar_epi32(from.0, x.0));
    }

    #[inline(always)]
    fn mask(self, bits: u32) -> Bits {
        Bits(bits as u16)
    }
    #[inline(always)]
    fn bits(self, mask: Bits) -> u32 {
        mask.0.into()
    }

    #[inline(always)]
    fn load_u16(self, from: &[u16]) -> F32 {
        let from = from[..WIDTH].as_ptr();
        // SAFETY: the token proves the instructions; 16 lanes are 32 bytes.
        unsafe { F32(_mm512_cvtepi32_ps(_mm512_cvtepu16_epi32(_mm256_loadu_si256(from.cast())))) }
    }
    #[inline(always)]
    fn bound_mul_add(self, a: F32, b: F32, c: F32) -> F32 {
        // SAFETY: the token proves the instructions.
        unsafe { F32(_mm512_fmadd_ps(a.0, b.0, c.0)) }
    }
    #[inline(always)]
    fn frame(self, shear: &Shear) -> Frame {
        let [ox, oy, oz] = shear.origin;
        // SAFETY: the token proves the instructions.
        unsafe {
            Frame {
                axes: _mm512_broadcast_i32x4(AXES[shear.axes[2]].as_ptr().cast::<__m128i>().read_unaligned()),
                origin: _mm512_broadcast_f32x4(_mm_setr_ps(ox, oy, oz, 0.0)),
                slope: _mm512_maskz_broadcast_f32x2(
                    0x3333,
                    _mm_setr_ps(shear.slope[0], shear.slope[1], 0.0, 0.0),
                ),
                along: _mm512_set1_ps(shear.along as f32),
            }
        }
    }
    #[inline(always)]
    unsafe fn quad(
        self,
        frame: &Frame,
        corners: &[[*const [f32; 3]; 3]; 4],
        limit: f32,
        quad: &mut Quad,
    ) -> u32 {
        // SAFETY: the token proves the instructions; the caller vouches for the corners.
        unsafe {
            let Edges { u, u2, v, v2, w, w2, az, bz, cz, may_hit } = edges(frame, corners);
            if may_hit == 0 {
                return 0;
            }
            macro_rules! below {
                ($p:ident, $q:ident) => {
                    u32::from(_mm512_cmp_ps_mask::<_CMP_LT_OQ>($p, $q))
                };
            }
            // What `Shear::estimate` finds of a triangle, in the first lane of its quarter.
            let sum = _mm512_add_ps(_mm512_add_ps(_mm512_abs_ps(u), _mm512_abs_ps(v)), _mm512_abs_ps(w));
            let sum = _mm512_add_ps(sum, _mm512_permute_ps::<0b11_10_00_01>(sum));
            let reach = _mm512_max_ps(_mm512_max_ps(_mm512_abs_ps(az), _mm512_abs_ps(bz)), _mm512_abs_ps(cz));
            let (u, v, w) = (_mm512_sub_ps(u, u2), _mm512_sub_ps(v, v2), _mm512_sub_ps(w, w2));
            let distance = _mm512_add_ps(
                _mm512_add_ps(_mm512_mul_ps(u, az), _mm512_mul_ps(v, bz)),
                _mm512_mul_ps(w, cz),
            );
            let scale = _mm512_mul_ps(_mm512_add_ps(_mm512_add_ps(u, v), w), frame.along);
            let sign = _mm512_and_ps(scale, _mm512_set1_ps(-0.0));
            let (distance, scale) = (_mm512_xor_ps(distance, sign), _mm512_xor_ps(scale, sign));
            let error = _mm512_mul_ps(_mm512_mul_ps(sum, reach), _mm512_set1_ps(DISTANCE));
            let least = _mm512_mul_ps(sum, _mm512_set1_ps(SIGN));
            let (low, high) = (_mm512_min_ps(_mm512_min_ps(u, v), w), _mm512_max_ps(_mm512_max_ps(u, v), w));
            let negative = _mm512_xor_ps(high, _mm512_set1_ps(-0.0));
            macro_rules! at_least {
                ($p:expr, $q:expr) => {
                    u32::from(_mm512_cmp_ps_mask::<_CMP_GE_OQ>($p, $q))
                };
            }
            let sure = (below!(least, low) | below!(least, negative))
                & at_least!(sum, _mm512_set1_ps(LEAST_SUM))
                & at_least!(reach, _mm512_set1_ps(LEAST_REACH))
                & at_least!(scale, _mm512_set1_ps(LEAST_SCALE))
                & at_least!(_mm512_set1_ps(MOST_SCALE), scale)
                & at_least!(_mm512_set1_ps(MOST_SCALE), error);
            let (end, nearest) =
                (_mm512_mul_ps(_mm512_set1_ps(limit), scale), _mm512_sub_ps(distance, error));
            let candidates = may_hit & !(sure & below!(end, nearest));
            if candidates == 0 {
                return 0;
            }
            _mm512_store_ps(quad.distance.as_mut_ptr(), distance);
            _mm512_store_ps(quad.scale.as_mut_ptr(), scale);
            _mm512_store_ps(quad.error.as_mut_ptr(), error);
            quad.sure = _pext_u32(sure, 0x1111);
            _pext_u32(candidates, 0x1111)
        }
    }

    #[inline(always)]
    unsafe fn may_hit(self, shear: &Shear, corners: &[[*const [f32; 3]; 3]; 4]) -> u32 {
        // SAFETY: the token proves the instructions; the caller vouches for the corners.
        unsafe { _pext_u32(edges(&self.frame(shear), corners).may_hit, 0x1111) }
    }

    #[inline(always)]
    unsafe fn decide(self, shear: &Shear, corners: [*const [f32; 3]; 3]) -> Option<Intersection> {
        // SAFETY: the token proves AVX2; the caller vouches for the corners.
        unsafe { decide_by_lanes(shear, corners) }
    }

    #[inline(always)]
    fn columns(self, records: &[[f32; 8]]) -> [F32; 8] {
        let records = records[..WIDTH].as_flattened();
        // SAFETY: the token proves the instructions; 16 records are eight vectors.
        unsafe {
            // Columns 0..4 and 4..8 of four records each, a column after the other.
            let first = _mm512_setr_epi32(0, 8, 16, 24, 1, 9, 17, 25, 2, 10, 18, 26, 3, 11, 19, 27);
            let second = _mm512_add_epi32(first, _mm512_set1_epi32(4));
            let mut low = [_mm512_setzero_ps(); 4];
            let mut high = low;
            for i in 0..4 {
                let (a, b) = (&records[32 * i..], &records[32 * i + 16..]);
                let (a, b) = (_mm512_loadu_ps(a.as_ptr()), _mm512_loadu_ps(b.as_ptr()));
                low[i] = _mm512_permutex2var_ps(a, first, b);
                high[i] = _mm512_permutex2var_ps(a, second, b);
            }
            let [a, b, c, d] = four_columns(low);
            let [e, f, g, h] = four_columns(high);
            [a, b, c, d, e, f, g, h]
        }
    }

    #[inline(always)]
    fn compress(self, mask: Bits, x: U32, to: &mut [u32]) -> usize {
        let to = &mut to[..WIDTH];
        // Compressed in the register and stored whole: compressing stores take over a hundred cycles on some processors.
        // SAFETY: the token proves the instructions; `to` has 16 entries.
        unsafe {
            to.as_mut_ptr().cast::<__m512i>().write_unaligned(_mm512_maskz_compress_epi32(mask.0, x.0))
        };
        mask.0.count_ones() as usize
    }

    #[inline(always)]
    unsafe fn least_and_others(self, mask: u32, keys: U32, tag: u32, others: *mut [u32; 2]) -> u32 {
        let count = mask.count_ones() as usize;
        if count > 4 {
            let mut packed = [0; WIDTH];
            self.compress(Bits(mask as u16), keys, &mut packed);
            // SAFETY: the caller's promise.
            return unsafe { order::least_and_others(&mut packed, count, tag, others) };
        }
        // SAFETY: the token proves the instructions; four pairs are written.
        unsafe {
            let none = _mm512_set1_epi32(-1);
            let keys = _mm512_castsi512_si128(_mm512_mask_compress_epi32(none, mask as u16, keys.0));
            // The least by itself, as walks wait for it alone.
            let least = _mm_min_epu32(keys, _mm_shuffle_epi32::<0b01_00_11_10>(keys));
            let least = _mm_min_epu32(least, _mm_shuffle_epi32::<0b10_11_00_01>(least));
            // A network for four, ascending: neighbours, then every second one, then the middle.
            macro_rules! exchange {
                ($keys:ident, $order:literal, $larger:literal) => {{
                    let other = _mm_shuffle_epi32::<$order>($keys);
                    _mm_blend_epi32::<$larger>(_mm_min_epu32($keys, other), _mm_max_epu32($keys, other))
                }};
            }
            let keys = exchange!(keys, 0b10_11_00_01, 0b1010);
            let keys = exchange!(keys, 0b01_00_11_10, 0b1100);
            let keys = exchange!(keys, 0b11_01_10_00, 0b0100);
            let descending = DESCENDING[count].as_ptr().cast::<__m128i>().read_unaligned();
            let keys = _mm_castps_si128(_mm_permutevar_ps(_mm_castsi128_ps(keys), descending));
            let tags = _mm_set1_epi32(tag as i32);
            others.cast::<__m128i>().write_unaligned(_mm_unpacklo_epi32(keys, tags));
            others.add(2).cast::<__m128i>().write_unaligned(_mm_unpackhi_epi32(keys, tags));
            _mm_cvtsi128_si32(least) as u32
        }
    }

    #[inline(always)]
    unsafe fn gather<const SCALE: i32>(self, base: *const u8, index: U32) -> F32 {
        // SAFETY: the token proves the instructions; the caller vouches for the addresses.
        unsafe { F32(_mm512_i32gather_ps::<SCALE>(index.0, base.cast())) }
    }
    #[inline(always)]
    unsafe fn gather_u32<const SCALE: i32>(self, base: *const u8, index: U32) -> U32 {
        // SAFETY: the token proves the instructions; the caller vouches for the addresses.
        unsafe { U32(_mm512_i32gather_epi32::<SCALE>(index.0, base.cast())) }
    }
    #[inline(always)]
    unsafe fn gather_pairs<const SCALE: i32>(self, base: *const u8, index: U32) -> (U32, U32) {
        let mut at = Indices([0; WIDTH]);
        self.store_u32(index, &mut at.0);
        // SAFETY: the caller's promise.
        unsafe { self.load_pairs::<SCALE>(base, &at.0) }
    }
    #[inline(always)]
    unsafe fn gather_rows<const SCALE: i32>(self, base: *const u8, index: U32) -> [U32; 4] {
        let mut at = Indices([0; WIDTH]);
        self.store_u32(index, &mut at.0);
        // SAFETY: the token proves the instructions; the caller vouches for the addresses.
        unsafe { rows(base, SCALE as usize, &at.0) }
    }
    #[inline(always)]
    unsafe fn load_pairs<const SCALE: i32>(self, base: *const u8, at: &[u32]) -> (U32, U32) {
        let at = &at[..WIDTH];
        // SAFETY: the token proves the instructions; the caller vouches for the addresses.
        unsafe {
            let (a, b) = (eight(base, SCALE as usize, at, 0), eight(base, SCALE as usize, at, 8));
            let even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
            let odd = _mm512_add_epi32(even, _mm512_set1_epi32(1));
            (U32(_mm512_permutex2var_epi32(a, even, b)), U32(_mm512_permutex2var_epi32(a, odd, b)))
        }
    }
    #[inline(always)]
    unsafe fn load_rows(self, base: *const u8, at: &[u32]) -> [U32; 4] {
        // SAFETY: the token proves the instructions; the caller vouches for the addresses.
        unsafe { rows(base, 1, &at[..WIDTH]) }
    }
    #[inline(always)]
    unsafe fn store_rows(self, base: *mut u8, at: &[u32], [a, b, c, d]: [U32; 4]) {
        let at = &at[..WIDTH];
        // SAFETY: the token proves the instructions; the caller vouches for the addresses.
        unsafe {
            let (low, high) = (_mm512_unpacklo_epi32(a.0, b.0), _mm512_unpackhi_epi32(a.0, b.0));
            let (low2, high2) = (_mm512_unpacklo_epi32(c.0, d.0), _mm512_unpackhi_epi32(c.0, d.0));
            store_quarters(base, at, 0, _mm512_unpacklo_epi64(low, low2));
            store_quarters(base, at, 1, _mm512_unpackhi_epi64(low, low2));
            store_quarters(base, at, 2, _mm512_unpacklo_epi64(high, high2));
            store_quarters(base, at, 3, _mm512_unpackhi_epi64(high, high2));
        }
    }
    #[inline(always)]
    fn pick(self, table: &[f32; 32], index: U32) -> F32 {
        // SAFETY: the token proves the instructions; the table has 32 entries.
        unsafe {
            let (a, b) = (_mm512_loadu_ps(table.as_ptr()), _mm512_loadu_ps(table.as_ptr().add(16)));
            F32(_mm512_permutex2var_ps(a, index.0, b))
        }
    }
}

/// Which of four ascending keys follow each other where only so many are keys, without the first: from the greatest on.
const DESCENDING: [[u32; 4]; 5] = [[0; 4], [0; 4], [1, 0, 0, 0], [2, 1, 0, 0], [3, 2, 1, 0]];

/// Axes that play x, y and z, by the last one of them.
const AXES: [[u32; 4]; 3] = [[1, 2, 0, 3], [2, 0, 1, 3], [0, 1, 2, 3]];

/// A ray's frame: axes that play x, y and z, the origin, and the slopes, in each quarter; `along` everywhere.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    axes: __m512i,
    origin: __m512,
    slope: __m512,
    along: __m512,
}

/// Four triangles in the ray's frame, each in its own quarter.
struct Edges {
    /// (px·qy, py·qx) and the other way round: an edge function is their difference, and its sign theirs in order.
    u: __m512,
    u2: __m512,
    v: __m512,
    v2: __m512,
    w: __m512,
    w2: __m512,
    /// The corners' z, in all lanes of the quarter.
    az: __m512,
    bz: __m512,
    cz: __m512,
    /// The lowest bit of each quarter where the triangle may be hit.
    may_hit: u32,
}

/// What four triangles are in the ray's frame.
///
/// # Safety
/// The processor must have AVX-512, and every pointer must be that of a corner.
#[inline(always)]
unsafe fn edges(frame: &Frame, corners: &[[*const [f32; 3]; 3]; 4]) -> Edges {
    // SAFETY: the caller's promise; the masks read three f32 of each corner.
    unsafe {
        // Macros, since closures fall out of the inline chain.
        macro_rules! three {
            ($k:literal, $at:literal) => {
                _mm_maskz_loadu_ps(0b0111, corners[$at][$k].cast())
            };
        }
        macro_rules! row {
            ($k:literal) => {{
                let row = _mm512_castps128_ps512(three!($k, 0));
                let row = _mm512_insertf32x4::<1>(row, three!($k, 1));
                let row = _mm512_insertf32x4::<2>(row, three!($k, 2));
                let row = _mm512_insertf32x4::<3>(row, three!($k, 3));
                let row = _mm512_permutevar_ps(_mm512_sub_ps(row, frame.origin), frame.axes);
                let z = _mm512_permute_ps::<0b10_10_10_10>(row);
                (_mm512_sub_ps(row, _mm512_mul_ps(frame.slope, z)), z)
            }};
        }
        macro_rules! products {
            ($p:ident, $q:ident) => {{
                let product = _mm512_mul_ps($p, _mm512_permute_ps::<0b11_10_00_01>($q));
                (product, _mm512_permute_ps::<0b11_10_00_01>(product))
            }};
        }
        let ((a, az), (b, bz), (c, cz)) = (row!(0), row!(1), row!(2));
        let ((u, u2), (v, v2), (w, w2)) = (products!(c, b), products!(a, c), products!(b, a));
        let below = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(u, u2)
            | _mm512_cmp_ps_mask::<_CMP_LT_OQ>(v, v2)
            | _mm512_cmp_ps_mask::<_CMP_LT_OQ>(w, w2);
        // A triangle is missed where both of its bits are set: some edge function is negative, and some positive.
        let may_hit = !u32::from(below & below >> 1) & 0x1111;
        Edges { u, u2, v, v2, w, w2, az, bz, cz, may_hit }
    }
}

#[inline(always)]
fn joined(lower: __mmask8, upper: __mmask8) -> Bits {
    Bits(u16::from(lower) | u16::from(upper) << 8)
}

/// Transposes 4 × 4 blocks of 128 bits.
///
/// # Safety
/// The processor must have AVX-512 F.
#[inline(always)]
unsafe fn four_columns([a, b, c, d]: [__m512; 4]) -> [F32; 4] {
    // SAFETY: the caller's promise.
    unsafe {
        let (ab, ab2) =
            (_mm512_shuffle_f32x4::<0b01_00_01_00>(a, b), _mm512_shuffle_f32x4::<0b11_10_11_10>(a, b));
        let (cd, cd2) =
            (_mm512_shuffle_f32x4::<0b01_00_01_00>(c, d), _mm512_shuffle_f32x4::<0b11_10_11_10>(c, d));
        [
            F32(_mm512_shuffle_f32x4::<0b10_00_10_00>(ab, cd)),
            F32(_mm512_shuffle_f32x4::<0b11_01_11_01>(ab, cd)),
            F32(_mm512_shuffle_f32x4::<0b10_00_10_00>(ab2, cd2)),
            F32(_mm512_shuffle_f32x4::<0b11_01_11_01>(ab2, cd2)),
        ]
    }
}

/// Indices of all lanes on their way to scalar registers.
#[repr(align(64))]
struct Indices([u32; WIDTH]);

/// Eight times eight bytes, from `lane` on.
///
/// # Safety
/// The processor must have AVX-512, `at` the lanes, and the bytes must be readable.
#[inline(always)]
unsafe fn eight(base: *const u8, scale: usize, at: &[u32], lane: usize) -> __m512i {
    // SAFETY: the caller's promise.
    unsafe {
        let lower = _mm256_inserti128_si256::<1>(
            _mm256_castsi128_si256(load_two(base, scale, at, lane)),
            load_two(base, scale, at, lane + 2),
        );
        let upper = _mm256_inserti128_si256::<1>(
            _mm256_castsi128_si256(load_two(base, scale, at, lane + 4)),
            load_two(base, scale, at, lane + 6),
        );
        _mm512_inserti64x4::<1>(_mm512_castsi256_si512(lower), upper)
    }
}

/// Sixteen times sixteen bytes, as columns.
///
/// # Safety
/// The processor must have AVX-512, `at` 16 entries, and the bytes must be readable.
#[inline(always)]
unsafe fn rows(base: *const u8, scale: usize, at: &[u32]) -> [U32; 4] {
    // SAFETY: the caller's promise.
    unsafe {
        let (first, second) = (quarters(base, scale, at, 0), quarters(base, scale, at, 1));
        let (third, fourth) = (quarters(base, scale, at, 2), quarters(base, scale, at, 3));
        let (low, high) = (_mm512_unpacklo_epi32(first, second), _mm512_unpackhi_epi32(first, second));
        let (low2, high2) = (_mm512_unpacklo_epi32(third, fourth), _mm512_unpackhi_epi32(third, fourth));
        [
            U32(_mm512_unpacklo_epi64(low, low2)),
            U32(_mm512_unpackhi_epi64(low, low2)),
            U32(_mm512_unpacklo_epi64(high, high2)),
            U32(_mm512_unpackhi_epi64(high, high2)),
        ]
    }
}

/// Four times sixteen bytes: of `lane` and every fourth one after it.
///
/// # Safety
/// [`rows`] of one lane; `lane` must be below 4.
#[inline(always)]
unsafe fn quarters(base: *const u8, scale: usize, at: &[u32], lane: usize) -> __m512i {
    // SAFETY: the caller's promise.
    unsafe {
        // Broadcast under a mask: a load does it, where an insertion is a shuffle besides.
        let x = _mm512_castsi128_si512(load_row(base, scale, at, lane));
        let x = _mm512_mask_broadcast_i32x4(x, 0x00f0, load_row(base, scale, at, lane + 4));
        let x = _mm512_mask_broadcast_i32x4(x, 0x0f00, load_row(base, scale, at, lane + 8));
        _mm512_mask_broadcast_i32x4(x, 0xf000, load_row(base, scale, at, lane + 12))
    }
}

/// Writes the four quarters of a vector where `lane` and every fourth one after it belong.
///
/// # Safety
/// The processor must have AVX-512, `at` 16 entries, `lane` must be below 4, and the bytes must be writable.
#[inline(always)]
unsafe fn store_quarters(base: *mut u8, at: &[u32], lane: usize, x: __m512i) {
    // SAFETY: the caller's promise.
    unsafe {
        let to = |lane| base.add(lane_at(at, lane)).cast::<__m128i>();
        _mm_storeu_si128(to(lane), _mm512_castsi512_si128(x));
        _mm_storeu_si128(to(lane + 4), _mm512_extracti32x4_epi32::<1>(x));
        _mm_storeu_si128(to(lane + 8), _mm512_extracti32x4_epi32::<2>(x));
        _mm_storeu_si128(to(lane + 12), _mm512_extracti32x4_epi32::<3>(x));
    }
}
