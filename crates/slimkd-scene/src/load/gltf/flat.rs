//! The scene's primitives as one mesh.

use super::{
    draco,
    json::{self, Primitive, Semantic},
    nodes::Placed,
    reader::Reader,
    skin::Pose,
};
use crate::{
    Attribute, Scene, Warning, WarningKind,
    load::{LoadError, Loading, Place, Progress, source::growth_limit, warn},
    origin::Frame,
};
use glam::{DAffine2, DMat3, DMat4, DVec2, DVec3};
use slimkd::TriangleMesh;
use std::{collections::HashMap, rc::Rc, sync::Arc};

/// Least budget that drawing a primitive, or placing an instance, costs, bytes: many empty ones cost time.
const PRIMITIVE: u64 = 256;
/// Position, normal, texture coordinates, colour.
const VERTEX: u64 = 40;
/// The triangle, its material, and up to two index triples.
const TRIANGLE: u64 = 40;
/// A vertex while it is put together out of morph targets or joints.
const MOVED: u64 = 48;

/// A primitive as it is drawn once.
#[derive(Clone, Copy)]
pub(super) struct Drawn<'a> {
    pub(super) primitive: &'a Primitive,
    pub(super) place: Place,
    pub(super) weights: &'a [f64],
    pub(super) pose: Option<&'a Pose>,
    pub(super) world: DMat4,
    /// Drawn elsewhere too.
    pub(super) again: bool,
}

/// What was met and left out.
#[derive(Default)]
struct Ignored {
    primitives: u64,
    lines: u64,
    without_positions: u64,
    corners: u64,
}

/// Which attributes a run of triangles has.
#[derive(Clone, Copy)]
struct Run {
    end: usize,
    normals: bool,
    uvs: bool,
    colours: bool,
}

/// The flattened scene.
pub(super) struct Flat<'a> {
    reader: &'a Reader<'a>,
    frame: &'a Frame,
    /// Bytes that the mesh may still take.
    left: u64,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    colours: Vec<[u8; 4]>,
    triangles: Vec<[u32; 3]>,
    material_ids: Vec<u32>,
    runs: Vec<Run>,
    ignored: Ignored,
    /// Primitives that Draco compressed and that are drawn more than once, by their views.
    draco: HashMap<usize, Rc<draco::Mesh>>,
}

/// How a primitive's corners make triangles (glTF 2.0, section 3.7.2.1).
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mode {
    Triangles,
    Strip,
    Fan,
}

impl Mode {
    /// `None`: points or lines.
    fn of(primitive: &Primitive) -> Option<Option<Self>> {
        Some(match primitive.mode.map_or(4, |mode| mode.0) {
            0..=3 => None,
            4 => Some(Self::Triangles),
            5 => Some(Self::Strip),
            6 => Some(Self::Fan),
            _ => return None,
        })
    }
}

impl<'a> Flat<'a> {
    pub(super) fn new(reader: &'a Reader<'a>, frame: &'a Frame) -> Self {
        Self {
            reader,
            frame,
            left: growth_limit(reader.input),
            positions: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colours: Vec::new(),
            triangles: Vec::new(),
            material_ids: Vec::new(),
            runs: Vec::new(),
            ignored: Ignored::default(),
            draco: HashMap::new(),
        }
    }

    /// Takes from the budget what comes next.
    fn spend(&mut self, bytes: u64) -> Result<(), LoadError> {
        self.left = self.left.checked_sub(bytes).ok_or(LoadError::OutOfProportion {
            what: "the flattened instances",
            limit: growth_limit(self.reader.input),
            input: self.reader.input,
            fix: "split the scene",
        })?;
        Ok(())
    }

    /// Takes from the budget what [`Flat::draw`] is sure to take; what else is wrong is left to that.
    pub(super) fn weigh(&mut self, placed: &[Placed]) -> Result<(), LoadError> {
        let whole = self.left;
        for placed in placed {
            let node = &self.reader.root.nodes[placed.node];
            let Some(mesh) = node.mesh.and_then(|mesh| self.reader.root.meshes.get(mesh.0)) else { continue };
            let instances = self.reader.instance_count(node)?;
            self.spend(instances.unwrap_or(0).saturating_mul(PRIMITIVE))?;
            for primitive in &mesh.primitives {
                self.spend(self.least(primitive).saturating_mul(instances.unwrap_or(1)))?;
            }
        }
        self.left = whole;
        Ok(())
    }

