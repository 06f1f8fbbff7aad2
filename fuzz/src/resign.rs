//! Makes the checksums, places and hashes of a `.skd` file right, as far as it is one.

use xxhash_rust::xxh3::xxh3_64;

fn number(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?))
}

fn put(bytes: &mut [u8], at: usize, number: u64) {
    if let Some(place) = bytes.get_mut(at..at + 8) {
        place.copy_from_slice(&number.to_le_bytes());
    }
}

/// Leaves alone what it cannot make sense of.
pub(crate) fn resign(bytes: &mut [u8]) {
    let Some(count) = number(bytes, 8).map(|word| (word >> 32) as usize).filter(|&count| count <= 64) else {
        return;
    };
    let end = 64 + 32 * count;
    if bytes.len() < end {
        return;
    }
    let mut mesh = [Vec::new(), Vec::new()];
    let mut shape = None;
    for at in (64..end).step_by(32) {
        let [kind, offset, length] = [0, 8, 16].map(|field| number(bytes, at + field).unwrap_or(0));
        let range = offset as usize..(offset as usize).saturating_add(length as usize);
        let Some(section) = bytes.get(range) else { continue };
        match kind {
            2 => shape = Some((at, offset as usize, length as usize)),
            3 | 4 => mesh[kind as usize - 3] = section.to_vec(),
            _ => {}
        }
        let sum = xxh3_64(section);
        put(bytes, at + 24, sum);
    }
    if let Some((at, offset, length @ 64..)) = shape {
        let vertices = (mesh[0].len() / 12) as u64;
        let hash = xxh3_64(&[&vertices.to_le_bytes()[..], &mesh[0], &mesh[1]].concat());
        put(bytes, offset + 24, hash);
        let sum = xxh3_64(&bytes[offset..offset + length]);
        put(bytes, at + 24, sum);
    }
    let length = bytes.len() as u64;
    put(bytes, 16, length);
    let sum = xxh3_64(&[&bytes[..24], &bytes[64..end]].concat());
    put(bytes, 24, sum);
}
