//! Events: where the sweep meets a triangle's bounds.
//!
//! Source: Wald & Havran 2006 §4.3. Order: position, then end < planar < start.
//!
//! Deviation: an event is one `u64`, `position:32 | kind:2 | triangle:30`, with the position as an order-preserving
//! integer. Sorting, merging and classifying compare integers, and ties fall to the lower id on every machine.

use crate::geometry::Aabb;

/// Triangles that an event can name.
pub(crate) const TRIANGLE_LIMIT: u64 = 1 << 30;

const ID_MASK: u64 = TRIANGLE_LIMIT - 1;
const END: u64 = 0;
const PLANAR: u64 = 1;
const START: u64 = 2;

/// What happens at an event's position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    End,
    Planar,
    Start,
}

/// One event; compares in sweep order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(transparent)]
pub(crate) struct Event(u64);

impl Event {
    #[inline(always)]
    fn new(position: f32, kind: u64, triangle: u32) -> Self {
        Self(u64::from(ordered(position)) << 32 | kind << 30 | u64::from(triangle))
    }

    /// The position as an integer of the same order.
    #[inline(always)]
    pub(crate) fn key(self) -> u32 {
        (self.0 >> 32) as u32
    }

    #[inline(always)]
    pub(crate) fn position(self) -> f32 {
        from_ordered(self.key())
    }

    #[inline(always)]
    pub(crate) fn kind(self) -> Kind {
        match self.0 >> 30 & 3 {
            END => Kind::End,
            PLANAR => Kind::Planar,
            _ => Kind::Start,
        }
    }

    /// True for the one event of a triangle on an axis that is not an end.
    #[inline(always)]
    pub(crate) fn opens(self) -> bool {
        self.0 >> 30 & 3 != END
    }

    #[inline(always)]
    pub(crate) fn triangle(self) -> u32 {
        (self.0 & ID_MASK) as u32
    }
}

/// Order-preserving integer of a finite f32; −0 and +0 are one position.
#[inline(always)]
pub(crate) fn ordered(x: f32) -> u32 {
    let bits = (x + 0.0).to_bits();
    bits ^ ((bits as i32 >> 31) as u32 | 0x8000_0000)
}

#[inline(always)]
fn from_ordered(key: u32) -> f32 {
    f32::from_bits(key ^ (((!key) as i32 >> 31) as u32 | 0x8000_0000))
}

/// Appends the one or two events of `bounds` on `axis`.
#[inline(always)]
pub(crate) fn push_events(list: &mut Vec<Event>, bounds: &Aabb, axis: usize, triangle: u32) {
    let (low, high) = (bounds.min[axis], bounds.max[axis]);
    if low == high {
        list.push(Event::new(low, PLANAR, triangle));
    } else {
        list.push(Event::new(low, START, triangle));
        list.push(Event::new(high, END, triangle));
    }
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
        let mut list = Vec::new();
        push_events(&mut list, &Aabb { min: [1.0; 3], max: [2.0; 3] }, 0, 3);
        push_events(&mut list, &Aabb { min: [1.0; 3], max: [1.0; 3] }, 0, 2);
        push_events(&mut list, &Aabb { min: [0.0; 3], max: [1.0; 3] }, 0, 1);
        list.sort_unstable();
        let order: Vec<_> = list.iter().map(|e| (e.position(), e.kind(), e.triangle())).collect();
        assert_eq!(
            order,
            [
                (0.0, Kind::Start, 1),
                (1.0, Kind::End, 1),
                (1.0, Kind::Planar, 2),
                (1.0, Kind::Start, 3),
                (2.0, Kind::End, 3)
            ]
        );
    }
}
