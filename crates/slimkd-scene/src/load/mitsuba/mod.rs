//! Mitsuba's scenes in XML, of all versions: shapes in the order of the file, instances written out.
//!
//! Followed is the documentation, <https://mitsuba.readthedocs.io/en/stable/src/key_topics/scene_format.html>, and that of
//! version 0.6 for older files. Deviations:
//! 1. Spheres, cylinders and discs are polygons ([`shapes::AROUND`]).
//! 2. A mirrored shape keeps its outside, as in glTF.
//! 3. A parameter without a value is an error only where something is read from it.

mod materials;
mod properties;
pub(super) mod serialized;
mod shapes;
mod views;
mod xml;

use super::{
    LoadError, Loading, Progress,
    error::{quoted, short},
    obj, ply,
    source::{Folder, growth_limit},
    textures::Textures,
    warn,
};
use crate::{
    Scene, Warning, WarningKind,
    merge::{Gather, Placement},
    origin::Frame,
};
use glam::{DMat4, DVec3};
use materials::Materials;
use std::{
    collections::{BTreeMap, HashMap},
    rc::Rc,
};
use xml::Document;

/// Bytes that a vertex and a triangle take with all that belongs to them, and a shape at least.
const VERTEX: u64 = 36;
const TRIANGLE: u64 = 52;
const SHAPE: u64 = 256;
const ELEMENT: u64 = 32;
/// Shapes within `merge` shapes.
const MAX_DEPTH: usize = 16;

pub(super) fn parse(
    bytes: &[u8],
    folder: Folder<'_>,
    frame: &Frame,
    progress: &Progress,
) -> Result<Scene, LoadError> {
    let document = Document::read(bytes, folder)?;
    let mut reader = Reader {
        input: document.input,
        materials: Materials::new(&document, Textures::new(folder)),
        document: &document,
        frame,
        progress,
        gathered: Gather::default(),
        material_ids: Vec::new(),
        spent: 0,
        files: HashMap::new(),
        uses: HashMap::new(),
        raw: HashMap::new(),
        weights: vec![0; document.elements.len()],
        counts: Counts::default(),
        scene: Scene::default(),
    };
    // Children come behind their parents.
    for (at, element) in document.elements.iter().enumerate().rev() {
        let within = element.children.iter().map(|&child| reader.weights[child as usize]);
        reader.weights[at] = within.fold(1u32, u32::saturating_add);
    }
    let mut open: Vec<u32> = document.top.clone();
    while let Some(element) = open.pop() {
        if let Some(file) = reader.file_of(element) {
            *reader.uses.entry(file).or_default() += 1;
        }
        open.extend(&document.at(element).children);
    }
    for (done, &element) in document.top.iter().enumerate() {
        progress.parsed(done, document.top.len())?;
        match &*document.at(element).tag {
            "shape" => reader.shape(element, DMat4::IDENTITY, 0)?,
            "emitter" | "luminaire" => reader.light(element)?,
            "sensor" | "camera" => reader.camera(element)?,
            _ => {}
        }
    }
    reader.finish()
}

/// What was met and left out, or replaced.
#[derive(Default)]
struct Counts {
    shapes: u64,
    round: u64,
    left_out: BTreeMap<String, u64>,
    lights: u64,
    lights_left_out: BTreeMap<String, u64>,
    cameras: u64,
    cameras_left_out: u64,
}

/// A file of a shape: its plugin, name and the index of the mesh in it.
type File = (String, String, usize);

struct Reader<'a> {
    document: &'a Document<'a>,
    frame: &'a Frame,
    progress: &'a Progress,
    gathered: Gather,
    material_ids: Vec<u32>,
    materials: Materials<'a>,
    /// Bytes of all files so far, and of what became of them.
    input: u64,
    spent: u64,
    /// Meshes that are used again, and how often files are used.
    files: HashMap<File, Rc<Scene>>,
    uses: HashMap<File, usize>,
    /// Files that hold several meshes, as they are.
    raw: HashMap<String, Rc<Vec<u8>>>,
    /// How many elements each element holds, itself among them: what drawing it costs in time.
    weights: Vec<u32>,
    counts: Counts,
    scene: Scene,
}

