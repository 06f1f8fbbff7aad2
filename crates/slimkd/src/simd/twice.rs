//! Two vectors as one of twice the width.

use super::{Intersection, Quad, Shear, Simd};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Not, Shl, Shr, Sub};

/// Twice as many lanes: the lower half first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Twice<S>(pub(crate) S);

/// Lower and upper half.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<V>(V, V);

macro_rules! both {
    ($($trait:ident::$method:ident)*) => {
        $(impl<V: $trait<Output = V>> $trait for Pair<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        })*
    };
}

both! { Add::add Sub::sub Mul::mul Div::div BitAnd::bitand BitOr::bitor BitXor::bitxor }

impl<V: Shl<u32, Output = V>> Shl<u32> for Pair<V> {
    type Output = Self;
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        Self(self.0 << by, self.1 << by)
    }
}

impl<V: Shr<u32, Output = V>> Shr<u32> for Pair<V> {
    type Output = Self;
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        Self(self.0 >> by, self.1 >> by)
    }
}

impl<V: Not<Output = V>> Not for Pair<V> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}

/// Operations that do the same to both halves.
macro_rules! halves {
    ($($name:ident($($argument:ident: $type:ident),*) -> $result:ident;)*) => {
        $(#[inline(always)]
        fn $name(self, $($argument: Self::$type),*) -> Self::$result {
            Pair(self.0.$name($($argument.0),*), self.0.$name($($argument.1),*))
        })*
    };
}

impl<S: Simd> Simd for Twice<S> {
    const WIDTH: usize = 2 * S::WIDTH;
    type F = Pair<S::F>;
    type D = Pair<S::D>;
    type U = Pair<S::U>;
    type Frame = S::Frame;
    type M = Pair<S::M>;

    #[inline(always)]
    fn f32s(self, x: f32) -> Self::F {
        Pair(self.0.f32s(x), self.0.f32s(x))
    }
    #[inline(always)]
    fn u32s(self, x: u32) -> Self::U {
        Pair(self.0.u32s(x), self.0.u32s(x))
    }
    #[inline(always)]
    fn f64s(self, x: f64) -> Self::D {
        Pair(self.0.f64s(x), self.0.f64s(x))
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> Self::M {
        Pair(self.0.mask(bits), self.0.mask(bits >> S::WIDTH))
    }

    #[inline(always)]
    fn load(self, from: &[f32]) -> Self::F {
        let from = &from[..Self::WIDTH];
        Pair(self.0.load(from), self.0.load(&from[S::WIDTH..]))
    }
    #[inline(always)]
    fn load_u32(self, from: &[u32]) -> Self::U {
        let from = &from[..Self::WIDTH];
        Pair(self.0.load_u32(from), self.0.load_u32(&from[S::WIDTH..]))
    }
    #[inline(always)]
    fn load_u16(self, from: &[u16]) -> Self::F {
        let from = &from[..Self::WIDTH];
        Pair(self.0.load_u16(from), self.0.load_u16(&from[S::WIDTH..]))
    }
    #[inline(always)]
    fn bound_mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        Pair(self.0.bound_mul_add(a.0, b.0, c.0), self.0.bound_mul_add(a.1, b.1, c.1))
    }
    #[inline(always)]
    fn frame(self, shear: &Shear) -> Self::Frame {
        self.0.frame(shear)
    }
    #[inline(always)]
    unsafe fn quad(
        self,
        frame: &Self::Frame,
        corners: &[[*const [f32; 3]; 3]; 4],
        limit: f32,
        quad: &mut Quad,
    ) -> u32 {
        // SAFETY: the caller's promise.
        unsafe { self.0.quad(frame, corners, limit, quad) }
    }
    #[inline(always)]
    unsafe fn may_hit(self, shear: &Shear, corners: &[[*const [f32; 3]; 3]; 4]) -> u32 {
        // SAFETY: the caller's promise.
        unsafe { self.0.may_hit(shear, corners) }
    }
    #[inline(always)]
    unsafe fn decide(self, shear: &Shear, corners: [*const [f32; 3]; 3]) -> Option<Intersection> {
        // SAFETY: the caller's promise.
        unsafe { self.0.decide(shear, corners) }
    }
    #[inline(always)]
    fn store(self, x: Self::F, to: &mut [f32]) {
        let (lower, upper) = to[..Self::WIDTH].split_at_mut(S::WIDTH);
        self.0.store(x.0, lower);
        self.0.store(x.1, upper);
    }
    #[inline(always)]
    fn store_u32(self, x: Self::U, to: &mut [u32]) {
        let (lower, upper) = to[..Self::WIDTH].split_at_mut(S::WIDTH);
        self.0.store_u32(x.0, lower);
        self.0.store_u32(x.1, upper);
    }

    #[inline(always)]
    fn columns(self, records: &[[f32; 8]]) -> [Self::F; 8] {
        let records = &records[..Self::WIDTH];
        let [a, b, c, d, e, f, g, h] = self.0.columns(records);
        let upper = self.0.columns(&records[S::WIDTH..]);
        let [p, q, r, s, t, u, v, w] = upper;
        [Pair(a, p), Pair(b, q), Pair(c, r), Pair(d, s), Pair(e, t), Pair(f, u), Pair(g, v), Pair(h, w)]
    }

