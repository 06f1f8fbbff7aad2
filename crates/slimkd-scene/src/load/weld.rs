//! Welds vertices of equal position, for formats without indices.

use std::hash::{BuildHasher, RandomState};

/// Vertices, each position once (by its bits; −0 is 0), in order of first use.
pub(super) struct Weld {
    pub(super) vertices: Vec<[f32; 3]>,
    /// Open addressing: a vertex' index, or `FREE`. At most half full, and a power of two long.
    table: Vec<u32>,
    /// Drawn anew each time, so that no file can be made whose vertices all fall into one place. The result does not depend
    /// on it.
    keys: [u64; 4],
}

const FREE: u32 = u32::MAX;

impl Weld {
    /// With room for about so many vertices.
    pub(super) fn with_capacity(vertices: usize) -> Self {
        let random = RandomState::new();
        Self {
            vertices: Vec::with_capacity(vertices),
            table: vec![FREE; (2 * vertices).next_power_of_two().max(64)],
            keys: std::array::from_fn(|k| random.hash_one(k)),
        }
    }

    /// The vertex at `position`.
    pub(super) fn index(&mut self, position: [f32; 3]) -> u32 {
        let position = position.map(|x| if x == 0.0 { 0.0 } else { x });
        if 2 * self.vertices.len() >= self.table.len() {
            self.table = vec![FREE; 2 * self.table.len()];
            for (index, vertex) in self.vertices.iter().enumerate() {
                let slot = find(&self.table, &self.vertices, &self.keys, *vertex);
                self.table[slot] = index as u32;
            }
        }
        let slot = find(&self.table, &self.vertices, &self.keys, position);
        if self.table[slot] == FREE {
            self.table[slot] = self.vertices.len() as u32;
            self.vertices.push(position);
        }
        self.table[slot]
    }
}

/// The slot that holds the position, or the free one where it belongs.
fn find(table: &[u32], vertices: &[[f32; 3]], keys: &[u64; 4], position: [f32; 3]) -> usize {
    let bits = position.map(f32::to_bits);
    // Multilinear hashing (Lemire & Kaser 2014): universal for random keys; the high bits are the good ones.
    let hash = bits
        .iter()
        .zip(keys)
        .fold(keys[3], |hash, (&bits, &key)| hash.wrapping_add(key.wrapping_mul(u64::from(bits))));
    let mut slot = (hash >> (64 - table.len().trailing_zeros())) as usize;
    loop {
        match table[slot] {
            FREE => return slot,
            vertex if vertices[vertex as usize].map(f32::to_bits) == bits => return slot,
            _ => slot = (slot + 1) & (table.len() - 1),
        }
    }
}
