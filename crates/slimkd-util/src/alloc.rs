//! An allocator that counts: the most that a build holds at a time, and what structures that do not say their size keep.
//!
//! Counts what was asked for, without the allocator's own overhead; a reallocation counts as its difference, as the system's
//! allocator moves large blocks without copying them.

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
    // Most allocations set no new peak: a load is cheaper than a write to a shared line.
    if live > PEAK.load(Relaxed) {
        PEAK.fetch_max(live, Relaxed);
    }
}

fn counting() -> bool {
    COUNTING.load(Relaxed)
}

// SAFETY: every call is passed on to `System` unchanged and its answer returned unchanged; counting touches atomics alone,
// allocates nothing and cannot unwind.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that `System` asks for.
        let block = unsafe { System.alloc(layout) };
        if counting() && !block.is_null() {
            add(layout.size() as i64);
        }
        block
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are those that `System` asks for.
        unsafe { System.dealloc(block, layout) };
        if counting() {
            add(-(layout.size() as i64));
        }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that `System` asks for.
        let block = unsafe { System.alloc_zeroed(layout) };
        if counting() && !block.is_null() {
            add(layout.size() as i64);
        }
        block
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's promises are those that `System` asks for.
        let moved = unsafe { System.realloc(block, layout, size) };
        if counting() && !moved.is_null() {
            add(size as i64 - layout.size() as i64);
        }
        moved
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

#[cfg(all(test, target_pointer_width = "64"))]
mod tests {
    use super::*;

    #[global_allocator]
    static ALLOCATOR: Counting = Counting;

    #[test]
    fn a_freed_block_counts_towards_the_peak_alone() {
        // Never touched, so it costs nothing; far above what other tests of this process hold meanwhile.
        const BLOCK: u64 = 4 << 30;
        let near = |bytes: u64| (BLOCK - (1 << 30)..BLOCK + (1 << 30)).contains(&bytes);
        let (_, freed) = count(|| drop(std::hint::black_box(Vec::<u8>::with_capacity(BLOCK as usize))));
        assert!(near(freed.peak) && freed.live < 1 << 30, "{freed:?}");
        let (_block, kept) = count(|| std::hint::black_box(Vec::<u8>::with_capacity(BLOCK as usize)));
        assert!(near(kept.peak) && near(kept.live), "{kept:?}");
    }
}
