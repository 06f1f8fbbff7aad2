//! T-references while building: the two measures estimated from a node's triangles, before it has a subtree.
//!
//! Source: Choi, Chang & Ihm 2013, conclusion: "Need an effective occupancy measure that does not require a repeated
//! application of the standard SAH-based construction process."
//!
//! The estimate: leaves will be where triangles are, so every other triangle of the node stands for a leaf of its
//! clipped bounds. A triangle is taken to lie in those leaves whose bounds its own clipped bounds meet:
//! `f_freq ≈ |{s : box(s) ∩ box(t)}| / |{s}|`, and `f_occ` the same weighed by `SA(box(s))`.

use super::fragment::Fragment;
use crate::reduce::Hoisting;

/// Nodes with more triangles are not searched: the estimate compares all pairs, and a triangle in 40 % of that many
/// leaves is rare.
const MOST_TRIANGLES: usize = 128;

/// Picks triangles by estimated measures; reused from node to node.
pub(crate) struct Predictor<'a> {
    hoisting: &'a Hoisting,
    areas: Vec<f32>,
}

impl<'a> Predictor<'a> {
    pub(crate) fn new(hoisting: &'a Hoisting) -> Self {
        Self { hoisting, areas: Vec::new() }
    }

    /// The triangle to hoist in a node of these fragments, if any; its own comes last then.
    pub(crate) fn pick(&mut self, node: &mut [Fragment]) -> Option<u32> {
        let count = node.len();
        if count > MOST_TRIANGLES {
            return None;
        }
        // Sums and ties must not depend on the order in which the fragments came.
        node.sort_unstable_by_key(Fragment::triangle);
        self.areas.clear();
        self.areas.extend(node.iter().map(|fragment| fragment.bounds().surface_area() as f32));
        let mut best: Option<(f64, usize)> = None;
        let total: f64 = self.areas.iter().map(|&area| f64::from(area)).sum();
        for (i, one) in node.iter().enumerate() {
            let (mut met, mut met_area) = (0u32, 0.0f64);
            for (j, other) in node.iter().enumerate() {
                if i != j && (0..3).all(|k| one.low[k] <= other.high[k] && other.low[k] <= one.high[k]) {
                    met += 1;
                    met_area += f64::from(self.areas[j]);
                }
            }
            let others = total - f64::from(self.areas[i]);
            let occupancy = if others > 0.0 { met_area / others } else { 0.0 };
            let frequency = f64::from(met) / (count - 1) as f64;
            if occupancy > f64::from(self.hoisting.occupancy)
                && frequency > f64::from(self.hoisting.frequency)
                && best.is_none_or(|(most, _)| occupancy > most)
            {
                best = Some((occupancy, i));
            }
        }
        let (_, at) = best?;
        node.swap(at, count - 1);
        Some(node[count - 1].triangle())
    }
}
