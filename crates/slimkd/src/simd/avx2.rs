//! AVX2: 8 lanes, masks as vectors of all ones or zeros.

use super::macros::{methods, operators, vectors};
use super::{Intersection, Quad, Shear, Simd, lane_at, load_row, load_two};
use crate::geometry::estimate::{DISTANCE, LEAST_REACH, LEAST_SCALE, LEAST_SUM, MOST_SCALE, SIGN};
use std::arch::x86_64::*;

const WIDTH: usize = 8;

vectors! {
    Avx2 proves "AVX2, BMI1, BMI2, LZCNT and POPCNT";
    F32(__m256), F64(__m256d, __m256d), U32(__m256i), Mask(__m256)
}

operators! {
    F32 {
        Add::add = |a, b| F32(_mm256_add_ps(a.0, b.0));
        Sub::sub = |a, b| F32(_mm256_sub_ps(a.0, b.0));
        Mul::mul = |a, b| F32(_mm256_mul_ps(a.0, b.0));
        Div::div = |a, b| F32(_mm256_div_ps(a.0, b.0));
    }
    F64 {
        Add::add = |a, b| F64(_mm256_add_pd(a.0, b.0), _mm256_add_pd(a.1, b.1));
        Sub::sub = |a, b| F64(_mm256_sub_pd(a.0, b.0), _mm256_sub_pd(a.1, b.1));
        Mul::mul = |a, b| F64(_mm256_mul_pd(a.0, b.0), _mm256_mul_pd(a.1, b.1));
        Div::div = |a, b| F64(_mm256_div_pd(a.0, b.0), _mm256_div_pd(a.1, b.1));
    }
    U32 {
        Add::add = |a, b| U32(_mm256_add_epi32(a.0, b.0));
        Sub::sub = |a, b| U32(_mm256_sub_epi32(a.0, b.0));
        BitAnd::bitand = |a, b| U32(_mm256_and_si256(a.0, b.0));
        BitOr::bitor = |a, b| U32(_mm256_or_si256(a.0, b.0));
        BitXor::bitxor = |a, b| U32(_mm256_xor_si256(a.0, b.0));
        Shl::shl = |a, by: u32| U32(_mm256_sll_epi32(a.0, _mm_cvtsi32_si128(by as i32)));
        Shr::shr = |a, by: u32| U32(_mm256_srl_epi32(a.0, _mm_cvtsi32_si128(by as i32)));
    }
    Mask {
        BitAnd::bitand = |a, b| Mask(_mm256_and_ps(a.0, b.0));
        BitOr::bitor = |a, b| Mask(_mm256_or_ps(a.0, b.0));
        Not::not = |a| Mask(_mm256_xor_ps(a.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1))));
    }
}

/// A ray's frame: axes that play x, y and z, the origin, and the slopes, in each half; `along` everywhere.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    axes: __m256i,
    origin: __m256,
    slope: __m256,
    along: __m256,
}

/// Two triangles in the ray's frame, each in its own half; as with AVX-512.
struct Edges {
    u: __m256,
    u2: __m256,
    v: __m256,
    v2: __m256,
    w: __m256,
    w2: __m256,
    az: __m256,
    bz: __m256,
    cz: __m256,
    /// The lowest bit of each half where the triangle may be hit.
    may_hit: u32,
}

