//! Shapes that scenes are put together from. Metres, y upwards.

mod flat;
mod foliage;
mod round;
mod tube;

pub(crate) use foliage::Leaf;
