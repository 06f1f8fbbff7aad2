//! SIMD behind one trait: lanes of f32, u32 and f64, their masks, and the choice of the instruction set.
//!
//! Source: the shape (a token that proves what the processor can do, vectors that can only be made with it, kernels
//! that are inlined into one entry function an instruction set) follows Rust's `pulp` and `memchr`.
//!
//! 1. A value of a [`Simd`] type exists only where the processor has its instructions: making one is the one `unsafe`
//!    step, in [`level`]. Every vector comes from a token, so arithmetic on vectors is safe.
//! 2. Everything is `#[inline(always)]` and ends up inside a function with `#[target_feature]`. A kernel implements
//!    [`Kernel`] and must keep that chain: whatever it calls with vectors is `#[inline(always)]` too.
//! 3. Nothing is fused: `a * b + c` rounds twice at every level, so all levels give the same bits. `scalar.rs`, plain
//!    arrays, is the oracle of the tests; rays go one by one where there are no vectors.
//! 4. Kernels see 16 lanes at every level: AVX2 is [`Twice`] 8 of them, SSE2 and NEON twice twice 4.

mod four;
mod level;
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod macros;
mod order;
#[cfg(test)]
mod scalar;
#[cfg(test)]
mod tests;
mod twice;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "aarch64")]
mod neon;
#[cfg(target_arch = "x86_64")]
mod sse2;

pub use level::{InstructionSet, UnknownInstructionSet};

pub(crate) use four::Four;
pub(crate) use level::Kernel;
#[cfg(test)]
pub(crate) use scalar::Scalar;
pub(crate) use twice::Twice;

#[cfg(target_arch = "aarch64")]
pub(crate) use neon::Neon;
#[cfg(target_arch = "x86_64")]
pub(crate) use {avx2::Avx2, avx512::Avx512, sse2::Sse2};

use crate::geometry::{Estimate, Intersection, Shear};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Not, Shl, Shr, Sub};

