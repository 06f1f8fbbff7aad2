//! What a byte of the tree costs beside rays.

use super::UnitBytes;
use crate::geometry::Aabb;
use crate::options::Layout;

/// The price of bytes in a tree that is collapsed by rays and by bytes: `λ = ℓ · SAH cost / bytes`, both of the whole tree before
/// it is collapsed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Price {
    /// ℓ, see [`BuildOptions::byte_weight`](crate::BuildOptions::byte_weight).
    pub(crate) byte_weight: f32,
    /// SAH cost over bytes.
    pub(crate) cost_of_a_byte: f64,
    /// Surface area of the root's voxel.
    pub(crate) root_area: f64,
}

impl Price {
    /// λ: SAH cost of the root's voxel that a byte must save.
    pub(crate) fn lambda(&self) -> f64 {
        f64::from(self.byte_weight) * self.cost_of_a_byte
    }

    /// How much cheaper than a leaf a split of `voxel` must be so that the two nodes that it adds pay.
    pub(crate) fn of_a_split(&self, voxel: &Aabb, layout: Layout) -> f64 {
        let added = 2.0 * UnitBytes::of(layout).node * self.lambda();
        if added > 0.0 { added * self.root_area / voxel.surface_area() } else { 0.0 }
    }
}
