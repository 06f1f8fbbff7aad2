//! A global allocator that counts live bytes, so that a build can report the most memory that it held at a time.
//!
//! Counts what was asked for, without the allocator's own overhead; a reallocation counts as its new size alone, as
//! the system's allocator moves large blocks without copying them.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Bytes allocated and not yet freed. Relaxed counters suffice: nothing else is published through them.
static LIVE: AtomicUsize = AtomicUsize::new(0);
/// The most that [`LIVE`] has been since [`Watermark::start`].
static PEAK: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator, counted.
struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn grow(bytes: usize) {
    let live = LIVE.fetch_add(bytes, Relaxed) + bytes;
    // Most allocations set no new peak: a load is cheaper than a write to a shared line.
    if live > PEAK.load(Relaxed) {
        PEAK.fetch_max(live, Relaxed);
    }
}

fn shrink(bytes: usize) {
    LIVE.fetch_sub(bytes, Relaxed);
}

// SAFETY: every call goes to `System` unchanged and its answer is returned unchanged; the counters touch no memory
// but their own and cannot unwind.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller upholds `GlobalAlloc::alloc`'s contract, which is `System`'s.
        let block = unsafe { System.alloc(layout) };
        if !block.is_null() {
            grow(layout.size());
        }
        block
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as in `alloc`.
        let block = unsafe { System.alloc_zeroed(layout) };
        if !block.is_null() {
            grow(layout.size());
        }
        block
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller got `block` from this allocator with `layout`, that is, from `System`.
        unsafe { System.dealloc(block, layout) };
        shrink(layout.size());
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as in `dealloc`; the caller upholds the contract on `size`.
        let moved = unsafe { System.realloc(block, layout, size) };
        if !moved.is_null() {
            if size >= layout.size() {
                grow(size - layout.size());
            } else {
                shrink(layout.size() - size);
            }
        }
        moved
    }
}

/// What was live at some moment.
pub(crate) struct Watermark(usize);

impl Watermark {
    /// From here on. One at a time: a second one restarts the count of the first.
    pub(crate) fn start() -> Self {
        let live = LIVE.load(Relaxed);
        PEAK.store(live, Relaxed);
        Self(live)
    }

    /// The most bytes that were live since, above what was live then.
    pub(crate) fn peak(&self) -> u64 {
        PEAK.load(Relaxed).saturating_sub(self.0) as u64
    }
}

#[cfg(all(test, target_pointer_width = "64"))]
mod tests {
    use super::*;

    #[test]
    fn a_freed_block_counts_towards_the_peak() {
        // Never touched, so it costs nothing; far above what other tests of this process hold meanwhile.
        const BLOCK: u64 = 4 << 30;
        let mark = Watermark::start();
        drop(std::hint::black_box(Vec::<u8>::with_capacity(BLOCK as usize)));
        let peak = mark.peak();
        assert!((BLOCK - (1 << 30)..BLOCK + (1 << 30)).contains(&peak), "{peak}");
    }
}
