//! What every contender gives once it is built, and what it tells about itself.

pub use crate::workload::Found;
use crate::workload::Kind;
use slimkd::{KdTree, Ray, TriangleMesh};
use std::sync::Arc;
use std::time::Duration;

/// Rays that a batch interface gets at once: in its own layout, and still in the cache when it traces them.
pub const PIECE: usize = 4096;

/// How rays are handed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interface {
    /// One call a ray.
    Single,
    /// Batches of rays in any order.
    Stream,
    /// slimkd's batches of rays whose neighbours go the same way.
    Packet,
    /// Embree's packets, said to be coherent.
    PacketCoherent,
    /// Embree's packets with default flags.
    PacketDefault,
}

impl Interface {
    /// Whether rays of this kind are what it is made for.
    pub const fn takes(self, kind: Kind) -> bool {
        match self {
            Self::Single | Self::Stream | Self::PacketDefault => true,
            Self::Packet | Self::PacketCoherent => matches!(kind, Kind::Primary | Kind::Shadow),
        }
    }

    /// The name in tables and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Stream => "stream",
            Self::Packet => "packet",
            Self::PacketCoherent => "packet-coherent",
            Self::PacketDefault => "packet-default",
        }
    }
}

/// Where a size comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SizeSource {
    /// Lengths of its public buffers times their element sizes.
    Exact,
    /// The library's own report.
    OwnReport,
    /// Bytes that the build left allocated, capacity slack included.
    Counted,
}

impl SizeSource {
    /// The name in tables and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::OwnReport => "own-report",
            Self::Counted => "counted",
        }
    }
}

/// What a contender needs in memory to trace and to report public ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bytes {
    /// Nodes, index lists, and triangle blocks inside them.
    pub structure: u64,
    /// Triangle data that is kept beside it for tracing.
    pub copies: u64,
    /// The caller's indexed mesh where tracing reads it, else 0.
    pub mesh_read: u64,
    /// Where `structure` comes from.
    pub source: SizeSource,
}

impl Bytes {
    /// Everything added to the bare mesh.
    pub fn tree(&self) -> u64 {
        self.structure + self.copies
    }

    /// Everything that must stay in memory.
    pub fn resident(&self) -> u64 {
        self.tree() + self.mesh_read
    }
}

/// A built structure. All batches have one output a ray; the loop over a batch is the contender's own code, so no
/// dynamic call is paid by ray.
pub trait Traced: Send + Sync {
    /// Closest hits.
    fn closest(&self, rays: &[Ray], found: &mut [Found]);

    /// Whether anything is hit.
    fn any(&self, rays: &[Ray], blocked: &mut [bool]);

    /// The interfaces that it has; the first is [`Interface::Single`], which the two calls above are.
    fn interfaces(&self) -> &'static [Interface] {
        &[Interface::Single]
    }

    /// Closest hits through one of its interfaces. Returns how much of the time went into bringing rays and answers into
    /// and out of the layout of a batch interface, which is not counted.
    fn closest_through(&self, _interface: Interface, rays: &[Ray], found: &mut [Found]) -> Duration {
        self.closest(rays, found);
        Duration::ZERO
    }

    /// Whether anything is hit, through one of its interfaces. Returns the same.
    fn any_through(&self, _interface: Interface, rays: &[Ray], blocked: &mut [bool]) -> Duration {
        self.any(rays, blocked);
        Duration::ZERO
    }

    /// Its size; `counted` is what the build left allocated.
    fn bytes(&self, counted: u64) -> Bytes;

    /// slimkd's own tree, through which views are found.
    fn kd_tree(&self) -> Option<&KdTree> {
        None
    }
}

/// Facts about a contender that do not depend on the scene.
#[derive(Clone, Debug)]
pub struct Info {
    /// Unique, without spaces: what `--peers` selects by.
    pub name: String,
    /// The library.
    pub library: &'static str,
    /// Its version.
    pub version: String,
    /// What differs from its defaults, and how triangles are kept.
    pub settings: String,
    /// Constants of its surface area heuristic.
    pub sah: String,
}

/// Something that can be built over a mesh.
pub trait Contender: Sync {
    /// Who it is.
    fn info(&self) -> Info;

    /// Why it should not be built over so large a mesh without `--all`.
    fn too_slow(&self, _mesh: &TriangleMesh) -> Option<String> {
        None
    }

    /// False where a build always uses all threads.
    fn threads_controllable(&self) -> bool {
        true
    }

    /// Builds it. Runs inside a rayon pool of `threads` threads.
    fn build(&self, mesh: &Arc<TriangleMesh>, threads: usize) -> Result<Box<dyn Traced>, String>;
}
