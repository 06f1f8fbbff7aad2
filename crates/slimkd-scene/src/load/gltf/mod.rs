//! glTF 2.0, as JSON or GLB: the default scene, flattened in depth-first order of its nodes.
//!
//! The `gltf` crate gives the JSON types. Its `Document` and accessor readers are not used: they trust indices that
//! its validation reads out of bounds itself.

mod accessor;
mod container;
mod materials;
mod views;

use super::{
    Format, LoadError, LoadProgress, Place,
    error::quoted,
    source::{FREE_BYTES, Folder, MAX_GROWTH, growth_limit},
    textures::Textures,
    warn,
};
use crate::{Attribute, Scene, UpAxis, Warning, WarningKind};
use container::Buffers;
use glam::{DMat3, DMat4, DQuat, DVec3};
use gltf::json::{
    Root,
    mesh::{Mode, Primitive, Semantic},
    scene::Node,
    validation::Checked,
};
use slimkd::TriangleMesh;
use std::sync::Arc;

/// Extensions that do not change where triangles are: known, or nothing lost but looks.
const HARMLESS: [&str; 2] = ["KHR_lights_punctual", "KHR_mesh_quantization"];
/// Memory that a JSON object may become, bytes: the largest of `gltf`'s types, a material, has some 600.
const OBJECT: u64 = 640;
/// Least budget that drawing a primitive costs, bytes: many empty ones cost time.
const PRIMITIVE: u64 = 64;

/// The file while it is read.
struct Reader<'a> {
    format: Format,
    root: &'a Root,
    buffers: Buffers<'a>,
}

pub(super) fn parse(
    format: Format,
    bytes: &[u8],
    folder: Folder<'_>,
    progress: &LoadProgress,
) -> Result<Scene, LoadError> {
    let (json, bin) = container::split(format, bytes)?;
    let root = root(format, bytes, json)?;
    let buffers = Buffers::load(format, &root, bin, folder)?;
    let reader = Reader { format, root: &root, buffers };
    let mut scene = Scene { up: Some(UpAxis::Y), ..Default::default() };
    for name in &root.extensions_used {
        if !HARMLESS.contains(&name.as_str()) && !name.starts_with("KHR_materials_") {
            let name = quoted(name.as_bytes());
            let what = format!("extension {name} is not known; what it adds was left out");
            warn(&mut scene.warnings, Warning::new(WarningKind::Ignored, what));
        }
    }
    let mut textures = Textures::new(folder);
    scene.materials = reader.materials(&mut textures, &mut scene.warnings);
    scene.textures = textures.list;
    let mut flat = Flat::new(&reader, bytes.len() as u64 + reader.buffers.total());
    // Once to weigh, so that what is too much is refused before any of it takes memory.
    flat.walk(&mut Scene::default(), &LoadProgress::new(), Flat::weigh)?;
    flat.left = growth_limit(flat.input);
    flat.walk(&mut scene, progress, Flat::primitive)?;
    flat.finish(scene)
}

/// The JSON, with what it requires checked.
fn root(format: Format, bytes: &[u8], json: &[u8]) -> Result<Root, LoadError> {
    // Each object becomes a struct with all its optional members: "{}," must not become a gigabyte.
    let objects = json.iter().filter(|&&byte| byte == b'{').count() as u64;
    let limit = FREE_BYTES * 4 + MAX_GROWTH / 4 * bytes.len() as u64;
    if objects * OBJECT > limit {
        let (what, input) = ("the list of objects", bytes.len() as u64);
        return Err(LoadError::OutOfProportion { what, limit, input, fix: "join its meshes and nodes" });
    }
    let root = Root::from_slice(json).map_err(|error| LoadError::Invalid {
        format,
        place: Place::Line(error.line() as u64),
        what: error.to_string().split_whitespace().collect::<Vec<_>>().join(" "),
        fix: "the file was cut off or is no glTF 2.0",
    })?;
    if !root.asset.version.starts_with("2") {
        let what = format!("glTF version {}", quoted(root.asset.version.as_bytes()));
        let fix = "convert it to version 2";
        return Err(LoadError::Unsupported { format, place: Place::Whole, what, fix });
    }
    for (k, name) in root.extensions_required.iter().enumerate() {
        if !HARMLESS.contains(&name.as_str()) && !name.starts_with("KHR_materials_") {
            let what = format!("the required extension {}", quoted(name.as_bytes()));
            let place = Place::Entry("extensionsRequired", k);
            let fix = "export the file without it, uncompressed";
            return Err(LoadError::Unsupported { format, place, what, fix });
        }
    }
    Ok(root)
}

impl Reader<'_> {
    fn invalid(&self, place: Place, what: impl Into<String>, fix: &'static str) -> LoadError {
        LoadError::Invalid { format: self.format, place, what: what.into(), fix }
    }
}

/// The flattened scene.
struct Flat<'a> {
    reader: &'a Reader<'a>,
    /// Bytes that the mesh may still take.
    left: u64,
    input: u64,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
    material_ids: Vec<u32>,
    /// Runs of triangles, each by its end: with normals, with texture coordinates.
    runs: Vec<(usize, bool, bool)>,
    skinned: bool,
    lines: bool,
}

