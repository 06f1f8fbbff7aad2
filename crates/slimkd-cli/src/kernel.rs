//! How rays are traced.

use clap::ValueEnum;
use slimkd::{Hit, Ray, Tracer};

/// A traversal kernel. All give the same hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kernel {
    /// Ray by ray
    #[default]
    Single,
    /// Neighbouring rays together, in groups of 64 and packets of 16
    Packet,
    /// Batches of rays in any order
    Stream,
}

impl Kernel {
    /// The name in JSON.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Packet => "packet",
            Self::Stream => "stream",
        }
    }

    /// Closest hits of a batch.
    pub(crate) fn closest(self, tree: &dyn Tracer, rays: &[Ray], hits: &mut [Option<Hit>]) {
        match self {
            Self::Single => rays.iter().zip(hits).for_each(|(ray, hit)| *hit = tree.closest(ray)),
            Self::Packet => tree.batch().coherent().closest(rays, hits),
            Self::Stream => tree.batch().closest(rays, hits),
        }
    }

    /// Any-hit answers of a batch.
    pub(crate) fn any(self, tree: &dyn Tracer, rays: &[Ray], hits: &mut [bool]) {
        match self {
            Self::Single => rays.iter().zip(hits).for_each(|(ray, hit)| *hit = tree.any(ray)),
            Self::Packet => tree.batch().coherent().any(rays, hits),
            Self::Stream => tree.batch().any(rays, hits),
        }
    }
}