    /// The least that a primitive takes.
    fn least(&self, primitive: &Primitive) -> u64 {
        let count = |index: usize| self.reader.count(index).unwrap_or(0);
        let vertices = primitive.attributes.get(Semantic::Position).map_or(0, count);
        let corners = primitive.indices.map_or(vertices, |index| count(index.0));
        match Mode::of(primitive) {
            // As many triangles at least; a strip has more.
            Some(Some(_)) if vertices > 0 => PRIMITIVE
                .saturating_add(vertices.saturating_mul(32))
                .saturating_add((corners / 3).saturating_mul(TRIANGLE)),
            _ => PRIMITIVE,
        }
    }

    /// Adds what is placed, in that order.
    pub(super) fn draw(
        &mut self,
        placed: &[Placed],
        poses: &[Option<Pose>],
        progress: &Progress,
    ) -> Result<(), LoadError> {
        let root = self.reader.root;
        let mut uses = vec![0u32; root.meshes.len()];
        for mesh in placed.iter().filter_map(|placed| root.nodes[placed.node].mesh) {
            if let Some(uses) = uses.get_mut(mesh.0) {
                *uses += 1;
            }
        }
        for (done, placed) in placed.iter().enumerate() {
            progress.parsed(done, poses.len().max(root.nodes.len()))?;
            let node = &root.nodes[placed.node];
            let Some(mesh) = node.mesh else { continue };
            let place = Place::Entry("meshes", mesh.0);
            let uses = uses.get(mesh.0).copied().unwrap_or(0);
            let mesh = root.meshes.get(mesh.0);
            let mesh = mesh.ok_or_else(|| self.reader.invalid(place, "there is none", "fix the node"))?;
            let instances = match self.reader.instance_count(node)? {
                Some(count) => {
                    self.spend(count.saturating_mul(PRIMITIVE))?;
                    self.reader.instances(node)?
                }
                None => vec![DMat4::IDENTITY],
            };
            let weights = node.weights.as_ref().unwrap_or(&mesh.weights);
            let pose = node.skin.and_then(|skin| poses.get(skin.0)?.as_ref());
            let again = uses > 1 || instances.len() > 1;
            for instance in &instances {
                for primitive in &mesh.primitives {
                    progress.reach(0.0)?;
                    let world = placed.world * *instance;
                    self.primitive(&Drawn { primitive, place, weights, pose, world, again })?;
                }
            }
        }
        Ok(())
    }

    fn unpacked(&mut self, drawn: &Drawn<'_>) -> Result<Option<Rc<draco::Mesh>>, LoadError> {
        let Some(packed) = &drawn.primitive.extensions.draco else { return Ok(None) };
        if let Some(mesh) = self.draco.get(&packed.buffer_view.0) {
            return Ok(Some(Rc::clone(mesh)));
        }
        let mesh = Rc::new(self.reader.draco(packed)?);
        if drawn.again {
            self.draco.insert(packed.buffer_view.0, Rc::clone(&mesh));
        }
        Ok(Some(mesh))
    }

