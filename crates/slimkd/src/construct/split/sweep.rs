//! The best plane among given ones on one axis, by one pass over their sorted events.
//!
//! Source: Wald & Havran 2006, algorithm 5. Only planes strictly inside the voxel count; the triangles in a plane go to
//! whichever side is cheaper. Equal costs fall to the lower axis, then the lower position, then "planars left", so the
//! tree does not depend on who computes it.
//!
//! Deviation: an event is one `u64`, `position:32 | kind:2`, with the position as an order-preserving integer.

use super::sah::VoxelSah;

/// Kinds of events, in the order in which they are met at one position.
const END: u64 = 0;
const PLANAR: u64 = 1;
const START: u64 = 2;

/// A chosen split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Split {
    pub(crate) cost: f64,
    pub(crate) axis: usize,
    pub(crate) position: f32,
    /// Whether triangles that lie in the plane go left.
    pub(crate) planar_left: bool,
}

/// The cheaper of two; `a` where they cost the same.
pub(crate) fn cheaper(a: Option<Split>, b: Option<Split>) -> Option<Split> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.cost < a.cost { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Where the sweep meets a triangle's bounds; compares in sweep order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Event(u64);

impl Event {
    /// The event at a lower bound, with the upper one beside it.
    #[inline(always)]
    pub(crate) fn low(low: f32, high: f32) -> Self {
        Self(u64::from(ordered(low)) << 2 | if low == high { PLANAR } else { START })
    }

    /// The event at an upper bound of a triangle that is not flat.
    #[inline(always)]
    pub(crate) fn high(high: f32) -> Self {
        Self(u64::from(ordered(high)) << 2 | END)
    }

    #[inline(always)]
    fn key(self) -> u32 {
        (self.0 >> 2) as u32
    }

    #[inline(always)]
    pub(crate) fn position(self) -> f32 {
        from_ordered(self.key())
    }
}

/// Order-preserving integer of a finite f32; −0 and +0 are one position.
#[inline(always)]
fn ordered(x: f32) -> u32 {
    let bits = (x + 0.0).to_bits();
    bits ^ ((bits as i32 >> 31) as u32 | 0x8000_0000)
}

#[inline(always)]
fn from_ordered(key: u32) -> f32 {
    f32::from_bits(key ^ (((!key) as i32 >> 31) as u32 | 0x8000_0000))
}

/// The cheapest plane at a position of `events`, which are sorted and strictly inside the voxel. `left` triangles
/// begin before the first of them, `right` end at or behind it.
pub(crate) fn best_of(
    events: &[Event],
    axis: usize,
    sah: &VoxelSah,
    mut left: i32,
    mut right: i32,
) -> Option<Split> {
    let mut best: Option<Split> = None;
    let mut i = 0;
    while i < events.len() {
        let key = events[i].key();
        let mut kinds = [0i32; 4];
        while i < events.len() && events[i].key() == key {
            kinds[(events[i].0 & 3) as usize] += 1;
            i += 1;
        }
        let [ends, planars, starts, _] = kinds;
        right -= planars + ends;
        let position = from_ordered(key);
        let candidate = |left, right, planar_left| {
            let cost = sah.split(axis, position.into(), left, right);
            Some(Split { cost, axis, position, planar_left })
        };
        best = cheaper(best, candidate(left + planars, right, true));
        if planars > 0 {
            best = cheaper(best, candidate(left, right + planars, false));
        }
        left += starts + planars;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_keep_the_order_of_floats() {
        let floats = [f32::MIN, -1.0, -1e-40, -0.0, 1e-40, 0.5, 1.0, f32::MAX];
        assert!(floats.windows(2).all(|pair| ordered(pair[0]) < ordered(pair[1])));
        assert!(floats.iter().all(|&x| from_ordered(ordered(x)) == x));
        assert_eq!(ordered(-0.0), ordered(0.0));
    }

    #[test]
    fn at_one_position_ends_come_before_planars_before_starts() {
        assert!(Event::high(1.0) < Event::low(1.0, 1.0));
        assert!(Event::low(1.0, 1.0) < Event::low(1.0, 2.0));
        assert!(Event::low(1.0, 2.0) < Event::high(1.5));
        assert_eq!(Event::high(-0.0).position().to_bits(), 0);
    }
}