/// What two triangles are in the ray's frame.
///
/// # Safety
/// The processor must have AVX2, and every pointer must be that of a corner.
#[inline(always)]
unsafe fn edges(frame: &Frame, first: [*const [f32; 3]; 3], second: [*const [f32; 3]; 3]) -> Edges {
    // SAFETY: the caller's promise; the masks read three f32 of each corner.
    unsafe {
        let three = _mm_setr_epi32(-1, -1, -1, 0);
        macro_rules! row {
            ($k:literal) => {{
                let row = _mm256_set_m128(
                    _mm_maskload_ps(second[$k].cast(), three),
                    _mm_maskload_ps(first[$k].cast(), three),
                );
                let row = _mm256_permutevar_ps(_mm256_sub_ps(row, frame.origin), frame.axes);
                let z = _mm256_permute_ps::<0b10_10_10_10>(row);
                (_mm256_sub_ps(row, _mm256_mul_ps(frame.slope, z)), z)
            }};
        }
        macro_rules! products {
            ($p:ident, $q:ident) => {{
                let product = _mm256_mul_ps($p, _mm256_permute_ps::<0b11_10_00_01>($q));
                (product, _mm256_permute_ps::<0b11_10_00_01>(product))
            }};
        }
        let ((a, az), (b, bz), (c, cz)) = (row!(0), row!(1), row!(2));
        let ((u, u2), (v, v2), (w, w2)) = (products!(c, b), products!(a, c), products!(b, a));
        let below = _mm256_or_ps(
            _mm256_or_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(u, u2), _mm256_cmp_ps::<_CMP_LT_OQ>(v, v2)),
            _mm256_cmp_ps::<_CMP_LT_OQ>(w, w2),
        );
        let below = _mm256_movemask_ps(below) as u32;
        let may_hit = !(below & below >> 1) & 0x11;
        Edges { u, u2, v, v2, w, w2, az, bz, cz, may_hit }
    }
}

impl Simd for Avx2 {
    const WIDTH: usize = WIDTH;
    type F = F32;
    type D = F64;
    type U = U32;
    type Frame = Frame;
    type M = Mask;

    methods! {
        f32s(x: f32) -> F32 = F32(_mm256_set1_ps(x));
        u32s(x: u32) -> U32 = U32(_mm256_set1_epi32(x as i32));
        f64s(x: f64) -> F64 = F64(_mm256_set1_pd(x), _mm256_set1_pd(x));

        load(from: &[f32]) -> F32 = F32(_mm256_loadu_ps(from[..WIDTH].as_ptr()));
        load_u32(from: &[u32]) -> U32 = U32(_mm256_loadu_si256(from[..WIDTH].as_ptr().cast()));
        store(x: F32, to: &mut [f32]) = _mm256_storeu_ps(to[..WIDTH].as_mut_ptr(), x.0);
        store_u32(x: U32, to: &mut [u32]) = _mm256_storeu_si256(to[..WIDTH].as_mut_ptr().cast(), x.0);

        larger(a: F32, b: F32) -> F32 = F32(_mm256_max_ps(a.0, b.0));
        smaller(a: F32, b: F32) -> F32 = F32(_mm256_min_ps(a.0, b.0));
        least(x: F32) -> f32 = {
            let x = _mm_min_ps(_mm256_castps256_ps128(x.0), _mm256_extractf128_ps::<1>(x.0));
            let x = _mm_min_ps(x, _mm_movehl_ps(x, x));
            _mm_cvtss_f32(_mm_min_ss(x, _mm_movehdup_ps(x)))
        };
        most(x: F32) -> f32 = {
            let x = _mm_max_ps(_mm256_castps256_ps128(x.0), _mm256_extractf128_ps::<1>(x.0));
            let x = _mm_max_ps(x, _mm_movehl_ps(x, x));
            _mm_cvtss_f32(_mm_max_ss(x, _mm_movehdup_ps(x)))
        };
        abs(x: F32) -> F32 = F32(_mm256_andnot_ps(_mm256_set1_ps(-0.0), x.0));

        lt(a: F32, b: F32) -> Mask = Mask(_mm256_cmp_ps::<_CMP_LT_OQ>(a.0, b.0));
        le(a: F32, b: F32) -> Mask = Mask(_mm256_cmp_ps::<_CMP_LE_OQ>(a.0, b.0));
        eq(a: F32, b: F32) -> Mask = Mask(_mm256_cmp_ps::<_CMP_EQ_OQ>(a.0, b.0));
        lt_f64(a: F64, b: F64) -> Mask = joined(
            _mm256_cmp_pd::<_CMP_LT_OQ>(a.0, b.0),
            _mm256_cmp_pd::<_CMP_LT_OQ>(a.1, b.1),
        );
        eq_f64(a: F64, b: F64) -> Mask = joined(
            _mm256_cmp_pd::<_CMP_EQ_OQ>(a.0, b.0),
            _mm256_cmp_pd::<_CMP_EQ_OQ>(a.1, b.1),
        );
        eq_u32(a: U32, b: U32) -> Mask = Mask(_mm256_castsi256_ps(_mm256_cmpeq_epi32(a.0, b.0)));
        lt_u32(a: U32, b: U32) -> Mask = {
            // Signed comparison of both sides moved down by 2³¹.
            let sign = _mm256_set1_epi32(i32::MIN);
            let (a, b) = (_mm256_xor_si256(a.0, sign), _mm256_xor_si256(b.0, sign));
            Mask(_mm256_castsi256_ps(_mm256_cmpgt_epi32(b, a)))
        };

        select(mask: Mask, yes: F32, no: F32) -> F32 = F32(_mm256_blendv_ps(no.0, yes.0, mask.0));
        select_u32(mask: Mask, yes: U32, no: U32) -> U32 =
            U32(_mm256_blendv_epi8(no.0, yes.0, _mm256_castps_si256(mask.0)));

        cast_u32(x: F32) -> U32 = U32(_mm256_castps_si256(x.0));
        cast_f32(x: U32) -> F32 = F32(_mm256_castsi256_ps(x.0));
        widen(x: F32) -> F64 = F64(
            _mm256_cvtps_pd(_mm256_castps256_ps128(x.0)),
            _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(x.0)),
        );
        narrow(x: F64) -> F32 = F32(_mm256_set_m128(_mm256_cvtpd_ps(x.1), _mm256_cvtpd_ps(x.0)));