    fn primitive(&mut self, drawn: &Drawn<'_>) -> Result<(), LoadError> {
        let (reader, primitive, world) = (self.reader, drawn.primitive, drawn.world);
        self.spend(PRIMITIVE)?;
        self.ignored.primitives += 1;
        let mode = match Mode::of(primitive) {
            Some(Some(mode)) => mode,
            Some(None) => {
                self.ignored.lines += 1;
                return Ok(());
            }
            None => return Err(reader.invalid(drawn.place, "an unknown primitive mode", "export it again")),
        };
        let Some(positions) = primitive.attributes.get(Semantic::Position) else {
            // Allowed by the format, for extensions to fill in.
            self.ignored.without_positions += 1;
            return Ok(());
        };
        let unpacked = self.unpacked(drawn)?;
        let count = match &unpacked {
            Some(mesh) => mesh.vertices() as u64,
            None => reader.count(positions)?,
        };
        self.spend(count.saturating_mul(VERTEX))?;
        let vertices = Vertices { reader, drawn, unpacked: unpacked.as_deref(), count };
        let first = self.positions.len();
        let mut mixes = None;
        if vertices.is_moved() {
            self.spend(count.saturating_mul(MOVED))?;
            let mut moved =
                vertices.sum(Semantic::Position, |p: [f64; 3]| DVec3::from(p))?.unwrap_or_default();
            mixes = drawn.pose.map(|pose| vertices.mixes(pose)).transpose()?.flatten();
            if let Some(mixes) = &mixes {
                moved.iter_mut().zip(mixes).for_each(|(p, mix)| *p = mix.transform_point3(*p));
            } else {
                moved.iter_mut().for_each(|p| *p = world.transform_point3(*p));
            }
            self.positions.extend(moved.into_iter().map(|p| self.frame.put(p.to_array())));
        } else {
            let frame = self.frame;
            let to_world = |p: [f64; 3]| frame.put(world.transform_point3(DVec3::from(p)).to_array());
            let positions = vertices.read(Semantic::Position, to_world)?;
            self.positions.extend(positions.unwrap_or_default());
        }
        let unit = |to_world: DMat3, n: DVec3| (to_world * n).normalize_or_zero().as_vec3().to_array();
        let normals = if vertices.is_moved() {
            vertices.sum(Semantic::Normal, |n: [f64; 3]| DVec3::from(n))?.map(|normals| match &mixes {
                Some(mixes) => {
                    normals.into_iter().zip(mixes).map(|(n, mix)| unit(for_normals(mix), n)).collect()
                }
                None => normals.into_iter().map(|n| unit(for_normals(&world), n)).collect(),
            })
        } else {
            let to_world = for_normals(&world);
            vertices.read(Semantic::Normal, |n: [f64; 3]| unit(to_world, DVec3::from(n)))?
        };
        drop(mixes);
        let has_normals = normals.is_some();
        if let Some(normals) = normals {
            self.normals.resize(first, [0.0; 3]);
            self.normals.extend::<Vec<_>>(normals);
        }

        let plain = reader.root.materials.len();
        let material = primitive.material.map_or(plain, |material| material.0);
        if material > plain || (material == plain && primitive.material.is_some()) {
            return Err(reader.invalid(
                Place::Entry("materials", material),
                "there is none",
                "fix the primitive",
            ));
        }
        // The set that the material's texture is laid out by, and how it is laid.
        let texture = reader.root.materials.get(material).and_then(json::Material::texture);
        let map = texture.and_then(json::TextureInfo::transform).map_or(DAffine2::IDENTITY, |t| t.map());
        let uv = |uv: [f64; 2]| {
            let uv = map.transform_point2(DVec2::from(uv));
            // The format's origin is the upper left corner, ours the lower left.
            [uv.x as f32, (1.0 - uv.y) as f32]
        };
        let set = Semantic::TexCoord(texture.map_or(0, json::TextureInfo::set));
        let uvs = vertices.read(set, uv)?;
        let has_uvs = uvs.is_some();
        if let Some(uvs) = uvs {
            self.uvs.resize(first, [0.0; 2]);
            self.uvs.extend(uvs);
        }

        let colours = match primitive.attributes.get(Semantic::Colour).map(|accessor| reader.width(accessor))
        {
            None => None,
            Some(3) => vertices.read(Semantic::Colour, |[r, g, b]: [f64; 3]| srgb([r, g, b, 1.0]))?,
            Some(_) => vertices.read(Semantic::Colour, srgb)?,
        };
        let has_colours = colours.is_some();
        if let Some(colours) = colours {
            self.colours.resize(first, [0; 4]);
            self.colours.extend(colours);
        }

        let (corners, mode) = match (&unpacked, primitive.indices) {
            (Some(mesh), _) => {
                self.spend(mesh.triangles().count() as u64 * 12)?;
                (mesh.triangles().flatten().collect(), Mode::Triangles)
            }
            (None, Some(indices)) => {
                self.spend(reader.count(indices.0)?.saturating_mul(4))?;
                (reader.read(indices.0, |[index]: [f64; 1]| index as u32)?, mode)
            }
            (None, None) => ((0..count as u32).collect::<Vec<u32>>(), mode),
        };
        let indices = primitive.indices.map(|indices| indices.0).filter(|_| unpacked.is_none());
        let restart =
            indices.filter(|_| mode != Mode::Triangles).and_then(|indices| reader.largest_index(indices));
        let bad = corners.iter().find(|&&corner| u64::from(corner) >= count && Some(corner) != restart);
        if let Some(bad) = bad {
            let what = format!("index {bad}, but the primitive has {count} vertices");
            let place = indices.map_or(drawn.place, |indices| Place::Entry("accessors", indices));
            return Err(reader.invalid(place, what, "export it again"));
        }
        if u32::try_from(first as u64 + count).is_err() {
            return Err(slimkd::MeshError::TooLarge(first).into());
        }
        match restart {
            Some(restart) => {
                for corners in corners.split(|&corner| corner == restart) {
                    self.triangles(corners, mode, first as u32, drawn)?;
                }
            }
            None => self.triangles(&corners, mode, first as u32, drawn)?,
        }
        self.material_ids.resize(self.triangles.len(), material as u32);
        self.runs.push(Run {
            end: self.triangles.len(),
            normals: has_normals,
            uvs: has_uvs,
            colours: has_colours,
        });
        Ok(())
    }

