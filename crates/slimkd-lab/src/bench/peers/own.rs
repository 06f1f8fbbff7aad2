//! slimkd itself, one contender a tree.

use super::locked_version;
use crate::bench::built::{Bytes, Contender, Found, Info, Interface, PIECE, SizeSource, Traced};
use crate::bench::variant::Variant;
use slimkd::{BuildOptions, InstructionSet, KdTree, Layout, Ray, Splits, Tracer, TriangleMesh};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::{Duration, Instant};

pub(super) struct Own {
    name: String,
    options: BuildOptions,
    isa: Option<InstructionSet>,
}

impl Own {
    pub(super) fn new(tree: Variant, isa: Option<InstructionSet>) -> Self {
        Self { name: format!("slimkd-{}", tree.name), options: tree.options, isa }
    }
}

impl Contender for Own {
    fn info(&self) -> Info {
        let sah = self.options.sah;
        Info {
            name: self.name.clone(),
            library: "slimkd",
            version: locked_version("slimkd"),
            settings: settings(&self.options),
            sah: format!(
                "traversal {}, intersection {}, empty bonus {}, leaf at most {}, clipping {:?}",
                sah.traversal,
                sah.intersection,
                sah.empty_bonus,
                self.options.leaf_at_most,
                self.options.clipping
            ),
        }
    }

    fn build(&self, mesh: &Arc<TriangleMesh>, threads: usize) -> Result<Box<dyn Traced>, String> {
        let mut options = self.options.clone();
        options.threads = NonZeroUsize::new(threads);
        let tree = KdTree::build(mesh.clone(), &options).map_err(|error| error.to_string())?;
        Ok(Box::new(OwnTree { tree, isa: self.isa.unwrap_or(InstructionSet::best()) }))
    }
}

/// What tells the presets apart.
fn settings(options: &BuildOptions) -> String {
    let references = match &options.hoisting {
        Some(hoisting) => format!("T-references at ({}, {})", hoisting.occupancy, hoisting.frequency),
        None => "no T-references".into(),
    };
    let leaves = match options.layout {
        Layout::FourByte => "4-byte leaves",
        Layout::TwoByte => "2-byte leaves",
        Layout::Wide if options.splits == Splits::Space => "wide layout, split by planes alone",
        Layout::Wide => "wide layout",
        _ => "dense layout",
    };
    let collapse = match (options.collapse, options.byte_weight) {
        (false, _) => "no collapse".into(),
        (true, weight) => format!("collapse at byte weight {weight}"),
    };
    format!("{references}, {leaves}, {collapse}; also returns u, v")
}

/// A tree, and what its batches are traced with.
pub struct OwnTree {
    /// The tree.
    pub tree: KdTree,
    /// Of its batches.
    pub isa: InstructionSet,
}

impl Traced for OwnTree {
    fn closest(&self, rays: &[Ray], found: &mut [Found]) {
        for (ray, slot) in rays.iter().zip(found) {
            *slot =
                self.tree.closest(ray).map_or(Found::MISS, |hit| Found { t: hit.t, triangle: hit.triangle });
        }
    }

    fn any(&self, rays: &[Ray], blocked: &mut [bool]) {
        for (ray, slot) in rays.iter().zip(blocked) {
            *slot = self.tree.any(ray);
        }
    }

    fn interfaces(&self) -> &'static [Interface] {
        &[Interface::Single, Interface::Stream, Interface::Packet]
    }

    fn closest_through(&self, interface: Interface, rays: &[Ray], found: &mut [Found]) -> Duration {
        if interface == Interface::Single {
            self.closest(rays, found);
            return Duration::ZERO;
        }
        let start = Instant::now();
        let mut tracing = Duration::ZERO;
        let (mut own, mut hits) = (Vec::with_capacity(PIECE), vec![None; PIECE]);
        for (rays, found) in rays.chunks(PIECE).zip(found.chunks_mut(PIECE)) {
            let hits = &mut hits[..rays.len()];
            own.clear();
            own.extend_from_slice(rays);
            let traced = Instant::now();
            match interface {
                Interface::Packet => {
                    self.tree.batch().instruction_set(self.isa).coherent().closest(&own, &mut *hits)
                }
                _ => self.tree.batch().instruction_set(self.isa).closest(&own, &mut *hits),
            }
            tracing += traced.elapsed();
            for (slot, hit) in found.iter_mut().zip(hits) {
                *slot = hit.map_or(Found::MISS, |hit| Found { t: hit.t, triangle: hit.triangle });
            }
        }
        start.elapsed() - tracing
    }

    fn any_through(&self, interface: Interface, rays: &[Ray], blocked: &mut [bool]) -> Duration {
        if interface == Interface::Single {
            self.any(rays, blocked);
            return Duration::ZERO;
        }
        let start = Instant::now();
        let mut tracing = Duration::ZERO;
        let mut own = Vec::with_capacity(PIECE);
        for (rays, blocked) in rays.chunks(PIECE).zip(blocked.chunks_mut(PIECE)) {
            own.clear();
            own.extend_from_slice(rays);
            let traced = Instant::now();
            match interface {
                Interface::Packet => {
                    self.tree.batch().instruction_set(self.isa).coherent().any(&own, blocked)
                }
                _ => self.tree.batch().instruction_set(self.isa).any(&own, blocked),
            }
            tracing += traced.elapsed();
        }
        start.elapsed() - tracing
    }

    fn bytes(&self, _counted: u64) -> Bytes {
        let memory = self.tree.memory();
        Bytes { structure: memory.tree(), copies: 0, mesh_read: memory.mesh, source: SizeSource::Exact }
    }

    fn kd_tree(&self) -> Option<&KdTree> {
        Some(&self.tree)
    }
}