        mask(bits: u32) -> Mask = {
            let lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let named = _mm256_and_si256(_mm256_set1_epi32(bits as i32), lane);
            Mask(_mm256_castsi256_ps(_mm256_cmpeq_epi32(named, lane)))
        };
        bits(mask: Mask) -> u32 = _mm256_movemask_ps(mask.0) as u32;

        permute(x: F32, from: U32) -> F32 = F32(_mm256_permutevar8x32_ps(x.0, from.0));
        permute_u32(x: U32, from: U32) -> U32 = U32(_mm256_permutevar8x32_epi32(x.0, from.0));
    }

    #[inline(always)]
    fn load_u16(self, from: &[u16]) -> F32 {
        let from = from[..WIDTH].as_ptr();
        // SAFETY: the token proves the instructions; 8 lanes are 16 bytes.
        unsafe { F32(_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_loadu_si128(from.cast())))) }
    }

    #[inline(always)]
    fn columns(self, records: &[[f32; 8]]) -> [F32; 8] {
        let records = &records[..WIDTH];
        // SAFETY: the token proves the instructions; each record is a vector long.
        unsafe {
            let mut rows = [_mm256_setzero_ps(); 8];
            for i in 0..WIDTH {
                rows[i] = _mm256_loadu_ps(records[i].as_ptr());
            }
            // Records 0..4 and 4..8 side by side, so that shuffles within 128 bits do the rest.
            let mut low = [_mm256_setzero_ps(); 4];
            let mut high = low;
            for i in 0..4 {
                low[i] = _mm256_permute2f128_ps::<0x20>(rows[i], rows[i + 4]);
                high[i] = _mm256_permute2f128_ps::<0x31>(rows[i], rows[i + 4]);
            }
            let [a, b, c, d] = four_columns(low);
            let [e, f, g, h] = four_columns(high);
            [a, b, c, d, e, f, g, h]
        }
    }

    #[inline(always)]
    fn frame(self, shear: &Shear) -> Frame {
        let [kx, ky, kz] = shear.axes;
        let ([ox, oy, oz], [sx, sy]) = (shear.origin, shear.slope);
        // SAFETY: the token proves the instructions.
        unsafe {
            Frame {
                axes: _mm256_broadcastsi128_si256(_mm_setr_epi32(kx as i32, ky as i32, kz as i32, 3)),
                origin: _mm256_setr_ps(ox, oy, oz, 0.0, ox, oy, oz, 0.0),
                slope: _mm256_setr_ps(sx, sy, 0.0, 0.0, sx, sy, 0.0, 0.0),
                along: _mm256_set1_ps(shear.along as f32),
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
            // As with AVX-512, but two triangles at a time: each in its own half.
            let minus = _mm256_set1_ps(-0.0);
            macro_rules! bits {
                ($mask:expr) => {
                    _mm256_movemask_ps($mask) as u32
                };
            }
            macro_rules! below {
                ($p:expr, $q:expr) => {
                    _mm256_cmp_ps::<_CMP_LT_OQ>($p, $q)
                };
            }
            macro_rules! at_least {
                ($p:expr, $q:expr) => {
                    _mm256_cmp_ps::<_CMP_GE_OQ>($p, $q)
                };
            }
            macro_rules! size {
                ($p:expr) => {
                    _mm256_andnot_ps(minus, $p)
                };
            }
            macro_rules! two {
                ($first:literal) => {{
                    let Edges { u, u2, v, v2, w, w2, az, bz, cz, may_hit } =
                        edges(frame, corners[$first], corners[$first + 1]);
                    if may_hit == 0 {
                        (0, 0)
                    } else {
                        let sum = _mm256_add_ps(_mm256_add_ps(size!(u), size!(v)), size!(w));
                        let sum = _mm256_add_ps(sum, _mm256_permute_ps::<0b11_10_00_01>(sum));
                        let reach = _mm256_max_ps(_mm256_max_ps(size!(az), size!(bz)), size!(cz));
                        let (u, v, w) = (_mm256_sub_ps(u, u2), _mm256_sub_ps(v, v2), _mm256_sub_ps(w, w2));
                        let distance = _mm256_add_ps(
                            _mm256_add_ps(_mm256_mul_ps(u, az), _mm256_mul_ps(v, bz)),
                            _mm256_mul_ps(w, cz),
                        );
                        let scale = _mm256_mul_ps(_mm256_add_ps(_mm256_add_ps(u, v), w), frame.along);
                        let sign = _mm256_and_ps(scale, minus);
                        let (distance, scale) = (_mm256_xor_ps(distance, sign), _mm256_xor_ps(scale, sign));
                        let error = _mm256_mul_ps(_mm256_mul_ps(sum, reach), _mm256_set1_ps(DISTANCE));
                        let least = _mm256_mul_ps(sum, _mm256_set1_ps(SIGN));
                        let low = _mm256_min_ps(_mm256_min_ps(u, v), w);
                        let high = _mm256_max_ps(_mm256_max_ps(u, v), w);
                        let most = _mm256_set1_ps(MOST_SCALE);
                        let inside =
                            _mm256_or_ps(below!(least, low), below!(least, _mm256_xor_ps(high, minus)));
                        let large = _mm256_and_ps(
                            at_least!(sum, _mm256_set1_ps(LEAST_SUM)),
                            at_least!(reach, _mm256_set1_ps(LEAST_REACH)),
                        );
                        let range = _mm256_and_ps(
                            at_least!(scale, _mm256_set1_ps(LEAST_SCALE)),
                            _mm256_and_ps(at_least!(most, scale), at_least!(most, error)),
                        );
                        let sure = _mm256_and_ps(inside, _mm256_and_ps(large, range));
                        let end = _mm256_mul_ps(_mm256_set1_ps(limit), scale);
                        let behind = _mm256_and_ps(sure, below!(end, _mm256_sub_ps(distance, error)));
                        _mm256_store_ps(quad.distance.as_mut_ptr().add(4 * $first), distance);
                        _mm256_store_ps(quad.scale.as_mut_ptr().add(4 * $first), scale);
                        _mm256_store_ps(quad.error.as_mut_ptr().add(4 * $first), error);
                        (may_hit & !bits!(behind), bits!(sure))
                    }
                }};
            }
            let ((first, first_sure), (second, second_sure)) = (two!(0), two!(2));
            quad.sure = _pext_u32(first_sure | second_sure << 8, 0x1111);
            _pext_u32(first | second << 8, 0x1111)
        }
    }

    #[inline(always)]
    unsafe fn may_hit(self, shear: &Shear, &[a, b, c, d]: &[[*const [f32; 3]; 3]; 4]) -> u32 {
        let frame = self.frame(shear);
        // SAFETY: the token proves the instructions; the caller vouches for the corners.
        let (first, second) = unsafe { (edges(&frame, a, b), edges(&frame, c, d)) };
        // SAFETY: the token proves BMI2.
        unsafe { _pext_u32(first.may_hit | second.may_hit << 8, 0x1111) }
    }
    #[inline(always)]
    unsafe fn decide(self, shear: &Shear, corners: [*const [f32; 3]; 3]) -> Option<Intersection> {
        // SAFETY: the token proves AVX2; the caller vouches for the corners.
        unsafe { decide_by_lanes(shear, corners) }
    }

    #[inline(always)]
    fn compress(self, mask: Mask, x: U32, to: &mut [u32]) -> usize {
        let to = &mut to[..WIDTH];
        let bits = self.bits(mask);
        // SAFETY: the token proves the instructions; the table has an entry for each of 8 bits, `to` has 8 entries.
        unsafe {
            let packed = *FRONT.get_unchecked(bits as usize);
            let from = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(packed as i64));
            _mm256_storeu_si256(to.as_mut_ptr().cast(), _mm256_permutevar8x32_epi32(x.0, from));
        }
        bits.count_ones() as usize
    }

    #[inline(always)]
    unsafe fn gather<const SCALE: i32>(self, base: *const u8, index: U32) -> F32 {
        // SAFETY: the caller's promise.
        self.cast_f32(unsafe { self.gather_u32::<SCALE>(base, index) })
    }
    #[inline(always)]
    unsafe fn gather_u32<const SCALE: i32>(self, base: *const u8, index: U32) -> U32 {
        // Not the instruction: see `load_two`; and QEMU 7.2 gives every lane the first one's value.
        let (mut at, mut lanes) = ([0; WIDTH], [0; WIDTH]);
        self.store_u32(index, &mut at);
        for (lane, &at) in lanes.iter_mut().zip(&at) {
            // SAFETY: the caller vouches for the addresses.
            *lane = unsafe { base.add(at as usize * SCALE as usize).cast::<u32>().read_unaligned() };
        }
        self.load_u32(&lanes)
    }
    #[inline(always)]
    unsafe fn gather_pairs<const SCALE: i32>(self, base: *const u8, index: U32) -> (U32, U32) {
        let mut at = [0; WIDTH];
        self.store_u32(index, &mut at);
        // SAFETY: the caller's promise.
        unsafe { self.load_pairs::<SCALE>(base, &at) }
    }
    #[inline(always)]
    unsafe fn gather_rows<const SCALE: i32>(self, base: *const u8, index: U32) -> [U32; 4] {
        let mut at = [0; WIDTH];
        self.store_u32(index, &mut at);
        // SAFETY: the token proves the instructions; the caller vouches for the addresses.
        unsafe { rows(base, SCALE as usize, &at) }
    }
    #[inline(always)]
    unsafe fn load_pairs<const SCALE: i32>(self, base: *const u8, at: &[u32]) -> (U32, U32) {
        let (at, scale) = (&at[..WIDTH], SCALE as usize);
        // SAFETY: the token proves the instructions; the caller vouches for the addresses.
        unsafe {
            // Lanes 0 1 4 5 and 2 3 6 7, so that shuffling inside of halves puts them in order.
            let a = _mm256_castsi256_ps(both(load_two(base, scale, at, 0), load_two(base, scale, at, 4)));
            let b = _mm256_castsi256_ps(both(load_two(base, scale, at, 2), load_two(base, scale, at, 6)));
            let even = _mm256_shuffle_ps::<0b10_00_10_00>(a, b);
            let odd = _mm256_shuffle_ps::<0b11_01_11_01>(a, b);
            (U32(_mm256_castps_si256(even)), U32(_mm256_castps_si256(odd)))
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
            let (low, high) = (_mm256_unpacklo_epi32(a.0, b.0), _mm256_unpackhi_epi32(a.0, b.0));
            let (low2, high2) = (_mm256_unpacklo_epi32(c.0, d.0), _mm256_unpackhi_epi32(c.0, d.0));
            store_halves(base, at, 0, _mm256_unpacklo_epi64(low, low2));
            store_halves(base, at, 1, _mm256_unpackhi_epi64(low, low2));
            store_halves(base, at, 2, _mm256_unpacklo_epi64(high, high2));
            store_halves(base, at, 3, _mm256_unpackhi_epi64(high, high2));
        }
    }
    #[inline(always)]
    fn pick(self, table: &[f32; 32], index: U32) -> F32 {
        // SAFETY: the token proves the instructions; the table has 32 entries. Permuting looks at three bits of an index,
        // blending at the sign.
        unsafe {
            let mut eight = [_mm256_setzero_ps(); 4];
            for i in 0..4 {
                eight[i] = _mm256_permutevar8x32_ps(_mm256_loadu_ps(table.as_ptr().add(8 * i)), index.0);
            }
            let third = _mm256_castsi256_ps(_mm256_slli_epi32::<28>(index.0));
            let fourth = _mm256_castsi256_ps(_mm256_slli_epi32::<27>(index.0));
            let low = _mm256_blendv_ps(eight[0], eight[1], third);
            let high = _mm256_blendv_ps(eight[2], eight[3], third);
            F32(_mm256_blendv_ps(low, high, fourth))
        }
    }
}

