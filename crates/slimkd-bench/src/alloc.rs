//! An allocator that counts, for peers that do not say how large they are.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering::Relaxed};

static COUNTING: AtomicBool = AtomicBool::new(false);
static LIVE: AtomicI64 = AtomicI64::new(0);
static PEAK: AtomicI64 = AtomicI64::new(0);

/// The system's allocator; counts bytes while [`count`] runs and costs one relaxed load a call otherwise. The binary
/// installs it.
#[derive(Debug)]
pub struct Counting;

fn add(bytes: i64) {
    let live = LIVE.fetch_add(bytes, Relaxed) + bytes;
    PEAK.fetch_max(live, Relaxed);
}

// SAFETY: every call is passed on to `System` unchanged; counting touches atomics alone and allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if COUNTING.load(Relaxed) {
            add(layout.size() as i64);
        }
        // SAFETY: the caller's promises are those that `System` asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        if COUNTING.load(Relaxed) {
            add(-(layout.size() as i64));
        }
        // SAFETY: the caller's promises are those that `System` asks for.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        if COUNTING.load(Relaxed) {
            add(layout.size() as i64);
        }
        // SAFETY: the caller's promises are those that `System` asks for.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        if COUNTING.load(Relaxed) {
            add(size as i64 - layout.size() as i64);
        }
        // SAFETY: the caller's promises are those that `System` asks for.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

/// What a counted piece of work left allocated and had allocated at most, bytes, all threads together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Still allocated when it ended.
    pub live: u64,
    /// Most at one time; a reallocation counts as its difference.
    pub peak: u64,
}

/// Runs `work` and counts its allocations; zero where [`Counting`] is not the global allocator. One at a time.
pub fn count<T>(work: impl FnOnce() -> T) -> (T, Counted) {
    LIVE.store(0, Relaxed);
    PEAK.store(0, Relaxed);
    COUNTING.store(true, Relaxed);
    let result = work();
    COUNTING.store(false, Relaxed);
    let bytes = |counter: &AtomicI64| counter.load(Relaxed).max(0) as u64;
    (result, Counted { live: bytes(&LIVE), peak: bytes(&PEAK) })
}
