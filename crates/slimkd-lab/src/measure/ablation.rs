//! What each step from `standard` to `tiny` brings.

use super::frames::{Cpu, on_view};
use super::session::Session;
use super::shape::shape;
use super::trees::Trees;
use crate::basics::ReportError;
use crate::schema::{Ablation, AblationStep, View};
use slimkd::{BuildOptions, Hoisting, Layout, Preset};

/// The trees, each by one step from another.
fn steps() -> Vec<(&'static str, BuildOptions)> {
    let standard = BuildOptions::from(Preset::Standard);
    let slim = BuildOptions::from(Preset::Slim);
    let mut constants = slim.clone();
    (constants.collapse, constants.byte_weight) = (false, 0.0);
    (constants.layout, constants.max_tree) = (Layout::FourByte, None);
    let mut collapse = constants.clone();
    collapse.collapse = true;
    let mut narrow = collapse.clone();
    narrow.layout = Layout::TwoByte;
    let mut hoisted = narrow.clone();
    hoisted.hoisting = Some(Hoisting::new(0.9, 0.7));
    let mut weighed = narrow.clone();
    weighed.byte_weight = slim.byte_weight;
    vec![
        ("standard", standard),
        ("standard at slim's constants", constants),
        ("+ collapse", collapse),
        ("+ 2-byte leaves", narrow),
        ("+ T-references (0.9, 0.7)", hoisted),
        ("2-byte leaves + pruning by bytes", weighed),
        ("slim: the same in the dense layout, at most 10 B/triangle", slim),
        ("tiny: a larger weight of bytes, at most 7 B/triangle", Preset::Tiny.into()),
    ]
}

/// On one thread.
pub(super) fn measure(
    session: &Session<'_>,
    trees: &mut Trees<'_>,
    view: &View,
) -> Result<Ablation, ReportError> {
    let mut built = Vec::new();
    for (name, options) in steps() {
        built.push((name, trees.build(name, &options)?));
    }
    let named: Vec<_> = built.iter().map(|(name, tree)| (*name, tree)).collect();
    let edge = session.options.sweep_edge;
    let seconds = on_view(session, trees.scene, &named, view, edge, &Cpu::new(1)?)?;
    let steps = built.iter().zip(seconds).map(|((name, tree), seconds)| AblationStep {
        name: (*name).to_owned(),
        shape: shape(tree, &tree.statistics()),
        seconds,
    });
    Ok(Ablation { steps: steps.collect() })
}