/// [`Shear::decide`] with the three corners side by side: the same operations, so the same bits.
///
/// # Safety
/// The processor must have AVX2, and every pointer must be that of a corner: three f32.
#[inline(always)]
pub(super) unsafe fn decide_by_lanes(shear: &Shear, corners: [*const [f32; 3]; 3]) -> Option<Intersection> {
    // SAFETY: the caller's promise; axes are below 3.
    unsafe {
        let [a, b, c] = [corners[0].cast::<f32>(), corners[1].cast::<f32>(), corners[2].cast::<f32>()];
        let [kx, ky, kz] = shear.axes;
        // Macros, since closures fall out of the inline chain.
        macro_rules! from_origin {
            ($k:ident) => {
                _mm_sub_ps(
                    _mm_setr_ps(*a.add($k), *b.add($k), *c.add($k), 0.0),
                    _mm_set1_ps(*shear.origin.get_unchecked($k)),
                )
            };
        }
        let z = from_origin!(kz);
        let x = _mm_sub_ps(from_origin!(kx), _mm_mul_ps(_mm_set1_ps(shear.slope[0]), z));
        let y = _mm_sub_ps(from_origin!(ky), _mm_mul_ps(_mm_set1_ps(shear.slope[1]), z));
        let (x, y, z) = (_mm256_cvtps_pd(x), _mm256_cvtps_pd(y), _mm256_cvtps_pd(z));
        // Each corner with the next one: w, u, v, and nothing in the fourth lane.
        const NEXT: i32 = 0b11_00_10_01;
        let (next_x, next_y) = (_mm256_permute4x64_pd::<NEXT>(x), _mm256_permute4x64_pd::<NEXT>(y));
        let edges = _mm256_sub_pd(_mm256_mul_pd(next_x, y), _mm256_mul_pd(next_y, x));
        let zero = _mm256_setzero_pd();
        let below = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(edges, zero)) & 0b111;
        let above = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(zero, edges)) & 0b111;
        if below != 0 && above != 0 {
            return None;
        }
        // u, v, w, and what they weigh.
        let edges = _mm256_permute4x64_pd::<NEXT>(edges);
        let parts = _mm256_mul_pd(edges, z);
        macro_rules! three {
            ($from:ident) => {{
                let low = _mm256_castpd256_pd128($from);
                let high = _mm256_extractf128_pd::<1>($from);
                (_mm_cvtsd_f64(low), _mm_cvtsd_f64(_mm_unpackhi_pd(low, low)), _mm_cvtsd_f64(high))
            }};
        }
        let (u, v, w) = three!(edges);
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        let (at_a, at_b, at_c) = three!(parts);
        let per_along = 1.0 / (det * shear.along);
        let t = ((at_a + at_b + at_c) * per_along) as f32;
        let per_det = shear.along * per_along;
        if t.is_nan() {
            None
        } else {
            Some(Intersection { t, u: (v * per_det) as f32, v: (w * per_det) as f32 })
        }
    }
}

