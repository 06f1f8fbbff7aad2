//! A build keeps to its bound on memory, and no memory is an error: never an abort, never a different tree.

mod common;

use common::sphere;
use slimkd::{
    BuildError, BuildOptions, KdTree, Layout as TreeLayout, Preset, Splits, TreeBudget, TriangleMesh,
};
use std::alloc::{GlobalAlloc, Layout, System};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Counts, and refuses large blocks above a limit; small ones always succeed, as from a reserve.
struct Limited;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);
static LIMIT: AtomicUsize = AtomicUsize::new(usize::MAX);
const LARGE: usize = 256 << 10;

// SAFETY: `System` does the work; the counters touch no memory but their own.
unsafe impl GlobalAlloc for Limited {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let size = layout.size();
        let live = LIVE.fetch_add(size, Relaxed) + size;
        if size >= LARGE && live > LIMIT.load(Relaxed) {
            LIVE.fetch_sub(size, Relaxed);
            return std::ptr::null_mut();
        }
        PEAK.fetch_max(live, Relaxed);
        // SAFETY: the caller's contract is `System`'s.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Relaxed);
        // SAFETY: `block` came from `System` with this layout.
        unsafe { System.dealloc(block, layout) };
    }

    /// Shrinking never fails, as with the system's allocator.
    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let live = LIVE.fetch_add(size, Relaxed) + size - layout.size();
        if size >= LARGE && size > layout.size() && live > LIMIT.load(Relaxed) {
            LIVE.fetch_sub(size, Relaxed);
            return std::ptr::null_mut();
        }
        LIVE.fetch_sub(layout.size(), Relaxed);
        PEAK.fetch_max(live, Relaxed);
        // SAFETY: as in `dealloc`; the caller upholds the contract on `size`.
        unsafe { System.realloc(block, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Limited = Limited;

/// Buffers of the threads, subtrees that they are at, and the ids, which no account holds before, bytes.
const BUFFERS: usize = 6 << 20;

fn build(mesh: &Arc<TriangleMesh>, options: &BuildOptions) -> (Result<Vec<u8>, BuildError>, usize) {
    let before = LIVE.load(Relaxed);
    PEAK.store(before, Relaxed);
    let built = KdTree::build(Arc::clone(mesh), options);
    let peak = PEAK.load(Relaxed) - before;
    let bytes = built.map(|tree| {
        let mut bytes = Vec::new();
        tree.write(&mut bytes).unwrap();
        bytes
    });
    (bytes, peak)
}

/// One test: live bytes are counted over the whole process.
#[test]
fn bounds_are_kept_and_no_memory_is_an_error() {
    let mesh = Arc::new(sphere(7));
    let wide = BuildOptions::from(Preset::Slim).with_layout(TreeLayout::Wide).with_max_tree(None);
    let all = [
        Preset::Standard.into(),
        Preset::PaperSmall.into(),
        Preset::Slim.into(),
        wide.clone().with_max_tree(TreeBudget::BytesPerTriangle(4.0)),
        wide.clone().with_splits(Splits::Space),
        wide,
    ];
    for mut options in all {
        options.threads = NonZeroUsize::new(2); // each has buffers
        let (expected, most) = build(&mesh, &options);
        let expected = expected.unwrap();
        for percent in [1, 50, 90, 300] {
            let limit = most / 100 * percent;
            options.max_build_bytes = Some(limit as u64);
            let (built, peak) = build(&mesh, &options);
            let context = format!("{options:?}, {peak} of {limit}, {percent} % of {most}");
            assert!(peak <= limit + BUFFERS, "{context}");
            match built {
                Ok(tree) => assert!(tree == expected, "{context}"),
                Err(BuildError::BuildTooLarge { needed, limit }) => {
                    assert!(percent < 300 && needed > limit, "{context}");
                }
                Err(error) => panic!("{context}: {error}"),
            }
        }
        options.max_build_bytes = None;
        for percent in [10, 50, 90] {
            LIMIT.store(LIVE.load(Relaxed) + most / 100 * percent, Relaxed);
            let (built, peak) = build(&mesh, &options);
            LIMIT.store(usize::MAX, Relaxed);
            match built {
                Ok(tree) => assert!(tree == expected),
                Err(error) => assert!(
                    percent < 100 && matches!(error, BuildError::OutOfMemory { .. }),
                    "{options:?} at {percent} %, {peak} of {most}: {error}"
                ),
            }
        }
        assert!(build(&mesh, &options).0.unwrap() == expected);
    }
}
