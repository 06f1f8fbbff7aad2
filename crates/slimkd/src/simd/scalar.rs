//! The oracle: arrays of 16 and loops over them.
//!
//! Nothing is inlined: kernels of thousands of unrolled lanes took minutes to compile, and nobody waits for the oracle.

use super::{Quad, Shear, Simd, quad_one_by_one};
use std::array::from_fn;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Not, Shl, Shr, Sub};

const WIDTH: usize = 16;

/// Nothing but plain Rust: works everywhere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scalar;

/// A value a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Array<T>([T; WIDTH]);

macro_rules! lanewise {
    ($($trait:ident::$method:ident $types:tt $apply:expr;)*) => { $(lanewise!(@ $trait $method $types $apply);)* };
    (@ $trait:ident $method:ident [$($type:ty),*] $apply:expr) => {
        $(impl $trait for Array<$type> {
            type Output = Self;
            #[inline(never)]
            fn $method(self, other: Self) -> Self {
                let apply: fn($type, $type) -> $type = $apply;
                Self(from_fn(|i| apply(self.0[i], other.0[i])))
            }
        })*
    };
}

lanewise! {
    Add::add [f32, f64] |a, b| a + b;
    Sub::sub [f32, f64] |a, b| a - b;
    Mul::mul [f32, f64] |a, b| a * b;
    Div::div [f32, f64] |a, b| a / b;
    Add::add [u32] |a, b| a.wrapping_add(b);
    Sub::sub [u32] |a, b| a.wrapping_sub(b);
    BitAnd::bitand [u32, bool] |a, b| a & b;
    BitOr::bitor [u32, bool] |a, b| a | b;
    BitXor::bitxor [u32] |a, b| a ^ b;
}

impl Shl<u32> for Array<u32> {
    type Output = Self;
    #[inline(never)]
    fn shl(self, by: u32) -> Self {
        Self(self.0.map(|x| x << by))
    }
}

impl Shr<u32> for Array<u32> {
    type Output = Self;
    #[inline(never)]
    fn shr(self, by: u32) -> Self {
        Self(self.0.map(|x| x >> by))
    }
}

impl Not for Array<bool> {
    type Output = Self;
    #[inline(never)]
    fn not(self) -> Self {
        Self(self.0.map(|x| !x))
    }
}

#[inline(never)]
fn compare<T: Copy>(a: Array<T>, b: Array<T>, how: impl Fn(&T, &T) -> bool) -> Array<bool> {
    Array(from_fn(|i| how(&a.0[i], &b.0[i])))
}

#[inline(never)]
fn choose<T: Copy>(mask: Array<bool>, yes: Array<T>, no: Array<T>) -> Array<T> {
    Array(from_fn(|i| if mask.0[i] { yes.0[i] } else { no.0[i] }))
}

#[inline(never)]
fn first<T: Copy>(from: &[T]) -> Array<T> {
    let from = &from[..WIDTH];
    Array(from_fn(|i| from[i]))
}

impl Simd for Scalar {
    const WIDTH: usize = WIDTH;
    type F = Array<f32>;
    type D = Array<f64>;
    type U = Array<u32>;
    type Frame = Shear;
    type M = Array<bool>;

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

    #[inline(never)]
    fn f32s(self, x: f32) -> Self::F {
        Array([x; WIDTH])
    }
    #[inline(never)]
    fn u32s(self, x: u32) -> Self::U {
        Array([x; WIDTH])
    }
    #[inline(never)]
    fn f64s(self, x: f64) -> Self::D {
        Array([x; WIDTH])
    }
    #[inline(never)]
    fn mask(self, bits: u32) -> Self::M {
        Array(from_fn(|i| bits >> i & 1 == 1))
    }

    #[inline(never)]
    fn load(self, from: &[f32]) -> Self::F {
        first(from)
    }
    #[inline(never)]
    fn load_u32(self, from: &[u32]) -> Self::U {
        first(from)
    }
    #[inline(never)]
    fn store(self, x: Self::F, to: &mut [f32]) {
        to[..WIDTH].copy_from_slice(&x.0);
    }
    #[inline(never)]
    fn store_u32(self, x: Self::U, to: &mut [u32]) {
        to[..WIDTH].copy_from_slice(&x.0);
    }

    #[inline(never)]
    fn columns(self, records: &[[f32; 8]]) -> [Self::F; 8] {
        let records = &records[..WIDTH];
        from_fn(|k| Array(from_fn(|i| records[i][k])))
    }

