//! Skins in the pose that their joints stand in (glTF 2.0, section 3.7.3.3).

use super::{nodes::Placed, reader::Reader};
use crate::load::{LoadError, Place};
use glam::DMat4;

/// A skin's joints as they stand: where each takes a vertex to.
pub(super) struct Pose(Vec<DMat4>);

impl Pose {
    pub(super) fn joint(&self, index: usize) -> Option<DMat4> {
        self.0.get(index).copied()
    }
}

impl Reader<'_> {
    /// The pose of each skin that a placed node with a mesh uses; `None` for others, and where a joint is in no scene.
    pub(super) fn poses(&self, placed: &[Placed]) -> Result<Vec<Option<Pose>>, LoadError> {
        let root = self.root;
        let mut poses: Vec<Option<Pose>> = root.skins.iter().map(|_| None).collect();
        let nodes =
            || placed.iter().map(|placed| &root.nodes[placed.node]).filter(|node| node.mesh.is_some());
        if nodes().all(|node| node.skin.is_none()) {
            return Ok(poses);
        }
        let mut worlds = vec![None; root.nodes.len()];
        placed.iter().for_each(|placed| worlds[placed.node] = Some(placed.world));
        for index in nodes().filter_map(|node| node.skin) {
            let place = Place::Entry("skins", index.0);
            let skin = root.skins.get(index.0);
            let skin = skin.ok_or_else(|| self.invalid(place, "there is none", "fix the node"))?;
            if poses[index.0].is_some() {
                continue;
            }
            let joints: Option<Vec<DMat4>> = skin.joints.iter().map(|joint| *worlds.get(joint.0)?).collect();
            let Some(mut joints) = joints else { continue };
            if let Some(bind) = skin.inverse_bind_matrices {
                let count = self.count(bind.0)?;
                if count < joints.len() as u64 {
                    let what = format!("{count} inverse bind matrices for {} joints", joints.len());
                    return Err(self.invalid(place, what, "export it again"));
                }
                self.spend_decoding(count.saturating_mul(128))?;
                let bind = self.read(bind.0, |matrix: [f64; 16]| DMat4::from_cols_array(&matrix))?;
                joints.iter_mut().zip(bind).for_each(|(joint, bind)| *joint *= bind);
            }
            poses[index.0] = Some(Pose(joints));
        }
        Ok(poses)
    }
}
