//! Building, and what a preset's tree looks like.

use super::session::Session;
use super::shape::shape;
use crate::basics::ReportError;
use crate::schema::{Build, EdgeInterval, Interval, Tree};
use slimkd::{BuildError, BuildOptions, KdTree, Preset, TreeStatistics, TriangleMesh};
use slimkd_scene::Scene;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

/// The slides' coarser intervals, for edges.
const EDGE_INTERVALS: [(u32, u32); 11] = [
    (10_001, u32::MAX),
    (5001, 10_000),
    (2001, 5000),
    (1001, 2000),
    (501, 1000),
    (201, 500),
    (101, 200),
    (51, 100),
    (21, 50),
    (11, 20),
    (1, 10),
];

/// Those that are compared; `tiny` adds nothing where memory is short.
pub(super) fn presets(very_large: bool) -> Vec<Preset> {
    Preset::ALL.iter().copied().filter(|&preset| !very_large || preset != Preset::Tiny).collect()
}

/// The presets' trees of a scene, built when first asked for: a run that only resumes builds none.
pub(super) struct Trees<'a> {
    pub(super) scene: &'a Scene,
    session: &'a Session<'a>,
    built: Vec<(Preset, KdTree)>,
}

impl<'a> Trees<'a> {
    pub(super) fn new(session: &'a Session<'a>, scene: &'a Scene) -> Self {
        Self { scene, session, built: Vec::new() }
    }

    /// Builds it unless it is there.
    pub(super) fn ensure(&mut self, preset: Preset) -> Result<(), ReportError> {
        if self.built.iter().all(|(other, _)| *other != preset) {
            let tree = self.build(preset.name(), &preset.into())?;
            self.built.push((preset, tree));
        }
        Ok(())
    }

    pub(super) fn ensure_all(&mut self, presets: &[Preset]) -> Result<(), ReportError> {
        presets.iter().try_for_each(|&preset| self.ensure(preset))
    }

    /// A tree that was ensured.
    ///
    /// # Panics
    /// Where it was not.
    pub(super) fn get(&self, preset: Preset) -> &KdTree {
        let found = self.built.iter().find(|(other, _)| *other == preset);
        &found.unwrap_or_else(|| panic!("{} was not built", preset.name())).1
    }

    /// Any tree.
    pub(super) fn build(&self, name: &str, options: &BuildOptions) -> Result<KdTree, ReportError> {
        build(self.session, &self.scene.name, &self.scene.mesh, name, options)
    }
}

pub(super) fn build(
    session: &Session<'_>,
    scene: &str,
    mesh: &Arc<TriangleMesh>,
    name: &str,
    options: &BuildOptions,
) -> Result<KdTree, ReportError> {
    let progress = session.progress.piece();
    KdTree::build_with_progress(Arc::clone(mesh), options, &progress).map_err(|error| match error {
        BuildError::Cancelled => ReportError::Cancelled,
        error => ReportError::Build { scene: scene.to_owned(), tree: name.to_owned(), error },
    })
}

/// Builds so often with each number of threads that the options say.
pub(super) fn time_builds(
    session: &Session<'_>,
    scene: &str,
    mesh: &Arc<TriangleMesh>,
    preset: Preset,
    rounds: usize,
) -> Result<Vec<Build>, ReportError> {
    let mut builds: Vec<Build> =
        session.options.threads.iter().map(|&threads| Build { threads, seconds: Vec::new() }).collect();
    for _ in 0..rounds {
        for build_times in &mut builds {
            let mut options = BuildOptions::from(preset);
            options.threads = NonZeroUsize::new(build_times.threads);
            let started = Instant::now();
            build(session, scene, mesh, preset.name(), &options)?;
            build_times.seconds.push(started.elapsed().as_secs_f64());
        }
    }
    Ok(builds)
}

/// Everything about a preset's tree, built so often; degenerate triangles first.
pub(super) fn measure(
    session: &Session<'_>,
    trees: &mut Trees<'_>,
    preset: Preset,
    rounds: usize,
) -> Result<(u64, Tree), ReportError> {
    trees.ensure(preset)?;
    let scene = trees.scene;
    let builds = time_builds(session, &scene.name, &scene.mesh, preset, rounds)?;
    let tree = trees.get(preset);
    let statistics = tree.statistics();
    let intervals = TreeStatistics::DUPLICATION_INTERVALS.iter().zip(&statistics.duplication);
    let duplication = intervals.map(|(&(from, to), &triangles)| Interval { from, to, triangles }).collect();
    let longest_edges = longest_edges(&scene.mesh, &tree.references_per_triangle());
    let measured = Tree {
        name: preset.name().to_owned(),
        shape: shape(tree, &statistics),
        leaf_depths: statistics.leaf_depths,
        duplication,
        longest_edges,
        builds,
    };
    Ok((statistics.degenerate, measured))
}

fn longest_edges(mesh: &TriangleMesh, references: &[u32]) -> Vec<EdgeInterval> {
    let longest = |id: usize| {
        let [a, b, c] = mesh.corners(id as u32).map(|corner| glam::Vec3::from(corner).as_dvec3());
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    };
    let interval = |&(from, to): &(u32, u32)| {
        let members = (0..references.len()).filter(|&id| (from..=to).contains(&references[id]));
        let (count, sum) = members.fold((0u64, 0.0), |(count, sum), id| (count + 1, sum + longest(id)));
        let mean_longest_edge = (count > 0).then(|| sum / count as f64);
        EdgeInterval { from, to, triangles: count, mean_longest_edge }
    };
    EDGE_INTERVALS.iter().map(interval).collect()
}