/// Eight times sixteen bytes, as columns.
///
/// # Safety
/// The processor must have AVX2, `at` 8 entries, and the bytes must be readable.
#[inline(always)]
unsafe fn rows(base: *const u8, scale: usize, at: &[u32]) -> [U32; 4] {
    // SAFETY: the caller's promise.
    unsafe {
        let first = both(load_row(base, scale, at, 0), load_row(base, scale, at, 4));
        let second = both(load_row(base, scale, at, 1), load_row(base, scale, at, 5));
        let third = both(load_row(base, scale, at, 2), load_row(base, scale, at, 6));
        let fourth = both(load_row(base, scale, at, 3), load_row(base, scale, at, 7));
        let (low, high) = (_mm256_unpacklo_epi32(first, second), _mm256_unpackhi_epi32(first, second));
        let (low2, high2) = (_mm256_unpacklo_epi32(third, fourth), _mm256_unpackhi_epi32(third, fourth));
        [
            U32(_mm256_unpacklo_epi64(low, low2)),
            U32(_mm256_unpackhi_epi64(low, low2)),
            U32(_mm256_unpacklo_epi64(high, high2)),
            U32(_mm256_unpackhi_epi64(high, high2)),
        ]
    }
}

/// Writes both halves of a vector where `lane` and the fourth one after it belong.
///
/// # Safety
/// The processor must have AVX2, `at` 8 entries, `lane` must be below 4, and the bytes must be writable.
#[inline(always)]
unsafe fn store_halves(base: *mut u8, at: &[u32], lane: usize, x: __m256i) {
    // SAFETY: the caller's promise.
    unsafe {
        _mm_storeu_si128(base.add(lane_at(at, lane)).cast(), _mm256_castsi256_si128(x));
        _mm_storeu_si128(base.add(lane_at(at, lane + 4)).cast(), _mm256_extracti128_si256::<1>(x));
    }
}