    fn triangles(
        &mut self,
        corners: &[u32],
        mode: Mode,
        first: u32,
        drawn: &Drawn<'_>,
    ) -> Result<(), LoadError> {
        let count = match mode {
            Mode::Triangles => corners.len() / 3,
            _ => corners.len().saturating_sub(2),
        };
        if mode == Mode::Triangles {
            self.ignored.corners += (corners.len() % 3) as u64;
        }
        self.spend(TRIANGLE * count as u64)?;
        // A mirrored triangle would face the other way (section 3.7.4), and so two of its corners change places.
        let mirrored = drawn.pose.is_none() && drawn.world.determinant() < 0.0;
        self.triangles.extend((0..count).map(|k| {
            let [a, b, c] = match mode {
                Mode::Triangles => [3 * k, 3 * k + 1, 3 * k + 2],
                // Every second triangle of a strip is turned, to face as its neighbours do.
                Mode::Strip => [k, k + 1 + k % 2, k + 2 - k % 2],
                Mode::Fan => [0, k + 1, k + 2],
            };
            let (b, c) = if mirrored { (c, b) } else { (b, c) };
            [corners[a] + first, corners[b] + first, corners[c] + first]
        }));
        Ok(())
    }

    pub(super) fn finish(self, mut scene: Scene) -> Result<Scene, LoadError> {
        let Ignored { primitives, lines, without_positions, corners } = self.ignored;
        for (count, what) in [(lines, "are points or lines"), (without_positions, "have no POSITION")] {
            if count > 0 {
                let what = format!("primitives {what} and were left out");
                let warning = Warning::counted(WarningKind::Ignored, count, primitives, what);
                warn(&mut scene.warnings, warning);
            }
        }
        if corners > 0 {
            let what = format!(
                "{corners} corners were left out: lists of triangles that are not a multiple of 3 long"
            );
            warn(&mut scene.warnings, Warning::new(WarningKind::Invalid, what));
        }
        let plain = (scene.materials.len() - 1) as u32;
        if !self.material_ids.contains(&plain) && plain > 0 {
            scene.materials.pop();
        }
        let vertices = self.positions.len();
        let runs = |has: fn(&Run) -> bool| self.runs.iter().map(move |run| (run.end, has(run)));
        scene.normals = attribute(self.normals, vertices, &self.triangles, runs(|run| run.normals));
        scene.uvs = attribute(self.uvs, vertices, &self.triangles, runs(|run| run.uvs));
        scene.colours = attribute(self.colours, vertices, &self.triangles, runs(|run| run.colours));
        if self.material_ids.iter().any(|&id| id > 0) {
            scene.material_ids = self.material_ids;
        }
        scene.mesh = Arc::new(TriangleMesh::new(self.positions, self.triangles)?);
        Ok(scene)
    }
}

/// A linear colour with its opacity as sRGB (IEC 61966-2-1) of 8 bits, which scenes keep.
fn srgb([r, g, b, a]: [f64; 4]) -> [u8; 4] {
    let byte = |value: f64| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    let curve = |x: f64| if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    [byte(curve(r)), byte(curve(g)), byte(curve(b)), byte(a)]
}

/// What normals become under a transform of points.
fn for_normals(world: &DMat4) -> DMat3 {
    let linear = DMat3::from_mat4(*world);
    if linear.determinant() == 0.0 { linear } else { linear.inverse().transpose() }
}

/// The vertices of a primitive that is drawn.
struct Vertices<'a> {
    reader: &'a Reader<'a>,
    drawn: &'a Drawn<'a>,
    unpacked: Option<&'a draco::Mesh>,
    count: u64,
}

