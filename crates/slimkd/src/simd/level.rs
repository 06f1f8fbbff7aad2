//! Which instruction set a batch is traced with, and the entry functions that carry it.

use super::Simd;
#[cfg(target_arch = "x86_64")]
use super::{Avx2, Avx512, Sse2, Twice};
#[cfg(target_arch = "aarch64")]
use super::{Neon, Twice};
use std::sync::OnceLock;

/// What a batch is traced with. All give the same hits, to the last bit.
///
/// The best that the processor has is found once a process; [`Batch::instruction_set`](crate::Batch::instruction_set) chooses another.
/// What the processor lacks falls to the best that it has below.
///
/// ```
/// use slimkd::InstructionSet;
/// assert!(InstructionSet::Scalar.is_available());
/// assert!(InstructionSet::best().is_available());
/// assert_eq!("avx2".parse(), Ok(InstructionSet::Avx2));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum InstructionSet {
    /// Plain Rust, for every processor: batches go ray by ray, since lanes in memory would be slower.
    Scalar,
    /// 4 lanes; every x86-64 has it.
    Sse2,
    /// 4 lanes; every 64-bit ARM has it.
    Neon,
    /// 8 lanes, with BMI.
    Avx2,
    /// 16 lanes: F, BW, DQ and VL.
    Avx512,
}

impl InstructionSet {
    /// All of them, ascending.
    pub const ALL: &[Self] = &[Self::Scalar, Self::Sse2, Self::Neon, Self::Avx2, Self::Avx512];

    /// The name on command lines.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Sse2 => "sse2",
            Self::Neon => "neon",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether this processor and this build have it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(target_arch = "aarch64")]
            Self::Neon => true,
            #[cfg(target_arch = "x86_64")]
            Self::Sse2 => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => has_avx2(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => has_avx512(),
            #[allow(unreachable_patterns)]
            _ => false,
        }
    }

    /// Itself if available, else the best available one below.
    pub fn or_below(self) -> Self {
        let usable = |set: &&Self| **set <= self && set.is_available();
        Self::ALL.iter().rev().find(usable).copied().unwrap_or(Self::Scalar)
    }

    /// The best that the processor has.
    pub fn best() -> Self {
        static BEST: OnceLock<InstructionSet> = OnceLock::new();
        *BEST.get_or_init(|| Self::Avx512.or_below())
    }

    /// Runs a kernel with 16 lanes of it; `None` where there are no lanes.
    #[inline]
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> Option<K::Output> {
        self.or_below().run_available(kernel)
    }

    /// Runs a kernel with 16 lanes of the best: for one ray, which does not wait for a look at what the processor has.
    #[inline]
    pub(crate) fn run_best<K: Kernel>(kernel: K) -> Option<K::Output> {
        Self::best().run_available(kernel)
    }

    /// Runs a kernel with 16 lanes of it. Only for what [`InstructionSet::or_below`] returned.
    #[inline(always)]
    #[cfg_attr(not(any(target_arch = "x86_64", target_arch = "aarch64")), allow(unreachable_code, unused))]
    fn run_available<K: Kernel>(self, kernel: K) -> Option<K::Output> {
        let output = match self {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `or_below` returns only what `is_available` found.
            Self::Avx512 => unsafe { run_avx512(kernel) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `or_below` returns only what `is_available` found.
            Self::Avx2 => unsafe { run_avx2(kernel) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: SSE2 is part of x86-64.
            Self::Sse2 => kernel.run(Twice(Twice(unsafe { Sse2::new() }))),
            #[cfg(target_arch = "aarch64")]
            // SAFETY: NEON is part of 64-bit ARM.
            Self::Neon => kernel.run(Twice(Twice(unsafe { Neon::new() }))),
            _ => return None,
        };
        Some(output)
    }
}

/// An unknown name of an instruction set: use one of [`InstructionSet::ALL`]'s.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is no instruction set; use avx512, avx2, sse2, neon or scalar")]
pub struct UnknownInstructionSet(String);

impl std::fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for InstructionSet {
    type Err = UnknownInstructionSet;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let known = Self::ALL.iter().find(|set| set.name().eq_ignore_ascii_case(name.trim()));
        known.copied().ok_or_else(|| UnknownInstructionSet(name.to_owned()))
    }
}

/// Work that is compiled once an instruction set.
pub(crate) trait Kernel {
    /// What comes out.
    type Output;
    /// Must be `#[inline(always)]`, like all that it hands vectors to.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    use std::arch::is_x86_feature_detected as has;
    has!("avx2") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt")
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    use std::arch::is_x86_feature_detected as has;
    has_avx2() && has!("avx512f") && has!("avx512bw") && has!("avx512dq") && has!("avx512vl")
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    // SAFETY: whoever may call this function has these features.
    kernel.run(Twice(unsafe { Avx2::new() }))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    // SAFETY: whoever may call this function has these features.
    kernel.run(unsafe { Avx512::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back_and_what_is_missing_falls() {
        for &set in InstructionSet::ALL {
            assert_eq!(set.name().parse(), Ok(set));
            assert!(set.or_below().is_available() && set.or_below() <= set);
        }
        assert!("mmx".parse::<InstructionSet>().unwrap_err().to_string().contains("use avx512"));
        assert_eq!(InstructionSet::Scalar.or_below(), InstructionSet::Scalar);
    }
}
