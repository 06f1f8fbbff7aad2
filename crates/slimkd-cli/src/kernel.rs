//! How rays are traced.

use clap::ValueEnum;
use slimkd::{Hit, KdTree, Ray};

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
    pub(crate) fn closest(self, tree: &KdTree, rays: &[Ray], hits: &mut [Option<Hit>]) {
        match self {
            Self::Single => rays.iter().zip(hits).for_each(|(ray, hit)| *hit = tree.closest_hit(ray)),
            Self::Packet => tree.closest_hits_coherent(rays, hits),
            Self::Stream => tree.closest_hits(rays, hits),
        }
    }

    /// Any-hit answers of a batch.
    pub(crate) fn any(self, tree: &KdTree, rays: &[Ray], hits: &mut [bool]) {
        match self {
            Self::Single => rays.iter().zip(hits).for_each(|(ray, hit)| *hit = tree.any_hit(ray)),
            Self::Packet => tree.any_hits_coherent(rays, hits),
            Self::Stream => tree.any_hits(rays, hits),
        }
    }
}
