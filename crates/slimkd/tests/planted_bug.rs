//! A wrong read that `scripts/memcheck` must find before its silence about everything else counts.

#[test]
#[ignore = "wrong on purpose; scripts/memcheck runs it"]
fn reads_behind_a_block() {
    let block = vec![1u32; 16].into_boxed_slice();
    let behind = std::hint::black_box(block.as_ptr()).wrapping_add(16);
    // SAFETY: there is none; that is the bug.
    let stray = unsafe { behind.read_volatile() };
    assert_ne!(stray, 0x5eed_5eed);
}