/// Proof that the processor has an instruction set, and its operations on vectors of [`Simd::WIDTH`] lanes.
///
/// Masks are a lane's "yes" or "no"; as bits, lane 0 is the lowest.
pub(crate) trait Simd: Copy + Send + Sync + 'static {
    /// Lanes, at most 16.
    const WIDTH: usize;

    /// f32; operations round to nearest, each on its own.
    type F: Copy
        + Add<Output = Self::F>
        + Sub<Output = Self::F>
        + Mul<Output = Self::F>
        + Div<Output = Self::F>;
    /// f64, as many lanes.
    type D: Copy
        + Add<Output = Self::D>
        + Sub<Output = Self::D>
        + Mul<Output = Self::D>
        + Div<Output = Self::D>;
    /// u32; sums and differences wrap, shifts are by less than 32.
    type U: Copy
        + Add<Output = Self::U>
        + Sub<Output = Self::U>
        + BitAnd<Output = Self::U>
        + BitOr<Output = Self::U>
        + BitXor<Output = Self::U>
        + Shl<u32, Output = Self::U>
        + Shr<u32, Output = Self::U>;
    /// A ray's frame, as [`Simd::quad`] takes it.
    type Frame: Copy;
    /// Yes or no a lane.
    type M: Copy + BitAnd<Output = Self::M> + BitOr<Output = Self::M> + Not<Output = Self::M>;

    /// A vector with this f32 in every lane.
    fn f32s(self, x: f32) -> Self::F;
    /// A vector with this u32 in every lane.
    fn u32s(self, x: u32) -> Self::U;
    /// A vector with this f64 in every lane.
    fn f64s(self, x: f64) -> Self::D;
    /// The mask with these bits; higher ones are ignored.
    fn mask(self, bits: u32) -> Self::M;

    /// The first lanes of a slice. Panics when it is shorter.
    fn load(self, from: &[f32]) -> Self::F;
    /// The first lanes of a slice of u32. Panics when it is shorter.
    fn load_u32(self, from: &[u32]) -> Self::U;
    /// Writes f32 into the first lanes of a slice. Panics when it is shorter.
    fn store(self, x: Self::F, to: &mut [f32]);
    /// Writes u32 into the first lanes of a slice. Panics when it is shorter.
    fn store_u32(self, x: Self::U, to: &mut [u32]);

    /// The first records of a slice as columns: lane `i` of column `k` is `records[i][k]`. Panics when it is shorter.
    fn columns(self, records: &[[f32; 8]]) -> [Self::F; 8];

    /// The first lanes of a slice of u16, as f32. Panics when it is shorter.
    #[inline(always)]
    fn load_u16(self, from: &[u16]) -> Self::F {
        let mut lanes = [0.0; 16];
        for (to, &from) in lanes.iter_mut().zip(&from[..Self::WIDTH]) {
            *to = f32::from(from);
        }
        self.load(&lanes)
    }
    /// `a · b + c`, rounded once or twice: the only operation whose result may differ between levels. It is for bounds alone.
    #[inline(always)]
    fn bound_mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        a * b + c
    }

    /// What [`Simd::quad`] needs of a ray.
    fn frame(self, shear: &Shear) -> Self::Frame;
    /// Which of four triangles a ray may hit at `limit` or before, a bit each, decided as [`Shear::may_hit`] does; those that it surely hits
    /// behind `limit` are left out. Where there are any, `quad` says what is known of them.
    ///
    /// # Safety
    /// Every pointer must be that of a corner: three f32.
    unsafe fn quad(
        self,
        frame: &Self::Frame,
        corners: &[[*const [f32; 3]; 3]; 4],
        limit: f32,
        quad: &mut Quad,
    ) -> u32;

    /// Which of four triangles a ray may hit, a bit each, decided as [`Shear::may_hit`] does: [`Simd::quad`] without what it says besides, for streams,
    /// where f64 soon costs less than that.
    ///
    /// # Safety
    /// Every pointer must be that of a corner: three f32.
    #[inline(always)]
    unsafe fn may_hit(self, shear: &Shear, corners: &[[*const [f32; 3]; 3]; 4]) -> u32 {
        let mut hits = 0;
        for (k, &[a, b, c]) in corners.iter().enumerate() {
            // SAFETY: the caller's promise.
            let corners = unsafe { [*a, *b, *c] };
            hits |= u32::from(shear.may_hit(&corners)) << k;
        }
        hits
    }
    /// [`Shear::decide`] of a triangle whose corners stand here.
    ///
    /// # Safety
    /// Every pointer must be that of a corner: three f32.
    #[inline(always)]
    unsafe fn decide(self, shear: &Shear, [a, b, c]: [*const [f32; 3]; 3]) -> Option<Intersection> {
        // SAFETY: the caller's promise.
        shear.decide(&unsafe { [*a, *b, *c] })
    }

    /// `a` where it is the larger, else `b`: as `prepared::larger`, so a NaN in `a` is passed over.
    fn larger(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a` where it is the smaller, else `b`.
    fn smaller(self, a: Self::F, b: Self::F) -> Self::F;
    /// The least lane. NaN may be passed over.
    #[inline(always)]
    fn least(self, x: Self::F) -> f32 {
        let mut lanes = [f32::INFINITY; 16];
        self.store(x, &mut lanes);
        lanes[..Self::WIDTH].iter().fold(f32::INFINITY, |a, &b| if b < a { b } else { a })
    }
    /// The greatest lane. NaN may be passed over.
    #[inline(always)]
    fn most(self, x: Self::F) -> f32 {
        let mut lanes = [f32::NEG_INFINITY; 16];
        self.store(x, &mut lanes);
        lanes[..Self::WIDTH].iter().fold(f32::NEG_INFINITY, |a, &b| if b > a { b } else { a })
    }
    /// Without the sign.
    fn abs(self, x: Self::F) -> Self::F;

    /// a < b; false with a NaN.
    fn lt(self, a: Self::F, b: Self::F) -> Self::M;
    /// a ≤ b; false with a NaN.
    fn le(self, a: Self::F, b: Self::F) -> Self::M;
    /// a = b; false with a NaN.
    fn eq(self, a: Self::F, b: Self::F) -> Self::M;
    /// a < b; false with a NaN.
    fn lt_f64(self, a: Self::D, b: Self::D) -> Self::M;
    /// a = b; false with a NaN.
    fn eq_f64(self, a: Self::D, b: Self::D) -> Self::M;
    /// a = b.
    fn eq_u32(self, a: Self::U, b: Self::U) -> Self::M;
    /// a < b, unsigned.
    fn lt_u32(self, a: Self::U, b: Self::U) -> Self::M;

    /// Lanes of `yes` where the mask is set, and of `no` elsewhere.
    fn select(self, mask: Self::M, yes: Self::F, no: Self::F) -> Self::F;
    /// Lanes of `yes` where the mask is set, and of `no` elsewhere.
    fn select_u32(self, mask: Self::M, yes: Self::U, no: Self::U) -> Self::U;

    /// The bits of f32 read as u32.
    fn cast_u32(self, x: Self::F) -> Self::U;
    /// The bits of u32 read as f32.
    fn cast_f32(self, x: Self::U) -> Self::F;
    /// The same numbers as f64, exactly.
    fn widen(self, x: Self::F) -> Self::D;
    /// Rounded to nearest, as `x as f32`.
    fn narrow(self, x: Self::D) -> Self::F;

    /// The mask's bits.
    fn bits(self, mask: Self::M) -> u32;
    /// Any lane?
    #[inline(always)]
    fn any(self, mask: Self::M) -> bool {
        self.bits(mask) != 0
    }
    /// All lanes?
    #[inline(always)]
    fn all(self, mask: Self::M) -> bool {
        self.bits(mask) == (1 << Self::WIDTH) - 1
    }

    /// Lane `i` of the result is lane `from[i]` of `x`. Indices must be below the width: other ones give any lane.
    fn permute(self, x: Self::F, from: Self::U) -> Self::F;
    /// [`Simd::permute`] of u32.
    fn permute_u32(self, x: Self::U, from: Self::U) -> Self::U;

    /// The lanes that the mask names, packed to the front of `to`; returns how many. What follows them in the first
    /// `WIDTH` entries is overwritten with anything. Panics when `to` is shorter than that.
    fn compress(self, mask: Self::M, x: Self::U, to: &mut [u32]) -> usize;

    /// Takes the keys of the lanes that `mask` names, two or more, all below 2³¹. Returns the least, and writes the others
    /// to `others`, each with `tag` behind it, the greatest first. What follows them there is overwritten with anything.
    ///
    /// # Safety
    /// There must be room for 16 pairs.
    #[inline(always)]
    unsafe fn least_and_others(self, mask: u32, keys: Self::U, tag: u32, others: *mut [u32; 2]) -> u32 {
        let mut packed = [0; 16];
        let count = self.compress(self.mask(mask), keys, &mut packed);
        // SAFETY: the caller's promise.
        unsafe { order::least_and_others(&mut packed, count, tag, others) }
    }

    /// The f32 at `base + index · SCALE` bytes, each lane its own. Any alignment.
    ///
    /// # Safety
    /// Every lane's four bytes must be readable and initialised, masked or not, and every index below 2³¹.
    unsafe fn gather<const SCALE: i32>(self, base: *const u8, index: Self::U) -> Self::F;
    /// The u32 at `base + index · SCALE` bytes, each lane its own. Any alignment.
    ///
    /// # Safety
    /// Every lane's four bytes must be readable and initialised, masked or not, and every index below 2³¹.
    unsafe fn gather_u32<const SCALE: i32>(self, base: *const u8, index: Self::U) -> Self::U;
    /// The eight bytes at `base + index · SCALE` as their lower and their upper u32, little-endian. Any alignment.
    ///
    /// # Safety
    /// Every lane's eight bytes must be readable and initialised, masked or not. Indices may have all 32 bits.
    unsafe fn gather_pairs<const SCALE: i32>(self, base: *const u8, index: Self::U) -> (Self::U, Self::U);

    /// The sixteen bytes at `base + index · SCALE` as four u32, little-endian. Any alignment.
    ///
    /// # Safety
    /// Every lane's sixteen bytes must be readable and initialised, masked or not. Indices may have all 32 bits.
    #[inline(always)]
    unsafe fn gather_rows<const SCALE: i32>(self, base: *const u8, index: Self::U) -> [Self::U; 4] {
        // SAFETY: the caller's promise covers both halves.
        unsafe {
            let (a, b) = self.gather_pairs::<SCALE>(base, index);
            let (c, d) = self.gather_pairs::<SCALE>(base.add(8), index);
            [a, b, c, d]
        }
    }

    /// [`Simd::gather_pairs`] at indices that lie in memory. Panics when there are fewer indices than lanes.
    ///
    /// # Safety
    /// That of [`Simd::gather_pairs`].
    #[inline(always)]
    unsafe fn load_pairs<const SCALE: i32>(self, base: *const u8, at: &[u32]) -> (Self::U, Self::U) {
        // SAFETY: the caller's promise.
        unsafe { self.gather_pairs::<SCALE>(base, self.load_u32(at)) }
    }

    /// [`Simd::gather_rows`] at offsets in bytes that lie in memory. Panics when there are fewer offsets than lanes.
    ///
    /// # Safety
    /// That of [`Simd::gather_rows`].
    #[inline(always)]
    unsafe fn load_rows(self, base: *const u8, at: &[u32]) -> [Self::U; 4] {
        // SAFETY: the caller's promise.
        unsafe { self.gather_rows::<1>(base, self.load_u32(at)) }
    }

    /// Writes sixteen bytes a lane to `base + at`, offsets in bytes. In any order, so places should not overlap. Panics
    /// when there are fewer offsets than lanes.
    ///
    /// # Safety
    /// Every lane's sixteen bytes must be writable.
    #[inline(always)]
    unsafe fn store_rows(self, base: *mut u8, at: &[u32], rows: [Self::U; 4]) {
        let at = &at[..Self::WIDTH];
        let mut columns = [[0; 16]; 4];
        self.store_u32(rows[0], &mut columns[0]);
        self.store_u32(rows[1], &mut columns[1]);
        self.store_u32(rows[2], &mut columns[2]);
        self.store_u32(rows[3], &mut columns[3]);
        for lane in 0..Self::WIDTH {
            let [a, b, c, d] = columns;
            let row = [a[lane], b[lane], c[lane], d[lane]];
            // SAFETY: the caller's promise.
            unsafe { base.add(at[lane] as usize).cast::<[u32; 4]>().write_unaligned(row) };
        }
    }

    /// Lane `i` of the result is `table[index[i] % 32]`.
    #[inline(always)]
    fn pick(self, table: &[f32; 32], index: Self::U) -> Self::F {
        // SAFETY: five bits stay inside the table.
        unsafe { self.gather::<4>(table.as_ptr().cast(), index & self.u32s(31)) }
    }
}

/// An index of a lane, from memory.
///
/// Volatile, because the compiler would else take the indices out of the vector that was just stored there: seven
/// instructions for four lanes, where a load a lane costs one.
///
/// # Safety
/// `at` must have more than `lane` entries.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn lane_at(at: &[u32], lane: usize) -> usize {
    debug_assert!(lane < at.len());
    // SAFETY: the caller's promise.
    unsafe { at.as_ptr().add(lane).read_volatile() as usize }
}

/// The 8 bytes at `base + at[lane] · scale`, then those of the next lane.
///
/// Plain loads, though there are gather instructions: with the usual microcode against data sampling one of those takes
/// 24 cycles whatever its width (Ice Lake), and without it about as long as the loads it stands for.
///
/// # Safety
/// `at` must have both lanes, and the bytes must be readable.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn load_two(base: *const u8, scale: usize, at: &[u32], lane: usize) -> std::arch::x86_64::__m128i {
    use std::arch::x86_64::*;
    // SAFETY: the caller's promise; SSE2 is part of x86-64.
    unsafe {
        let (a, b) = (base.add(lane_at(at, lane) * scale), base.add(lane_at(at, lane + 1) * scale));
        _mm_castpd_si128(_mm_loadh_pd(_mm_castsi128_pd(_mm_loadl_epi64(a.cast())), b.cast()))
    }
}

/// The 16 bytes at `base + at[lane] · scale`.
///
/// # Safety
/// `at` must have the lane, and the bytes must be readable.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn load_row(base: *const u8, scale: usize, at: &[u32], lane: usize) -> std::arch::x86_64::__m128i {
    // SAFETY: the caller's promise; SSE2 is part of x86-64.
    unsafe { std::arch::x86_64::_mm_loadu_si128(base.add(lane_at(at, lane) * scale).cast()) }
}

/// The lanes of a vector, in memory. AVX2 stores them in place instead: behind [`lane_at`]'s volatile reads the copy would stay.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
#[inline(always)]
fn lanes<S: Simd, const WIDTH: usize>(simd: S, x: S::U) -> [u32; WIDTH] {
    let mut lanes = [0; WIDTH];
    simd.store_u32(x, &mut lanes);
    lanes
}

/// What [`Simd::quad`] knows of four triangles; each has its place in every fourth lane.
#[repr(align(64))]
pub(crate) struct Quad {
    /// A bit a triangle: [`Estimate::sure`].
    sure: u32,
    distance: [f32; 16],
    scale: [f32; 16],
    error: [f32; 16],
}

impl Quad {
    pub(crate) fn new() -> Self {
        Self { sure: 0, distance: [0.0; 16], scale: [0.0; 16], error: [0.0; 16] }
    }

    /// Of the triangle at a place below 4.
    #[inline(always)]
    pub(crate) fn estimate(&self, place: usize) -> Estimate {
        let at = 4 * (place & 3);
        Estimate {
            sure: self.sure >> place & 1 == 1,
            distance: self.distance[at],
            scale: self.scale[at],
            error: self.error[at],
        }
    }
}

/// [`Simd::quad`] without vectors.
///
/// # Safety
/// Every pointer must be that of a corner: three f32.
#[inline(always)]
unsafe fn quad_one_by_one(
    shear: &Shear,
    corners: &[[*const [f32; 3]; 3]; 4],
    limit: f32,
    quad: &mut Quad,
) -> u32 {
    let mut hits = 0;
    quad.sure = 0;
    for (k, &[a, b, c]) in corners.iter().enumerate() {
        // SAFETY: the caller's promise.
        let corners = unsafe { [*a, *b, *c] };
        if !shear.may_hit(&corners) {
            continue;
        }
        let estimate = shear.estimate(&corners);
        if !estimate.is_behind(limit) {
            hits |= 1 << k;
            quad.sure |= u32::from(estimate.sure) << k;
            (quad.distance[4 * k], quad.scale[4 * k], quad.error[4 * k]) =
                (estimate.distance, estimate.scale, estimate.error);
        }
    }
    hits
}

/// Asks for the cache line at an address, which may be any: a hint, and nothing where there is none.
#[inline(always)]
pub(crate) fn prefetch<T>(at: *const T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: SSE is part of x86-64; a prefetch reads nothing that could be seen.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(at.cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = at;
}
