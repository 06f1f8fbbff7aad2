//! The scene that is chosen, as a list of its nodes and where they are.

use super::{
    json::{Node, Semantic},
    reader::Reader,
};
use crate::load::{LoadError, Loading, Place, Progress};
use glam::{DMat4, DQuat, DVec3};

/// A node and its transform to world space.
pub(super) struct Placed {
    pub(super) node: usize,
    pub(super) world: DMat4,
}

/// The nodes of a scene, parents before children, in the file's order.
pub(super) struct Placements {
    pub(super) list: Vec<Placed>,
    /// How many nodes are hidden, by `KHR_node_visibility`, or below such.
    pub(super) hidden: usize,
}

impl Reader<'_> {
    /// The nodes of scene `chosen`, or of the default one.
    pub(super) fn placements(
        &self,
        chosen: Option<usize>,
        progress: &Progress,
    ) -> Result<Placements, LoadError> {
        let root = self.root;
        let index = chosen.or(root.scene.map(|scene| scene.0));
        // The index after the last of a node's subtree is not known; whether a node is hidden goes down with it instead.
        let mut stack: Vec<(usize, DMat4, bool)> = Vec::new();
        let top = |node| (node, DMat4::IDENTITY, true);
        match root.scenes.get(index.unwrap_or(0)) {
            Some(scene) => stack.extend(scene.nodes.iter().rev().map(|node| top(node.0))),
            None if index.is_some() => {
                let (place, there) = (Place::Entry("scenes", index.unwrap_or(0)), root.scenes.len());
                let fix =
                    if chosen.is_some() { "choose one of those that are there" } else { "fix \"scene\"" };
                return Err(self.invalid(place, format!("there is none; the file has {there}"), fix));
            }
            // Without scenes the file is a library: all that has no parent.
            None => {
                let mut is_child = vec![false; root.nodes.len()];
                for child in root.nodes.iter().flat_map(|node| &node.children) {
                    if let Some(is_child) = is_child.get_mut(child.0) {
                        *is_child = true;
                    }
                }
                stack.extend((0..root.nodes.len()).rev().filter(|&node| !is_child[node]).map(top));
            }
        }
        let mut seen = vec![false; root.nodes.len()];
        let mut placements = Placements { list: Vec::new(), hidden: 0 };
        let mut visited = 0u64;
        while let Some((index, parent, shown)) = stack.pop() {
            visited += 1;
            if visited.is_multiple_of(1 << 12) {
                progress.reach(0.0)?;
            }
            let place = Place::Entry("nodes", index);
            let invalid = |what, fix| self.invalid(place, what, fix);
            let node = root.nodes.get(index);
            let node = node.ok_or_else(|| invalid("there is none", "fix the list that names it"))?;
            if std::mem::replace(&mut seen[index], true) {
                return Err(invalid("it has two parents or is its own ancestor", "make the nodes a tree"));
            }
            let world = parent * transform(node);
            let visibility = node.extensions.as_ref().and_then(|extensions| extensions.visibility.as_ref());
            let shown = shown && visibility.is_none_or(|visibility| visibility.visible);
            if shown {
                placements.list.push(Placed { node: index, world });
            } else {
                placements.hidden += 1;
            }
            stack.extend(node.children.iter().rev().map(|child| (child.0, world, shown)));
        }
        Ok(placements)
    }

    /// The instances of a node by `EXT_mesh_gpu_instancing`, as transforms before its own; `None` without.
    pub(super) fn instance_count(&self, node: &Node) -> Result<Option<u64>, LoadError> {
        let instances = node.extensions.as_ref().and_then(|extensions| extensions.instances.as_ref());
        let Some(instances) = instances else { return Ok(None) };
        let mut counts = instances.attributes.iter().map(|(_, accessor)| (accessor, self.count(accessor)));
        let Some((_, count)) = counts.next() else { return Ok(None) };
        let count = count?;
        for (accessor, other) in counts {
            let other = other?;
            if other != count {
                let what = format!("{other} entries for {count} instances");
                return Err(self.invalid(Place::Entry("accessors", accessor), what, "export it again"));
            }
        }
        Ok(Some(count))
    }

    /// The transforms of those instances. The caller has room for so many.
    pub(super) fn instances(&self, node: &Node) -> Result<Vec<DMat4>, LoadError> {
        let instances = node.extensions.as_ref().and_then(|extensions| extensions.instances.as_ref());
        let (Some(instances), Some(count)) = (instances, self.instance_count(node)?) else {
            return Ok(vec![DMat4::IDENTITY]);
        };
        let mut out = vec![DMat4::IDENTITY; count as usize];
        // Scaled first, then turned, then moved.
        if let Some(scales) = instances.attributes.get(Semantic::Scale) {
            let scales = self.read(scales, |s: [f64; 3]| DMat4::from_scale(DVec3::from(s)))?;
            out = scales;
        }
        let mut then = |next: Vec<DMat4>| out.iter_mut().zip(next).for_each(|(out, next)| *out = next * *out);
        if let Some(rotations) = instances.attributes.get(Semantic::Rotation) {
            then(self.read(rotations, |q: [f64; 4]| DMat4::from_quat(rotation(q)))?);
        }
        if let Some(places) = instances.attributes.get(Semantic::Translation) {
            then(self.read(places, |t: [f64; 3]| DMat4::from_translation(DVec3::from(t)))?);
        }
        Ok(out)
    }
}

/// A rotation that is normalised up to rounding; a zero one means nothing.
fn rotation(quaternion: [f64; 4]) -> DQuat {
    let quaternion = DQuat::from_array(quaternion);
    if quaternion.length_squared() > 0.0 { quaternion.normalize() } else { DQuat::IDENTITY }
}

/// A node's own transform.
fn transform(node: &Node) -> DMat4 {
    if let Some(matrix) = &node.matrix {
        return DMat4::from_cols_array(matrix);
    }
    DMat4::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, DVec3::from),
        node.rotation.map_or(DQuat::IDENTITY, rotation),
        node.translation.map_or(DVec3::ZERO, DVec3::from),
    )
}