    #[inline(never)]
    fn larger(self, a: Self::F, b: Self::F) -> Self::F {
        choose(self.lt(b, a), a, b)
    }
    #[inline(never)]
    fn smaller(self, a: Self::F, b: Self::F) -> Self::F {
        choose(self.lt(a, b), a, b)
    }
    #[inline(never)]
    fn abs(self, x: Self::F) -> Self::F {
        Array(x.0.map(f32::abs))
    }

    #[inline(never)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::M {
        compare(a, b, f32::lt)
    }
    #[inline(never)]
    fn le(self, a: Self::F, b: Self::F) -> Self::M {
        compare(a, b, f32::le)
    }
    #[inline(never)]
    fn eq(self, a: Self::F, b: Self::F) -> Self::M {
        compare(a, b, f32::eq)
    }
    #[inline(never)]
    fn lt_f64(self, a: Self::D, b: Self::D) -> Self::M {
        compare(a, b, f64::lt)
    }
    #[inline(never)]
    fn eq_f64(self, a: Self::D, b: Self::D) -> Self::M {
        compare(a, b, f64::eq)
    }
    #[inline(never)]
    fn eq_u32(self, a: Self::U, b: Self::U) -> Self::M {
        compare(a, b, u32::eq)
    }
    #[inline(never)]
    fn lt_u32(self, a: Self::U, b: Self::U) -> Self::M {
        compare(a, b, u32::lt)
    }

    #[inline(never)]
    fn select(self, mask: Self::M, yes: Self::F, no: Self::F) -> Self::F {
        choose(mask, yes, no)
    }
    #[inline(never)]
    fn select_u32(self, mask: Self::M, yes: Self::U, no: Self::U) -> Self::U {
        choose(mask, yes, no)
    }
    #[inline(never)]
    fn cast_u32(self, x: Self::F) -> Self::U {
        Array(x.0.map(f32::to_bits))
    }
    #[inline(never)]
    fn cast_f32(self, x: Self::U) -> Self::F {
        Array(x.0.map(f32::from_bits))
    }
    #[inline(never)]
    fn widen(self, x: Self::F) -> Self::D {
        Array(x.0.map(f64::from))
    }
    #[inline(never)]
    fn narrow(self, x: Self::D) -> Self::F {
        Array(x.0.map(|x| x as f32))
    }

    #[inline(never)]
    fn bits(self, mask: Self::M) -> u32 {
        (0..WIDTH).fold(0, |bits, i| bits | u32::from(mask.0[i]) << i)
    }

    #[inline(never)]
    fn permute(self, x: Self::F, from: Self::U) -> Self::F {
        Array(from.0.map(|i| x.0[i as usize % WIDTH]))
    }
    #[inline(never)]
    fn permute_u32(self, x: Self::U, from: Self::U) -> Self::U {
        Array(from.0.map(|i| x.0[i as usize % WIDTH]))
    }

    #[inline(never)]
    fn compress(self, mask: Self::M, x: Self::U, to: &mut [u32]) -> usize {
        let to = &mut to[..WIDTH];
        let mut count = 0;
        for i in 0..WIDTH {
            to[count] = x.0[i];
            count += usize::from(mask.0[i]);
        }
        count
    }

    #[inline(never)]
    unsafe fn gather<const SCALE: i32>(self, base: *const u8, index: Self::U) -> Self::F {
        // SAFETY: the caller's promise.
        self.cast_f32(unsafe { self.gather_u32::<SCALE>(base, index) })
    }
    #[inline(never)]
    unsafe fn gather_u32<const SCALE: i32>(self, base: *const u8, index: Self::U) -> Self::U {
        Array(index.0.map(|i| {
            // SAFETY: the caller says that these bytes are readable.
            unsafe { base.add(i as usize * SCALE as usize).cast::<u32>().read_unaligned() }
        }))
    }
    #[inline(never)]
    unsafe fn gather_pairs<const SCALE: i32>(self, base: *const u8, index: Self::U) -> (Self::U, Self::U) {
        let words = index.0.map(|i| {
            // SAFETY: the caller says that these bytes are readable.
            u64::from_le(unsafe { base.add(i as usize * SCALE as usize).cast::<u64>().read_unaligned() })
        });
        (Array(words.map(|x| x as u32)), Array(words.map(|x| (x >> 32) as u32)))
    }
}
