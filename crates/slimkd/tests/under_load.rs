//! Thousands of builds, cancelled builds, builds beside traces, one pool for all: nothing grows, nothing changes.

mod common;

use cap::Cap;
use common::{hard_rays, soup, sphere};
use slimkd::{BuildError, BuildOptions, KdTree, Preset, Progress, Tracer, TriangleMesh};
use std::alloc::System;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// Live bytes are counted over the whole process: one test at a time.
static ALONE: Mutex<()> = Mutex::new(());

/// What thread pools may still hold back or hand over while nothing is being built, bytes.
const IDLE: usize = 64 << 10;

fn build(mesh: &Arc<TriangleMesh>, preset: Preset) -> KdTree {
    KdTree::build(Arc::clone(mesh), &preset.into()).unwrap()
}

fn bytes(tree: &KdTree) -> Vec<u8> {
    let mut bytes = Vec::new();
    tree.write(&mut bytes).unwrap();
    bytes
}

#[test]
fn ten_thousand_builds_leave_nothing_behind() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mesh = Arc::new(soup(12, 1.0, 0.0, 1));
    let ray = hard_rays(&mesh, 1, 1)[0];
    let round = || {
        for i in 0..1000 {
            let tree = build(&mesh, Preset::ALL[i % Preset::ALL.len()]);
            std::hint::black_box(tree.closest(&ray));
        }
    };
    round();
    let before = ALLOCATOR.allocated();
    (0..10).for_each(|_| round());
    let after = ALLOCATOR.allocated();
    assert!(after <= before + IDLE, "{before} bytes before, {after} after");
}

#[test]
fn pools_of_their_own_end_with_their_build() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mesh = Arc::new(soup(500, 1.0, 0.0, 1));
    let mut options = BuildOptions::from(Preset::Slim);
    options.threads = NonZeroUsize::new(3);
    let expected = bytes(&build(&mesh, Preset::Slim));
    let round = || {
        for _ in 0..30 {
            assert!(bytes(&KdTree::build(Arc::clone(&mesh), &options).unwrap()) == expected);
        }
    };
    round();
    let before = ALLOCATOR.allocated();
    (0..4).for_each(|_| round());
    let after = ALLOCATOR.allocated();
    assert!(after <= before + IDLE, "{before} bytes before, {after} after");
}

#[test]
fn one_pool_serves_builds_and_traces_at_once() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let mesh = Arc::new(soup(1500, 1.0, 0.0, 1));
    let rays = hard_rays(&mesh, 300, 2);
    let tree = build(&mesh, Preset::Standard);
    let hits: Vec<_> = rays.iter().map(|ray| tree.closest(ray)).collect();
    let expected = bytes(&tree);
    let building = AtomicBool::new(true);
    std::thread::scope(|scope| {
        let tracer = scope.spawn(|| {
            let mut rounds = 0;
            while building.load(Relaxed) || rounds == 0 {
                let again: Vec<_> = pool.install(|| rays.iter().map(|ray| tree.closest(ray)).collect());
                assert_eq!(again, hits);
                rounds += 1;
            }
        });
        let builders: Vec<_> = (0..2)
            .map(|_| {
                scope.spawn(|| {
                    for _ in 0..10 {
                        let again = pool.install(|| build(&mesh, Preset::Standard));
                        assert!(bytes(&again) == expected);
                    }
                })
            })
            .collect();
        builders.into_iter().for_each(|builder| builder.join().unwrap());
        building.store(false, Relaxed);
        tracer.join().unwrap();
    });
}

#[test]
fn cancelled_builds_leave_nothing_and_spoil_nothing() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mesh = Arc::new(sphere(4));
    let expected = bytes(&build(&mesh, Preset::PaperFast));
    let round = || {
        for step in 0..12 {
            let progress = Progress::new();
            let options = BuildOptions::from(Preset::PaperFast);
            let done = AtomicBool::new(false);
            let result = std::thread::scope(|scope| {
                let (progress, done) = (&progress, &done);
                scope.spawn(move || {
                    while !done.load(Relaxed) && progress.fraction() < f64::from(step) / 12.0 {
                        std::thread::yield_now();
                    }
                    progress.cancel();
                });
                let result = KdTree::build_with_progress(Arc::clone(&mesh), &options, progress);
                done.store(true, Relaxed);
                result
            });
            match result {
                Ok(tree) => assert!(bytes(&tree) == expected),
                Err(error) => assert!(matches!(error, BuildError::Cancelled)),
            }
        }
    };
    round();
    let before = ALLOCATOR.allocated();
    (0..3).for_each(|_| round());
    let after = ALLOCATOR.allocated();
    assert!(after <= before + IDLE, "{before} bytes before, {after} after");
    let progress = Progress::new();
    progress.cancel();
    let cancelled = KdTree::build_with_progress(Arc::clone(&mesh), &BuildOptions::default(), &progress);
    assert!(matches!(cancelled, Err(BuildError::Cancelled)));
    assert!(bytes(&build(&mesh, Preset::PaperFast)) == expected);
}

/// Reading takes no more than 4 times what is read, and 256 MiB.
#[test]
fn reading_takes_memory_in_proportion() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mesh = Arc::new(soup(60_000, 1.0, 0.0, 1));
    for preset in [Preset::Standard, Preset::Slim] {
        let file = bytes(&build(&mesh, preset));
        let before = ALLOCATOR.allocated();
        // What a lying or huge file would need more of is refused by the allocator, and must be an error.
        ALLOCATOR.set_limit(before + 3 * file.len()).unwrap();
        let read = KdTree::read(&mut &file[..]);
        ALLOCATOR.set_limit(usize::MAX).unwrap();
        assert_eq!(read.unwrap().memory(), build(&mesh, preset).memory());
        ALLOCATOR.set_limit(before + file.len() / 2).unwrap();
        let read = KdTree::read(&mut &file[..]);
        ALLOCATOR.set_limit(usize::MAX).unwrap();
        assert!(
            matches!(&read, Err(slimkd::FileError::Io(error)) if error.kind() == std::io::ErrorKind::OutOfMemory)
        );
    }
}
