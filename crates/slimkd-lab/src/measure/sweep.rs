//! What the two thresholds of T-references do to size and rate.

use super::frames::{Cpu, on_view};
use super::session::Session;
use super::shape::shape;
use super::trees::Trees;
use crate::basics::ReportError;
use crate::schema::{SweepPoint, SweepRow, View};
use slimkd::{BuildOptions, Hoisting, Preset};

/// Trees of one occupancy threshold, on one thread.
pub(super) fn measure(
    session: &Session<'_>,
    trees: &mut Trees<'_>,
    view: &View,
    occupancy: f32,
) -> Result<SweepRow, ReportError> {
    trees.ensure(Preset::Standard)?;
    let mut built = Vec::new();
    for &frequency in &session.options.frequencies {
        let mut options = BuildOptions::from(Preset::PaperFast);
        options.hoisting = Some(Hoisting::new(occupancy, frequency));
        let name = format!("occupancy {occupancy}, frequency {frequency}");
        let tree = trees.build(&name, &options)?;
        built.push((name, frequency, tree));
    }
    let mut named = vec![("standard", trees.get(Preset::Standard))];
    named.extend(built.iter().map(|(name, _, tree)| (name.as_str(), tree)));
    let edge = session.options.sweep_edge;
    let mut seconds = on_view(session, trees.scene, &named, view, edge, &Cpu::new(1)?)?.into_iter();
    let standard_bytes = named[0].1.memory().tree();
    Ok(SweepRow {
        occupancy,
        standard_bytes,
        standard_seconds: seconds.next().unwrap_or_default(),
        points: built
            .iter()
            .zip(seconds)
            .map(|((_, frequency, tree), seconds)| SweepPoint {
                frequency: *frequency,
                shape: shape(tree, &tree.statistics()),
                seconds,
            })
            .collect(),
    })
}