/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn both(lower: __m128i, upper: __m128i) -> __m256i {
    // SAFETY: the caller's promise.
    unsafe { _mm256_inserti128_si256::<1>(_mm256_castsi128_si256(lower), upper) }
}

/// Transposes 4 × 4 within both 128-bit halves.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn four_columns([a, b, c, d]: [__m256; 4]) -> [F32; 4] {
    // SAFETY: the caller's promise.
    unsafe {
        let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
        let (ab2, cd2) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
        [
            F32(_mm256_shuffle_ps::<0b01_00_01_00>(ab, cd)),
            F32(_mm256_shuffle_ps::<0b11_10_11_10>(ab, cd)),
            F32(_mm256_shuffle_ps::<0b01_00_01_00>(ab2, cd2)),
            F32(_mm256_shuffle_ps::<0b11_10_11_10>(ab2, cd2)),
        ]
    }
}

/// Masks of f64 lanes as one of f32 lanes.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn joined(lower: __m256d, upper: __m256d) -> Mask {
    // SAFETY: the caller's promise.
    unsafe {
        let (lower, upper) = (_mm256_castpd_ps(lower), _mm256_castpd_ps(upper));
        let even = _mm256_castps_pd(_mm256_shuffle_ps::<0b10_00_10_00>(lower, upper));
        Mask(_mm256_castpd_ps(_mm256_permute4x64_pd::<0b11_01_10_00>(even)))
    }
}

/// For each mask, the lanes that it names, one a byte, lowest first.
static FRONT: [u64; 256] = {
    let mut table = [0; 256];
    let mut bits = 0;
    while bits < 256 {
        let (mut lane, mut place) = (0, 0);
        while lane < 8 {
            if bits >> lane & 1 == 1 {
                table[bits] |= lane << (8 * place);
                place += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
};
