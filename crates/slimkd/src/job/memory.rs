//! Memory that grows with the scene: reserved before it is used, and an error where there is none left or where
//! [`BuildOptions::max_build_bytes`] allows no more.
//!
//! The account holds what is large: fragments, plans, what reductions keep beside them, the encoded tree. Buffers of one thread
//! and the allocator's own overhead are not in it.
//!
//! [`BuildOptions::max_build_bytes`]: crate::BuildOptions::max_build_bytes

use crate::options::BuildError;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// What a build holds, and the most that it may.
#[derive(Debug)]
pub(crate) struct Memory {
    live: AtomicU64,
    limit: u64,
}

impl Memory {
    /// `None` is no limit.
    pub(crate) fn new(limit: Option<u64>) -> Self {
        Self { live: AtomicU64::new(0), limit: limit.unwrap_or(u64::MAX) }
    }

    /// To be called before so many bytes are allocated.
    pub(crate) fn take(&self, bytes: usize) -> Result<(), BuildError> {
        let needed = self.live.fetch_add(bytes as u64, Relaxed) + bytes as u64;
        if needed <= self.limit {
            Ok(())
        } else {
            Err(BuildError::BuildTooLarge { needed, limit: self.limit })
        }
    }

    /// To be called once they are free.
    pub(crate) fn give(&self, bytes: usize) {
        self.live.fetch_sub(bytes as u64, Relaxed);
    }
}

/// Room for `more` elements, and for as many again as there are: amortised.
#[inline]
pub(crate) fn room<T>(vec: &mut Vec<T>, more: usize) -> Result<(), BuildError> {
    if vec.capacity() - vec.len() >= more {
        return Ok(());
    }
    vec.try_reserve(more).map_err(|_| none_left::<T>(vec.len() + more))
}

#[inline]
pub(crate) fn push<T>(vec: &mut Vec<T>, value: T) -> Result<(), BuildError> {
    room(vec, 1)?;
    vec.push(value);
    Ok(())
}

/// An empty vector with room for `count` elements and no more.
pub(crate) fn with_room<T>(count: usize) -> Result<Vec<T>, BuildError> {
    let mut vec = Vec::new();
    vec.try_reserve_exact(count).map_err(|_| none_left::<T>(count))?;
    Ok(vec)
}

/// `count` times the same.
pub(crate) fn filled<T: Clone>(value: T, count: usize) -> Result<Vec<T>, BuildError> {
    let mut vec = with_room(count)?;
    vec.resize(count, value);
    Ok(vec)
}

/// At least `count` elements, new ones of the default.
pub(crate) fn stretch<T: Clone + Default>(vec: &mut Vec<T>, count: usize) -> Result<(), BuildError> {
    if vec.len() < count {
        room(vec, count - vec.len())?;
        vec.resize(count, T::default());
    }
    Ok(())
}

pub(crate) fn copied<T: Copy>(slice: &[T]) -> Result<Vec<T>, BuildError> {
    let mut vec = with_room(slice.len())?;
    vec.extend_from_slice(slice);
    Ok(vec)
}

fn none_left<T>(count: usize) -> BuildError {
    BuildError::OutOfMemory { bytes: (count * size_of::<T>()) as u64 }
}
