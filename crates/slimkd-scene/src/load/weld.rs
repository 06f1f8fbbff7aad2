//! Welds vertices of equal position, for formats without indices.

use std::hash::{BuildHasher, RandomState};

/// Vertices, each position once (by its bits; −0 is 0), in order of first use.
///
/// Most corners are in the triangles right before, too. So a small table of those that were met last is asked first: it stays in the first
/// cache, while each look into the whole table waits for memory twice.
pub(super) struct Weld {
    pub(super) vertices: Vec<[f32; 3]>,
    /// Open addressing: a vertex' index, or `FREE`. At most half full, and a power of two long.
    table: Vec<u32>,
    /// The vertex that was met last of those whose hashes begin alike: its position's bits and its index, or `FREE`.
    recent: Vec<([u32; 3], u32)>,
    /// Drawn anew each time, so that no file can be made whose vertices all fall into one place. The result does not depend
    /// on it.
    keys: [u64; 4],
}

const FREE: u32 = u32::MAX;
/// Entries of `recent`: 16 bytes each.
const RECENT_BITS: u32 = 10;

impl Weld {
    /// With room for about so many vertices.
    pub(super) fn with_capacity(vertices: usize) -> Self {
        let random = RandomState::new();
        Self {
            vertices: Vec::with_capacity(vertices),
            table: vec![FREE; (2 * vertices).next_power_of_two().max(64)],
            recent: vec![([0; 3], FREE); 1 << RECENT_BITS],
            keys: std::array::from_fn(|k| random.hash_one(k)),
        }
    }

    /// The vertex at `position`.
    pub(super) fn index(&mut self, position: [f32; 3]) -> u32 {
        let position = position.map(|x| if x == 0.0 { 0.0 } else { x });
        let bits = position.map(f32::to_bits);
        let hash = self.hash(bits);
        let entry = (hash >> (64 - RECENT_BITS)) as usize;
        let (known, index) = self.recent[entry];
        if known == bits && index != FREE {
            return index;
        }
        let index = self.find_or_add(position, hash);
        self.recent[entry] = (bits, index);
        index
    }

    fn find_or_add(&mut self, position: [f32; 3], hash: u64) -> u32 {
        if 2 * self.vertices.len() >= self.table.len() {
            self.table = vec![FREE; 2 * self.table.len()];
            for (index, vertex) in self.vertices.iter().enumerate() {
                let slot = self.slot(self.hash(vertex.map(f32::to_bits)), *vertex);
                self.table[slot] = index as u32;
            }
        }
        let slot = self.slot(hash, position);
        if self.table[slot] == FREE {
            self.table[slot] = self.vertices.len() as u32;
            self.vertices.push(position);
        }
        self.table[slot]
    }

    /// Multilinear hashing (Lemire & Kaser 2014): universal for random keys; the high bits are the good ones.
    fn hash(&self, bits: [u32; 3]) -> u64 {
        let terms = bits.iter().zip(&self.keys);
        terms.fold(self.keys[3], |hash, (&bits, &key)| hash.wrapping_add(key.wrapping_mul(u64::from(bits))))
    }

    /// The slot of `table` that holds the position, or the free one where it belongs.
    fn slot(&self, hash: u64, position: [f32; 3]) -> usize {
        let bits = position.map(f32::to_bits);
        let mut slot = (hash >> (64 - self.table.len().trailing_zeros())) as usize;
        loop {
            match self.table[slot] {
                FREE => return slot,
                vertex if self.vertices[vertex as usize].map(f32::to_bits) == bits => return slot,
                _ => slot = (slot + 1) & (self.table.len() - 1),
            }
        }
    }
}