    halves! {
        larger(a: F, b: F) -> F;
        smaller(a: F, b: F) -> F;
        abs(x: F) -> F;
        lt(a: F, b: F) -> M;
        le(a: F, b: F) -> M;
        eq(a: F, b: F) -> M;
        lt_f64(a: D, b: D) -> M;
        eq_f64(a: D, b: D) -> M;
        eq_u32(a: U, b: U) -> M;
        lt_u32(a: U, b: U) -> M;
        select(mask: M, yes: F, no: F) -> F;
        select_u32(mask: M, yes: U, no: U) -> U;
        cast_u32(x: F) -> U;
        cast_f32(x: U) -> F;
        widen(x: F) -> D;
        narrow(x: D) -> F;
    }

    #[inline(always)]
    fn least(self, x: Self::F) -> f32 {
        self.0.least(self.0.smaller(x.0, x.1))
    }
    #[inline(always)]
    fn most(self, x: Self::F) -> f32 {
        self.0.most(self.0.larger(x.0, x.1))
    }
    #[inline(always)]
    fn bits(self, mask: Self::M) -> u32 {
        self.0.bits(mask.0) | self.0.bits(mask.1) << S::WIDTH
    }
    #[inline(always)]
    fn any(self, mask: Self::M) -> bool {
        self.0.any(mask.0 | mask.1)
    }
    #[inline(always)]
    fn all(self, mask: Self::M) -> bool {
        self.0.all(mask.0 & mask.1)
    }

    #[inline(always)]
    fn permute(self, x: Self::F, from: Self::U) -> Self::F {
        Pair(permute_half(self.0, x, from.0), permute_half(self.0, x, from.1))
    }
    #[inline(always)]
    fn permute_u32(self, x: Self::U, from: Self::U) -> Self::U {
        self.cast_u32(self.permute(self.cast_f32(x), from))
    }

    #[inline(always)]
    fn compress(self, mask: Self::M, x: Self::U, to: &mut [u32]) -> usize {
        let to = &mut to[..Self::WIDTH];
        let count = self.0.compress(mask.0, x.0, to);
        count + self.0.compress(mask.1, x.1, &mut to[count..])
    }

    #[inline(always)]
    unsafe fn gather<const SCALE: i32>(self, base: *const u8, index: Self::U) -> Self::F {
        // SAFETY: the caller's promise covers both halves.
        unsafe { Pair(self.0.gather::<SCALE>(base, index.0), self.0.gather::<SCALE>(base, index.1)) }
    }
    #[inline(always)]
    unsafe fn gather_u32<const SCALE: i32>(self, base: *const u8, index: Self::U) -> Self::U {
        // SAFETY: the caller's promise covers both halves.
        unsafe { Pair(self.0.gather_u32::<SCALE>(base, index.0), self.0.gather_u32::<SCALE>(base, index.1)) }
    }
    #[inline(always)]
    unsafe fn gather_pairs<const SCALE: i32>(self, base: *const u8, index: Self::U) -> (Self::U, Self::U) {
        // SAFETY: the caller's promise covers both halves.
        let (a, b) = unsafe {
            (self.0.gather_pairs::<SCALE>(base, index.0), self.0.gather_pairs::<SCALE>(base, index.1))
        };
        (Pair(a.0, b.0), Pair(a.1, b.1))
    }
    #[inline(always)]
    unsafe fn gather_rows<const SCALE: i32>(self, base: *const u8, index: Self::U) -> [Self::U; 4] {
        // SAFETY: the caller's promise covers both halves.
        let ([a, b, c, d], [e, f, g, h]) = unsafe {
            (self.0.gather_rows::<SCALE>(base, index.0), self.0.gather_rows::<SCALE>(base, index.1))
        };
        [Pair(a, e), Pair(b, f), Pair(c, g), Pair(d, h)]
    }
    #[inline(always)]
    unsafe fn load_pairs<const SCALE: i32>(self, base: *const u8, at: &[u32]) -> (Self::U, Self::U) {
        let (lower, upper) = at.split_at(S::WIDTH);
        // SAFETY: the caller's promise covers both halves.
        let (a, b) =
            unsafe { (self.0.load_pairs::<SCALE>(base, lower), self.0.load_pairs::<SCALE>(base, upper)) };
        (Pair(a.0, b.0), Pair(a.1, b.1))
    }
    #[inline(always)]
    unsafe fn load_rows(self, base: *const u8, at: &[u32]) -> [Self::U; 4] {
        let (lower, upper) = at.split_at(S::WIDTH);
        // SAFETY: the caller's promise covers both halves.
        let ([a, b, c, d], [e, f, g, h]) =
            unsafe { (self.0.load_rows(base, lower), self.0.load_rows(base, upper)) };
        [Pair(a, e), Pair(b, f), Pair(c, g), Pair(d, h)]
    }
    #[inline(always)]
    unsafe fn store_rows(self, base: *mut u8, at: &[u32], [a, b, c, d]: [Self::U; 4]) {
        let (lower, upper) = at.split_at(S::WIDTH);
        // SAFETY: the caller's promise covers both halves.
        unsafe {
            self.0.store_rows(base, lower, [a.0, b.0, c.0, d.0]);
            self.0.store_rows(base, upper, [a.1, b.1, c.1, d.1]);
        }
    }
    #[inline(always)]
    fn pick(self, table: &[f32; 32], index: Self::U) -> Self::F {
        Pair(self.0.pick(table, index.0), self.0.pick(table, index.1))
    }
}

/// Half of a permutation. A function, since a closure fell out of the inline chain where it stands twice.
#[inline(always)]
fn permute_half<S: Simd>(s: S, x: Pair<S::F>, from: S::U) -> S::F {
    let within = from & s.u32s(S::WIDTH as u32 - 1);
    let lower = s.lt_u32(from, s.u32s(S::WIDTH as u32));
    s.select(lower, s.permute(x.0, within), s.permute(x.1, within))
}
