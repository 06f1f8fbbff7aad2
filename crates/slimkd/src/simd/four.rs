//! Four f32 with the instructions that every processor of the target has: for the numbers of one ray, an axis a lane.

use std::ops::{Add, Div, Mul, Sub};

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// Four f32.
#[derive(Clone, Copy)]
#[cfg(target_arch = "x86_64")]
pub(crate) struct Four(__m128);

/// Four f32.
#[derive(Clone, Copy)]
#[cfg(not(target_arch = "x86_64"))]
pub(crate) struct Four([f32; 4]);

/// An operation on all lanes: by an instruction on x86-64, whose baseline has SSE2, and lane by lane elsewhere.
macro_rules! operation {
    ($(#[$doc:meta])* $name:ident($a:ident, $b:ident) = $instruction:ident, $lane:expr) => {
        $(#[$doc])*
        #[inline(always)]
        pub(crate) fn $name(self, other: Self) -> Self {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: SSE2 is part of x86-64.
            return unsafe { Self($instruction(self.0, other.0)) };
            #[cfg(not(target_arch = "x86_64"))]
            return Self(std::array::from_fn(|k| {
                let ($a, $b) = (self.0[k], other.0[k]);
                $lane
            }));
        }
    };
}

macro_rules! operators {
    ($($trait:ident::$name:ident = $instruction:ident;)*) => {
        $(impl $trait for Four {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: SSE2 is part of x86-64.
                return unsafe { Self($instruction(self.0, other.0)) };
                #[cfg(not(target_arch = "x86_64"))]
                return Self(std::array::from_fn(|k| $trait::$name(self.0[k], other.0[k])));
            }
        })*
    };
}

operators! {
    Add::add = _mm_add_ps;
    Sub::sub = _mm_sub_ps;
    Mul::mul = _mm_mul_ps;
    Div::div = _mm_div_ps;
}

/// All bits set, or none.
#[cfg(not(target_arch = "x86_64"))]
fn mask(yes: bool) -> f32 {
    f32::from_bits(if yes { u32::MAX } else { 0 })
}

impl Four {
    #[inline(always)]
    pub(crate) fn new(lanes: [f32; 4]) -> Self {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: SSE2 is part of x86-64; four f32 are read.
        return unsafe { Self(_mm_loadu_ps(lanes.as_ptr())) };
        #[cfg(not(target_arch = "x86_64"))]
        return Self(lanes);
    }

    /// Three numbers, and 1 in the last lane.
    #[inline(always)]
    pub(crate) fn three([x, y, z]: [f32; 3]) -> Self {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: SSE2 is part of x86-64.
        return unsafe { Self(_mm_setr_ps(x, y, z, 1.0)) };
        #[cfg(not(target_arch = "x86_64"))]
        return Self([x, y, z, 1.0]);
    }

    #[inline(always)]
    pub(crate) fn all(x: f32) -> Self {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: SSE2 is part of x86-64.
        return unsafe { Self(_mm_set1_ps(x)) };
        #[cfg(not(target_arch = "x86_64"))]
        return Self([x; 4]);
    }

    #[inline(always)]
    pub(crate) fn lanes(self) -> [f32; 4] {
        #[cfg(target_arch = "x86_64")]
        {
            let mut lanes = [0.0; 4];
            // SAFETY: SSE2 is part of x86-64; four f32 are written.
            unsafe { _mm_storeu_ps(lanes.as_mut_ptr(), self.0) };
            lanes
        }
        #[cfg(not(target_arch = "x86_64"))]
        self.0
    }

    operation! {
        /// As `prepared::larger`: a NaN in `self` is passed over.
        larger(a, b) = _mm_max_ps, if a > b { a } else { b }
    }
    operation! {
        /// A mask: all bits where `self` is less; none with a NaN.
        below(a, b) = _mm_cmplt_ps, mask(a < b)
    }
    operation! {
        /// A mask: all bits where `self` is less or the same; none with a NaN.
        up_to(a, b) = _mm_cmple_ps, mask(a <= b)
    }
    operation! {
        /// A mask: all bits where the two differ, or one is NaN.
        differs(a, b) = _mm_cmpneq_ps, mask(a != b)
    }
    operation! {
        /// The bits that both have.
        and(a, b) = _mm_and_ps, f32::from_bits(a.to_bits() & b.to_bits())
    }
    operation! {
        /// The bits that either has.
        or(a, b) = _mm_or_ps, f32::from_bits(a.to_bits() | b.to_bits())
    }
    operation! {
        /// The bits of `other` that `self` lacks.
        without(a, b) = _mm_andnot_ps, f32::from_bits(!a.to_bits() & b.to_bits())
    }

    /// Lanes of `yes` where this mask is set, else of `no`.
    #[inline(always)]
    pub(crate) fn choose(self, yes: Self, no: Self) -> Self {
        self.and(yes).or(self.without(no))
    }

    /// Without the sign.
    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self::all(-0.0).without(self)
    }

    /// Of this mask, a bit for each of the first three lanes.
    #[inline(always)]
    pub(crate) fn bits(self) -> u32 {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: SSE2 is part of x86-64.
        return unsafe { _mm_movemask_ps(self.0) as u32 & 7 };
        #[cfg(not(target_arch = "x86_64"))]
        return (0..3).map(|k| (self.0[k].to_bits() >> 31) << k).sum();
    }
}
