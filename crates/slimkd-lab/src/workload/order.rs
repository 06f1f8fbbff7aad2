//! The order in which the pixels of pictures are visited.

/// Side of the square tiles in which primary rays are ordered, pixels. Renderers work in tiles, and packets will want
/// their rays side by side.
pub const TILE: usize = 8;
/// Side of the square blocks of tiles that [`Order::Scattered`] visits one after the other, pixels.
pub const BLOCK: usize = 32;
/// Pixels of a block.
pub const BLOCK_PIXELS: usize = BLOCK * BLOCK;

/// The order of the pixels. Neighbours stay together in tiles of [`TILE`] in both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The views one after the other, each row of tiles by row of tiles.
    Rows,
    /// Blocks of tiles scattered evenly, taking turns between the views, so that any beginning is a fair sample of the
    /// whole. The picture's size must be a power of two, and at least [`BLOCK`].
    Scattered {
        /// Pixels of a block that are visited before the next block; the rest comes in later rounds over all blocks. It
        /// divides [`BLOCK_PIXELS`], which visits each block at once.
        run: usize,
    },
}

impl Order {
    /// Calls `pixel(view, x, y)` for every pixel of every view once.
    pub(super) fn visit(self, size: usize, views: usize, mut pixel: impl FnMut(usize, usize, usize)) {
        match self {
            Self::Rows => (0..views).for_each(|view| tiles(view, size, &mut pixel)),
            Self::Scattered { run } => {
                assert!(size.is_power_of_two() && size >= BLOCK, "a scattered picture of {size} pixels");
                assert!(BLOCK_PIXELS.is_multiple_of(run), "runs of {run} pixels");
                let across = size / BLOCK;
                for round in 0..BLOCK_PIXELS / run {
                    for index in 0..across * across * views {
                        let [left, top] = scattered(index / views, across).map(|place| place * BLOCK);
                        for [x, y] in (round * run..(round + 1) * run).map(within_block) {
                            pixel(index % views, left + x, top + y);
                        }
                    }
                }
            }
        }
    }

    /// The view of pixel number `index`.
    pub(super) fn view_of(self, index: usize, size: usize, views: usize) -> usize {
        match self {
            Self::Rows => index / (size * size),
            Self::Scattered { run } => index / run % views,
        }
    }
}

/// The tiles of a picture, cut where it ends.
fn tiles(view: usize, size: usize, pixel: &mut impl FnMut(usize, usize, usize)) {
    for tile_y in (0..size).step_by(TILE) {
        for tile_x in (0..size).step_by(TILE) {
            for y in tile_y..(tile_y + TILE).min(size) {
                (tile_x..(tile_x + TILE).min(size)).for_each(|x| pixel(view, x, y));
            }
        }
    }
}

/// Column and row of pixel `number` of a block, which go tile by tile.
fn within_block(number: usize) -> [usize; 2] {
    let (tile, pixel) = (number / (TILE * TILE), number % (TILE * TILE));
    let [tile_x, tile_y] = [tile % (BLOCK / TILE), tile / (BLOCK / TILE)];
    [TILE * tile_x + pixel % TILE, TILE * tile_y + pixel / TILE]
}

/// Column and row of block number `index` of `across` by `across`, a power of two. Reversed bits scatter evenly, and their
/// de-interleaving does so in both directions.
fn scattered(index: usize, across: usize) -> [usize; 2] {
    let bits = 2 * across.trailing_zeros();
    let place = if bits == 0 { 0 } else { (index as u32).reverse_bits() >> (u32::BITS - bits) };
    let even = |bits: u32| (0..16).fold(0, |out, k| out | (bits >> (2 * k) & 1) << k) as usize;
    [even(place), even(place >> 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(order: Order, size: usize, views: usize) -> Vec<[usize; 3]> {
        let mut all = Vec::new();
        order.visit(size, views, |view, x, y| all.push([view, x, y]));
        assert!(all.iter().enumerate().all(|(index, pixel)| order.view_of(index, size, views) == pixel[0]));
        all
    }

    /// Block by block.
    const BLOCKS: Order = Order::Scattered { run: BLOCK_PIXELS };

    #[test]
    fn every_pixel_once() {
        let few = Order::Scattered { run: 4 };
        for (order, size) in [(Order::Rows, 21), (BLOCKS, 32), (BLOCKS, 256), (few, 64)] {
            let mut all = pixels(order, size, 3);
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), 3 * size * size);
        }
    }

    #[test]
    fn a_block_goes_tile_by_tile() {
        let mut by_tiles = Vec::new();
        tiles(0, BLOCK, &mut |_, x, y| by_tiles.push([x, y]));
        assert_eq!((0..BLOCK_PIXELS).map(within_block).collect::<Vec<_>>(), by_tiles);
    }

    #[test]
    fn a_beginning_is_a_fair_sample() {
        for run in [1, 16, BLOCK_PIXELS] {
            let beginning = &pixels(Order::Scattered { run }, 1024, 3)[..3 * 64 * run];
            for view in 0..3 {
                for (right, low) in [(false, false), (false, true), (true, false), (true, true)] {
                    let quarter =
                        |&&[of, x, y]: &&[usize; 3]| of == view && (x >= 512) == right && (y >= 512) == low;
                    assert_eq!(beginning.iter().filter(quarter).count(), 16 * run);
                }
            }
        }
    }
}
