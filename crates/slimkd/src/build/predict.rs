//! T-references while building: the two measures estimated from a node's triangles, before it has a subtree.
//!
//! Source: Choi, Chang & Ihm 2013, conclusion: "Need an effective occupancy measure that does not require a repeated
//! application of the standard SAH-based construction process."
//!
//! The estimate: leaves will be where triangles are, so every other triangle of the node stands for a leaf of its
//! clipped bounds. A triangle is taken to lie in those leaves whose bounds its own clipped bounds meet:
//! `f_freq ≈ |{s : box(s) ∩ box(t)}| / |{s}|`, and `f_occ` the same weighed by `SA(box(s))`.

use super::event::{Event, Kind};
use crate::geometry::Aabb;
use crate::reduce::Hoisting;

/// Nodes with more triangles are not searched: the estimate compares all pairs, and a triangle in 40 % of that many
/// leaves is rare.
const MOST_TRIANGLES: u32 = 128;

/// Picks triangles by estimated measures; reused from node to node.
pub(crate) struct Predictor<'a> {
    hoisting: &'a Hoisting,
    ids: Vec<u32>,
    boxes: Vec<Aabb>,
    areas: Vec<f32>,
}

impl<'a> Predictor<'a> {
    pub(crate) fn new(hoisting: &'a Hoisting) -> Self {
        Self { hoisting, ids: Vec::new(), boxes: Vec::new(), areas: Vec::new() }
    }

    /// The triangle to hoist in a node with these event lists, if any.
    pub(crate) fn pick(&mut self, lists: &[&[Event]; 3], count: u32) -> Option<u32> {
        if count > MOST_TRIANGLES {
            return None;
        }
        self.gather(lists);
        let mut best: Option<(f64, u32)> = None;
        let total: f64 = self.areas.iter().map(|&area| f64::from(area)).sum();
        for (i, bounds) in self.boxes.iter().enumerate() {
            let (mut met, mut met_area) = (0u32, 0.0f64);
            for (j, other) in self.boxes.iter().enumerate() {
                if i != j && (0..3).all(|k| bounds.min[k] <= other.max[k] && other.min[k] <= bounds.max[k]) {
                    met += 1;
                    met_area += f64::from(self.areas[j]);
                }
            }
            let others = total - f64::from(self.areas[i]);
            let occupancy = if others > 0.0 { met_area / others } else { 0.0 };
            let frequency = f64::from(met) / f64::from(count - 1);
            if occupancy > f64::from(self.hoisting.occupancy)
                && frequency > f64::from(self.hoisting.frequency)
                && best.is_none_or(|(most, _)| occupancy > most)
            {
                best = Some((occupancy, self.ids[i]));
            }
        }
        best.map(|(_, id)| id)
    }

    /// Clipped bounds of every triangle, by ascending id.
    fn gather(&mut self, lists: &[&[Event]; 3]) {
        self.ids.clear();
        self.ids.extend(lists[0].iter().filter(|event| event.opens()).map(|event| event.triangle()));
        self.ids.sort_unstable();
        self.boxes.clear();
        self.boxes.resize(self.ids.len(), Aabb::EMPTY);
        for (axis, list) in lists.iter().enumerate() {
            for event in *list {
                let Ok(slot) = self.ids.binary_search(&event.triangle()) else { continue };
                let bounds = &mut self.boxes[slot];
                if event.kind() != Kind::End {
                    bounds.min[axis] = event.position();
                }
                if event.kind() != Kind::Start {
                    bounds.max[axis] = event.position();
                }
            }
        }
        self.areas.clear();
        self.areas.extend(self.boxes.iter().map(|bounds| bounds.surface_area() as f32));
    }
}
