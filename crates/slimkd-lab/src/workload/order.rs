//! The order in which the pixels of pictures are visited.

/// Side of the square tiles in which primary rays are ordered, pixels. Renderers work in tiles, and packets will want
/// their rays side by side.
pub const TILE: usize = 8;
/// Side of the square blocks of tiles that [`Order::Scattered`] visits one after the other, pixels.
pub const BLOCK: usize = 32;

/// The order of the pixels. Neighbours stay together in tiles of [`TILE`] in both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The views one after the other, each row of tiles by row of tiles.
    Rows,
    /// Blocks of tiles scattered evenly, taking turns between the views, so that any beginning is a fair sample of the
    /// whole. The picture's size must be a power of two, and at least [`BLOCK`].
    Scattered,
}

impl Order {
    /// Calls `pixel(view, x, y)` for every pixel of every view once.
    pub(super) fn visit(self, size: usize, views: usize, mut pixel: impl FnMut(usize, usize, usize)) {
        match self {
            Self::Rows => (0..views).for_each(|view| tiles(view, [0, 0], size, size, &mut pixel)),
            Self::Scattered => {
                assert!(size.is_power_of_two() && size >= BLOCK, "a scattered picture of {size} pixels");
                let across = size / BLOCK;
                for index in 0..across * across * views {
                    let corner = scattered(index / views, across).map(|place| place * BLOCK);
                    tiles(index % views, corner, BLOCK, size, &mut pixel);
                }
            }
        }
    }

    /// The view of pixel number `index`.
    pub(super) fn view_of(self, index: usize, size: usize, views: usize) -> usize {
        match self {
            Self::Rows => index / (size * size),
            Self::Scattered => index / (BLOCK * BLOCK) % views,
        }
    }
}

/// The tiles of a square of `edge` pixels from `corner`, cut where the picture ends.
fn tiles(
    view: usize,
    corner: [usize; 2],
    edge: usize,
    size: usize,
    pixel: &mut impl FnMut(usize, usize, usize),
) {
    let [end_x, end_y] = corner.map(|start| (start + edge).min(size));
    for tile_y in (corner[1]..end_y).step_by(TILE) {
        for tile_x in (corner[0]..end_x).step_by(TILE) {
            for y in tile_y..(tile_y + TILE).min(end_y) {
                (tile_x..(tile_x + TILE).min(end_x)).for_each(|x| pixel(view, x, y));
            }
        }
    }
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

    #[test]
    fn every_pixel_once() {
        for (order, size) in [(Order::Rows, 21), (Order::Scattered, 32), (Order::Scattered, 256)] {
            let mut all = pixels(order, size, 3);
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), 3 * size * size);
        }
    }

    #[test]
    fn a_beginning_is_a_fair_sample() {
        let beginning = &pixels(Order::Scattered, 1024, 3)[..3 * 64 * BLOCK * BLOCK];
        for view in 0..3 {
            for (right, low) in [(false, false), (false, true), (true, false), (true, true)] {
                let quarter =
                    |&&[of, x, y]: &&[usize; 3]| of == view && (x >= 512) == right && (y >= 512) == low;
                assert_eq!(beginning.iter().filter(quarter).count(), 16 * BLOCK * BLOCK);
            }
        }
    }
}