impl Vertices<'_> {
    /// True when vertices are not simply what their accessor says, in another place.
    fn is_moved(&self) -> bool {
        self.drawn.pose.is_some() || self.targets().next().is_some()
    }

    /// The morph targets that have a weight.
    fn targets(&self) -> impl Iterator<Item = (&json::Attributes, f64)> {
        let targets = self.drawn.primitive.targets.iter().zip(self.drawn.weights.iter().copied());
        targets.filter(|(_, weight)| *weight != 0.0)
    }

    fn same_count(&self, accessor: usize) -> Result<usize, LoadError> {
        let (found, count) = (self.reader.count(accessor)?, self.count);
        let what = || format!("{found} entries for {count} vertices");
        let place = Place::Entry("accessors", accessor);
        if found == count { Ok(accessor) } else { Err(self.reader.invalid(place, what(), "export it again")) }
    }

    /// An attribute of all vertices, without morph targets.
    fn read<const N: usize, T>(
        &self,
        semantic: Semantic,
        each: impl Fn([f64; N]) -> T,
    ) -> Result<Option<Vec<T>>, LoadError> {
        let primitive = self.drawn.primitive;
        let Some(accessor) = primitive.attributes.get(semantic) else { return Ok(None) };
        let packed = primitive.extensions.draco.as_ref().and_then(|draco| draco.attributes.get(semantic));
        if let (Some(mesh), Some(id)) = (self.unpacked, packed) {
            let normalized =
                self.reader.root.accessors.get(accessor).is_some_and(|accessor| accessor.normalized);
            return mesh.read(self.reader, self.drawn.place, id, normalized, each).map(Some);
        }
        self.reader.read(self.same_count(accessor)?, each).map(Some)
    }

    /// The same with its morph targets.
    fn sum<const N: usize>(
        &self,
        semantic: Semantic,
        each: impl Fn([f64; N]) -> DVec3,
    ) -> Result<Option<Vec<DVec3>>, LoadError> {
        let Some(mut sum) = self.read(semantic, &each)? else { return Ok(None) };
        for (target, weight) in self.targets() {
            let Some(accessor) = target.get(semantic) else { continue };
            let delta = self.reader.read(self.same_count(accessor)?, &each)?;
            sum.iter_mut().zip(delta).for_each(|(sum, delta)| *sum += weight * delta);
        }
        Ok(Some(sum))
    }

    /// Each vertex' own transform by the joints that it follows; `None` when it names none.
    fn mixes(&self, pose: &Pose) -> Result<Option<Vec<DMat4>>, LoadError> {
        let mut mixes = vec![(DMat4::ZERO, 0.0); self.count as usize];
        for set in 0.. {
            let joints = self.read(Semantic::Joints(set), |joints: [f64; 4]| joints)?;
            let weights = self.read(Semantic::Weights(set), |weights: [f64; 4]| weights)?;
            let (Some(joints), Some(weights)) = (joints, weights) else { break };
            for ((mix, joints), weights) in mixes.iter_mut().zip(joints).zip(weights) {
                for (joint, weight) in joints.into_iter().zip(weights).filter(|(_, weight)| *weight != 0.0) {
                    let Some(matrix) = pose.joint(joint as usize) else {
                        let what = format!("a vertex follows joint {joint}, but its skin has fewer");
                        return Err(self.reader.invalid(self.drawn.place, what, "export it again"));
                    };
                    mix.0 += matrix * weight;
                    mix.1 += weight;
                }
            }
        }
        // Weights that were quantised do not quite sum up to 1; a vertex without any stays where it was modelled.
        let finish =
            |(sum, weight): (DMat4, f64)| if weight > 0.0 { sum * (1.0 / weight) } else { DMat4::IDENTITY };
        Ok(Some(mixes.into_iter().map(finish).collect()))
    }
}

/// Per-vertex values; with indices when some runs of triangles (each by its end) have none.
fn attribute<T: Copy + Default>(
    mut values: Vec<T>,
    vertices: usize,
    triangles: &[[u32; 3]],
    runs: impl Iterator<Item = (usize, bool)> + Clone,
) -> Option<Attribute<T>> {
    if values.is_empty() {
        return None;
    }
    values.resize(vertices, T::default());
    if runs.clone().all(|(_, has)| has) {
        return Some(Attribute { values, indices: None });
    }
    let mut indices = Vec::with_capacity(triangles.len());
    for (end, has) in runs {
        let run = &triangles[indices.len()..end];
        indices.extend(run.iter().map(|&corners| if has { corners } else { [u32::MAX; 3] }));
    }
    Some(Attribute { values, indices: Some(indices) })
}