impl Reader<'_> {
    fn spend(&mut self, bytes: u64) -> Result<(), LoadError> {
        self.spent = self.spent.saturating_add(bytes);
        let limit = growth_limit(self.input);
        if self.spent > limit {
            let (what, fix) = ("the shapes and instances", "write the scene as PLY");
            return Err(LoadError::OutOfProportion { what, limit, input: self.input, fix });
        }
        Ok(())
    }

    /// The file that a shape is read from.
    fn file_of(&self, element: u32) -> Option<File> {
        let shape = self.document.at(element);
        if &*shape.tag != "shape" || !matches!(shape.plugin(), "ply" | "obj" | "serialized") {
            return None;
        }
        let name = self.document.text(element, "filename")?;
        let index = self.document.text(element, "shape_index").and_then(|index| index.trim().parse().ok());
        let index = index.filter(|_| shape.plugin() == "serialized").unwrap_or(0);
        Some((shape.plugin().to_owned(), name.to_owned(), index))
    }

    /// Draws a shape, or the shapes that it holds.
    fn shape(&mut self, element: u32, world: DMat4, depth: usize) -> Result<(), LoadError> {
        self.progress.reach(0.0)?;
        self.spend(SHAPE + ELEMENT * u64::from(self.weights[element as usize]))?;
        let (document, shape) = (self.document, self.document.at(element));
        let plugin = shape.plugin();
        let has_shapes = matches!(plugin, "merge" | "shapegroup");
        if has_shapes {
            // A group is drawn where an instance of it is.
            if plugin == "merge" && depth < MAX_DEPTH {
                self.children(element, world, depth)?;
            }
            return Ok(());
        }
        if plugin == "instance" {
            let world = world * document.transform(element, "to_world")?;
            let targets = document.children(element).filter_map(|(child, _)| document.resolve(child));
            let group = targets.into_iter().find(|&target| document.at(target).plugin() == "shapegroup");
            return match group {
                Some(group) if depth < MAX_DEPTH => self.children(group, world, depth),
                _ => {
                    let what = "an instance names no shapegroup";
                    Err(document.invalid(shape, what, "give the group an id, and the instance a <ref> to it"))
                }
            };
        }
        self.counts.shapes += 1;
        let world = world * document.transform(element, "to_world")?;
        let number = |name: &str, missing: f64| {
            Ok::<f64, LoadError>(document.number(element, name)?.unwrap_or(missing))
        };
        let point = |name: &str, missing: DVec3| {
            Ok::<DVec3, LoadError>(document.point(element, name)?.unwrap_or(missing))
        };
        self.counts.round += u64::from(matches!(plugin, "sphere" | "cylinder" | "disk"));
        let part = match plugin {
            "rectangle" => Rc::new(shapes::rectangle()?),
            "cube" => Rc::new(shapes::cube()?),
            "disk" => Rc::new(shapes::disc(&self.frame.around([0.0; 3]))?),
            "sphere" => {
                let centre = point("center", DVec3::ZERO)?;
                Rc::new(shapes::sphere(
                    centre,
                    number("radius", 1.0)?,
                    &self.frame.around(centre.to_array()),
                )?)
            }
            "cylinder" => {
                let (from, to) = (point("p0", DVec3::ZERO)?, point("p1", DVec3::Z)?);
                Rc::new(shapes::cylinder(
                    from,
                    to,
                    number("radius", 1.0)?,
                    &self.frame.around(from.to_array()),
                )?)
            }
            "ply" | "obj" | "serialized" => self.mesh(element, depth > 0)?,
            _ => {
                let left_out = &mut self.counts.left_out;
                if left_out.len() < 32 {
                    *left_out.entry(plugin.chars().take(40).collect()).or_default() += 1;
                }
                return Ok(());
            }
        };
        self.spend(VERTEX * part.mesh.vertices().len() as u64 + TRIANGLE * part.mesh.len() as u64)?;
        // Mitsuba's textures begin at their upper edge; only its OBJ loader turns the coordinates round.
        let from_above = !document.is(element, "flip_tex_coords", plugin == "obj");
        let placement = Placement::new(world, self.frame)
            .flipped(document.is(element, "flip_normals", false))
            .uvs_from_above(from_above)
            .faceted(document.is(element, "face_normals", false));
        self.gathered.append(&part, Some(&placement));
        let material = self.materials.of_shape(element)?;
        self.material_ids.resize(self.gathered.len(), material);
        Ok(())
    }

    fn children(&mut self, element: u32, world: DMat4, depth: usize) -> Result<(), LoadError> {
        let document = self.document;
        self.spend(ELEMENT * document.at(element).children.len() as u64)?;
        for (child, _) in document.children(element) {
            let Some(child) = document.resolve(child) else { continue };
            match (&*document.at(child).tag, document.at(child).plugin()) {
                // Instances within groups are not allowed, and could grow without end.
                ("shape", "instance" | "shapegroup") => {
                    self.counts.shapes += 1;
                    *self.counts.left_out.entry("instance within a group".to_owned()).or_default() += 1;
                }
                ("shape", _) => self.shape(child, world, depth + 1)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// The mesh of a shape that has a file; `again` says that the same shape may be drawn more than once.
    fn mesh(&mut self, element: u32, again: bool) -> Result<Rc<Scene>, LoadError> {
        let (document, shape) = (self.document, self.document.at(element));
        let Some(file) = self.file_of(element) else {
            return Err(document.invalid(
                shape,
                "a shape lacks its filename",
                "add <string name=\"filename\" …/>",
            ));
        };
        let uses = self.uses.get_mut(&file).map_or(0, |uses| {
            *uses = uses.saturating_sub(1);
            *uses
        });
        if let Some(known) = self.files.get(&file) {
            return Ok(Rc::clone(known));
        }
        let (plugin, name, index) = &file;
        let wrong = |why: &dyn std::fmt::Display| {
            let what = format!("shape file {}: {}", quoted(name.as_bytes()), short(why));
            document.invalid(shape, what, "every shape needs its file, beside the scene's or below it")
        };
        let bytes = match self.raw.get(name) {
            Some(known) => Rc::clone(known),
            None => {
                let bytes = Rc::new(document.bytes(name).map_err(|why| wrong(&why))?);
                self.input += bytes.len() as u64;
                if plugin == "serialized" {
                    self.raw.insert(name.clone(), Rc::clone(&bytes));
                }
                bytes
            }
        };
        let parsed = self.frame.part(|frame| match plugin.as_str() {
            "ply" => ply::parse(&bytes, frame, self.progress),
            "obj" => obj::parse(&bytes, Folder::NONE, frame, self.progress),
            _ => serialized::part(&bytes, *index, frame, self.progress),
        });
        let mut part = parsed.map_err(|error| match error {
            LoadError::Cancelled => error,
            other => wrong(&other),
        })?;
        // Materials are the scene's: those of an OBJ's own are not asked for.
        let own = std::mem::take(&mut part.warnings);
        for warning in own.into_iter().filter(|warning| warning.kind != WarningKind::Missing) {
            let text = format!("shape file {}: {warning}", quoted(name.as_bytes()));
            warn(&mut self.scene.warnings, Warning::new(warning.kind, text));
        }
        let part = Rc::new(part);
        if uses > 0 || again {
            self.spend(VERTEX * part.mesh.vertices().len() as u64 + TRIANGLE * part.mesh.len() as u64)?;
            self.files.insert(file, Rc::clone(&part));
        }
        Ok(part)
    }

    fn finish(mut self) -> Result<Scene, LoadError> {
        let mut scene = self.scene;
        let Counts { shapes, round, left_out, lights, lights_left_out, cameras, cameras_left_out } =
            self.counts;
        let mut tell = |count: u64, total: u64, what: String| {
            if count > 0 {
                warn(&mut scene.warnings, Warning::counted(WarningKind::Ignored, count, total, what));
            }
        };
        for (plugin, count) in left_out {
            tell(count, shapes, format!("shapes are of type {plugin:?} and were left out"));
        }
        for (plugin, count) in lights_left_out {
            tell(count, lights, format!("emitters are of type {plugin:?} and were left out"));
        }
        tell(cameras_left_out, cameras, "sensors have no perspective and were left out".to_owned());
        let around = shapes::AROUND;
        tell(
            round,
            shapes,
            format!("shapes are spheres, cylinders or discs, drawn with {around} corners around"),
        );
        self.materials.warn(&mut scene.warnings);
        let Scene { mesh, normals, uvs, colours, face_colours, .. } = self.gathered.finish()?;
        let material_ids = if self.materials.list.len() > 1 { self.material_ids } else { Vec::new() };
        Ok(Scene {
            mesh,
            normals,
            uvs,
            colours,
            face_colours,
            material_ids,
            materials: self.materials.list,
            textures: self.materials.textures.list,
            ..scene
        })
    }
}