impl<'a> Flat<'a> {
    fn new(reader: &'a Reader<'a>, input: u64) -> Self {
        Self {
            reader,
            left: growth_limit(input),
            input,
            positions: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            triangles: Vec::new(),
            material_ids: Vec::new(),
            runs: Vec::new(),
            skinned: false,
            lines: false,
        }
    }

    /// Visits the default scene's nodes, parents before children, in the file's order, and each primitive of their meshes.
    fn walk(
        &mut self,
        scene: &mut Scene,
        progress: &LoadProgress,
        visit: fn(&mut Self, &Primitive, Place, &DMat4) -> Result<(), LoadError>,
    ) -> Result<(), LoadError> {
        let root = self.reader.root;
        let chosen = root.scene.map_or(0, |scene| scene.value());
        let mut stack: Vec<(usize, DMat4)> = Vec::new();
        match root.scenes.get(chosen) {
            Some(scene) => {
                stack.extend(scene.nodes.iter().rev().map(|node| (node.value(), DMat4::IDENTITY)));
            }
            None if root.scene.is_some() => {
                let place = Place::Entry("scenes", chosen);
                return Err(self.reader.invalid(place, "there is none", "fix \"scene\""));
            }
            // Without scenes the file is a library: all that has no parent.
            None => {
                let mut is_child = vec![false; root.nodes.len()];
                for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
                    if let Some(is_child) = is_child.get_mut(child.value()) {
                        *is_child = true;
                    }
                }
                let roots = (0..root.nodes.len()).rev().filter(|&node| !is_child[node]);
                stack.extend(roots.map(|node| (node, DMat4::IDENTITY)));
            }
        }
        let mut seen = vec![false; root.nodes.len()];
        let mut visited = 0;
        while let Some((index, parent)) = stack.pop() {
            progress.parsed(visited, root.nodes.len())?;
            visited += 1;
            let place = Place::Entry("nodes", index);
            let invalid = |what, fix| self.reader.invalid(place, what, fix);
            let node = root
                .nodes
                .get(index)
                .ok_or_else(|| invalid("there is none", "fix the list that names it"))?;
            if std::mem::replace(&mut seen[index], true) {
                return Err(invalid("it has two parents or is its own ancestor", "make the nodes a tree"));
            }
            let world = parent * transform(node);
            self.reader.view_of_node(node, &world, scene);
            if let Some(mesh) = node.mesh {
                let place = Place::Entry("meshes", mesh.value());
                let mesh = root.meshes.get(mesh.value());
                let mesh = mesh.ok_or_else(|| self.reader.invalid(place, "there is none", "fix the node"))?;
                self.skinned |= node.skin.is_some();
                for primitive in &mesh.primitives {
                    progress.reach(0.0)?;
                    visit(self, primitive, place, &world)?;
                }
            }
            stack.extend(node.children.iter().flatten().rev().map(|child| (child.value(), world)));
        }
        Ok(())
    }

    /// Takes from the budget what comes next.
    fn spend(&mut self, bytes: u64) -> Result<(), LoadError> {
        self.left = self.left.checked_sub(bytes).ok_or(LoadError::OutOfProportion {
            what: "the flattened instances",
            limit: growth_limit(self.input),
            input: self.input,
            fix: "split the scene",
        })?;
        Ok(())
    }

    /// Takes from the budget what [`Flat::primitive`] is sure to take; what else is wrong is left to that.
    fn weigh(&mut self, primitive: &Primitive, _: Place, _: &DMat4) -> Result<(), LoadError> {
        self.spend(PRIMITIVE)?;
        let count = |index: usize| self.reader.count(index).unwrap_or(0);
        let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
        let vertices = positions.map_or(0, |index| count(index.value()));
        let corners = primitive.indices.map_or(vertices, |index| count(index.value()));
        match primitive.mode {
            // As many triangles at least.
            Checked::Valid(Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) if vertices > 0 => {
                self.spend(vertices.saturating_mul(32))?;
                self.spend((corners / 3).saturating_mul(40))
            }
            _ => Ok(()),
        }
    }

    fn primitive(&mut self, primitive: &Primitive, place: Place, world: &DMat4) -> Result<(), LoadError> {
        let reader = self.reader;
        self.spend(PRIMITIVE)?;
        let mode = match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
            Checked::Valid(_) => {
                self.lines = true;
                return Ok(());
            }
            Checked::Invalid => {
                return Err(reader.invalid(place, "an unknown primitive mode", "export it again"));
            }
        };
        let accessor =
            |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|index| index.value());
        // Allowed by the format, for extensions to fill in.
        let Some(positions) = accessor(Semantic::Positions) else { return Ok(()) };
        let count = reader.count(positions)?;
        self.spend(count.saturating_mul(32))?; // position, normal, texture coordinates
        let first = self.positions.len();
        let to_world = |p: [f64; 3]| world.transform_point3(DVec3::from(p)).as_vec3().to_array();
        self.positions.extend(reader.read(positions, to_world)?);

        let same_count = |index: usize| {
            let found = reader.count(index)?;
            let what = || format!("{found} entries for {count} vertices");
            let wrong = || reader.invalid(Place::Entry("accessors", index), what(), "export it again");
            if found == count { Ok(index) } else { Err(wrong()) }
        };
        let has_normals = match accessor(Semantic::Normals) {
            Some(normals) => {
                let linear = DMat3::from_mat4(*world);
                let to_world =
                    if linear.determinant() == 0.0 { linear } else { linear.inverse().transpose() };
                self.normals.resize(first, [0.0; 3]);
                let normal =
                    |n: [f64; 3]| (to_world * DVec3::from(n)).normalize_or_zero().as_vec3().to_array();
                self.normals.extend(reader.read(same_count(normals)?, normal)?);
                true
            }
            None => false,
        };
        let material = primitive.material.map_or(reader.root.materials.len(), |material| material.value());
        if material > reader.root.materials.len() {
            return Err(reader.invalid(
                Place::Entry("materials", material),
                "there is none",
                "fix the primitive",
            ));
        }
        // The set that the material's texture is laid out by.
        let texture = reader.root.materials.get(material);
        let texture = texture.and_then(|source| source.pbr_metallic_roughness.base_color_texture.as_ref());
        let has_uvs = match accessor(Semantic::TexCoords(texture.map_or(0, |texture| texture.tex_coord))) {
            Some(uvs) => {
                self.uvs.resize(first, [0.0; 2]);
                // The format's origin is the upper left corner, ours the lower left.
                let uv = |[u, v]: [f64; 2]| [u as f32, (1.0 - v) as f32];
                self.uvs.extend(reader.read(same_count(uvs)?, uv)?);
                true
            }
            None => false,
        };

        let corners = match primitive.indices {
            Some(indices) => {
                self.spend(reader.count(indices.value())?.saturating_mul(4))?;
                reader.read(indices.value(), |[index]: [f64; 1]| index as u32)?
            }
            None => (0..count as u32).collect(),
        };
        if let Some(bad) = corners.iter().find(|&&corner| u64::from(corner) >= count) {
            let what = format!("index {bad}, but the primitive has {count} vertices");
            let index = primitive.indices.map_or(0, |indices| indices.value());
            return Err(reader.invalid(Place::Entry("accessors", index), what, "export it again"));
        }
        self.triangles(&corners, mode, first, material as u32)?;
        self.runs.push((self.triangles.len(), has_normals, has_uvs));
        Ok(())
    }

    fn triangles(
        &mut self,
        corners: &[u32],
        mode: Mode,
        first: usize,
        material: u32,
    ) -> Result<(), LoadError> {
        let count = match mode {
            Mode::Triangles => corners.len() / 3,
            _ => corners.len().saturating_sub(2),
        };
        self.spend(40 * count as u64)?; // the triangle, its material, and up to two index triples
        if u32::try_from(first + corners.len()).is_err() {
            return Err(slimkd::MeshError::TooLarge(first).into());
        }
        let first = first as u32;
        self.triangles.extend((0..count).map(|k| {
            let [a, b, c] = match mode {
                Mode::Triangles => [3 * k, 3 * k + 1, 3 * k + 2],
                // Every second triangle of a strip is turned, to face as its neighbours do.
                Mode::TriangleStrip => [k, k + 1 + k % 2, k + 2 - k % 2],
                _ => [0, k + 1, k + 2],
            };
            [corners[a] + first, corners[b] + first, corners[c] + first]
        }));
        self.material_ids.resize(self.triangles.len(), material);
        Ok(())
    }

    fn finish(self, mut scene: Scene) -> Result<Scene, LoadError> {
        if self.skinned {
            let what = "skins were left out: meshes stand as they were modelled";
            warn(&mut scene.warnings, Warning::new(WarningKind::Ignored, what));
        }
        if self.lines {
            let what = "points and lines were left out";
            warn(&mut scene.warnings, Warning::new(WarningKind::Ignored, what));
        }
        let plain = (scene.materials.len() - 1) as u32;
        if !self.material_ids.contains(&plain) && plain > 0 {
            scene.materials.pop();
        }
        scene.normals = attribute(
            self.normals,
            self.positions.len(),
            &self.triangles,
            self.runs.iter().map(|run| (run.0, run.1)),
        );
        scene.uvs = attribute(
            self.uvs,
            self.positions.len(),
            &self.triangles,
            self.runs.iter().map(|run| (run.0, run.2)),
        );
        if self.material_ids.iter().any(|&id| id > 0) {
            scene.material_ids = self.material_ids;
        }
        scene.mesh = Arc::new(TriangleMesh::new(self.positions, self.triangles)?);
        Ok(scene)
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

/// A node's own transform.
fn transform(node: &Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |rotation| {
        let quaternion = DQuat::from_array(rotation.0.map(f64::from));
        // Normalised in the file up to rounding; a zero one means nothing.
        if quaternion.length_squared() > 0.0 { quaternion.normalize() } else { DQuat::IDENTITY }
    });
    DMat4::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, vector),
        rotation,
        node.translation.map_or(DVec3::ZERO, vector),
    )
}
