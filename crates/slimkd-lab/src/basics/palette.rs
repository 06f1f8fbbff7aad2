//! Colours that colour-blind people tell apart.

/// Classes of [`duplication_colour`]: the least number of references, what it is called, its colour.
pub const DUPLICATION: [(u32, &str, [u8; 3]); 6] = [
    (0, "1 to 10 references", [0xc9, 0xcd, 0xd2]),
    (11, "11 to 20", [0xfd, 0xe7, 0x8c]),
    (21, "21 to 50", [0xfd, 0xae, 0x45]),
    (51, "51 to 100", [0xe8, 0x6a, 0x33]),
    (101, "101 to 1,000", [0xb8, 0x25, 0x5f]),
    (1001, "more", [0x5b, 0x0f, 0x7a]),
];

/// A triangle's colour by its references, shaded.
pub fn duplication_colour(references: u32, shade: f32) -> [u8; 3] {
    let class = DUPLICATION.iter().rev().find(|class| references >= class.0).unwrap_or(&DUPLICATION[0]);
    class.2.map(|channel| (f32::from(channel) * shade) as u8)
}

/// Inferno (van der Walt & Smith 2015) at eleven places: dark to bright, also in print and for the colour-blind.
const INFERNO: [[u8; 3]; 11] = [
    [0x00, 0x00, 0x04],
    [0x16, 0x0b, 0x39],
    [0x42, 0x0a, 0x68],
    [0x6a, 0x17, 0x6e],
    [0x93, 0x26, 0x67],
    [0xbc, 0x37, 0x54],
    [0xdd, 0x51, 0x3a],
    [0xf3, 0x78, 0x19],
    [0xfc, 0xa5, 0x0a],
    [0xf6, 0xd7, 0x46],
    [0xfc, 0xff, 0xa4],
];

/// The colour of a share of the scale, 0 to 1; beyond, the end's.
pub fn heat_colour(share: f64) -> [u8; 3] {
    let at = share.clamp(0.0, 1.0) * (INFERNO.len() - 1) as f64;
    let index = (at as usize).min(INFERNO.len() - 2);
    let part = at - index as f64;
    std::array::from_fn(|k| {
        let (low, high) = (f64::from(INFERNO[index][k]), f64::from(INFERNO[index + 1][k]));
        (low + (high - low) * part).round() as u8
    })
}

/// `#rrggbb`.
pub fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_begin_and_end() {
        assert_eq!((heat_colour(-1.0), heat_colour(2.0)), (INFERNO[0], INFERNO[10]));
        assert_eq!(heat_colour(0.5), INFERNO[5]);
        assert_eq!(duplication_colour(10, 1.0), DUPLICATION[0].2);
        assert_eq!(duplication_colour(5000, 1.0), DUPLICATION[5].2);
    }
}
