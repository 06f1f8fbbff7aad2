//! Few keys in order, without branches that nothing could foresee.

/// [`super::Simd::least_and_others`] of the first `count` keys.
///
/// # Safety
/// There must be room for 16 pairs.
#[inline(always)]
pub(super) unsafe fn least_and_others(
    keys: &mut [u32; 16],
    count: usize,
    tag: u32,
    others: *mut [u32; 2],
) -> u32 {
    let least = if count > 4 {
        by_insertion(&mut keys[..count]);
        keys[count - 1]
    } else {
        up_to_four(keys, count)
    };
    // Three at least are written: a branch for each would be foreseen too rarely.
    // Loops over numbers, since iterators' functions fall out of the inline chain.
    let written = if count > 4 { count - 1 } else { 3 };
    for k in 0..3 {
        // SAFETY: the caller's promise.
        unsafe { others.add(k).write([keys[k], tag]) };
    }
    for k in 3..written {
        // SAFETY: the caller's promise.
        unsafe { others.add(k).write([keys[k], tag]) };
    }
    least
}

/// Brings keys into descending order.
#[inline(always)]
fn by_insertion(keys: &mut [u32]) {
    for i in 1..keys.len() {
        let key = keys[i];
        let mut j = i;
        while j > 0 && keys[j - 1] < key {
            keys[j] = keys[j - 1];
            j -= 1;
        }
        keys[j] = key;
    }
}

/// Brings the first `count` keys into descending order, two to four of them, and returns the least.
#[inline(always)]
fn up_to_four(keys: &mut [u32; 16], count: usize) -> u32 {
    let [a, b, c, d] = [keys[0], keys[1], keys[2], keys[3]];
    // Found by itself, as walks wait for it alone.
    let least = a.min(b).min(if count > 2 { c } else { a }.min(if count > 3 { d } else { a }));
    let (c, d) = (if count > 2 { c } else { 0 }, if count > 3 { d } else { 0 });
    let (a, b) = (a.max(b), a.min(b));
    let (c, d) = (c.max(d), c.min(d));
    let (a, c) = (a.max(c), a.min(c));
    let (b, d) = (b.max(d), b.min(d));
    let (b, c) = (b.max(c), b.min(c));
    (keys[0], keys[1], keys[2], keys[3]) = (a, b, c, d);
    least
}
