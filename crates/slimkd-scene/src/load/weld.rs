//! Welds vertices of equal position, for formats without indices.

/// Vertices, each position once (by its bits; −0 is 0), in order of first use.
pub(super) struct Weld {
    pub(super) vertices: Vec<[f32; 3]>,
    /// Open addressing: a vertex' index, or `FREE`. At most half full, and a power of two long.
    table: Vec<u32>,
}

const FREE: u32 = u32::MAX;

impl Weld {
    pub(super) fn new() -> Self {
        Self { vertices: Vec::new(), table: vec![FREE; 64] }
    }

    /// The vertex at `position`.
    pub(super) fn index(&mut self, position: [f32; 3]) -> u32 {
        let position = position.map(|x| if x == 0.0 { 0.0 } else { x });
        if 2 * self.vertices.len() >= self.table.len() {
            self.table = vec![FREE; 2 * self.table.len()];
            for (index, vertex) in self.vertices.iter().enumerate() {
                let slot = find(&self.table, &self.vertices, *vertex);
                self.table[slot] = index as u32;
            }
        }
        let slot = find(&self.table, &self.vertices, position);
        if self.table[slot] == FREE {
            self.table[slot] = self.vertices.len() as u32;
            self.vertices.push(position);
        }
        self.table[slot]
    }
}

/// The slot that holds the position, or the free one where it belongs.
fn find(table: &[u32], vertices: &[[f32; 3]], position: [f32; 3]) -> usize {
    let bits = position.map(f32::to_bits);
    // Multiplicative hashing (Knuth): the high bits of the product are the good ones.
    let hash = bits.iter().fold(0u64, |hash, &bits| {
        (hash.rotate_left(23) ^ u64::from(bits)).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    });
    let mut slot = (hash >> (64 - table.len().trailing_zeros())) as usize;
    loop {
        match table[slot] {
            FREE => return slot,
            vertex if vertices[vertex as usize].map(f32::to_bits) == bits => return slot,
            _ => slot = (slot + 1) & (table.len() - 1),
        }
    }
}
