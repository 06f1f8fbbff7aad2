//! The surfaces of city objects as one mesh.

use super::{
    json::{self, CityObject, Geometry, Lod, NONE, Root, Transform},
    surfaces::{Lists, Materials, colour, depth, share},
};
use crate::{
    Material, Scene, UpAxis, Warning, WarningKind,
    load::{
        Format, LoadError, Loading, Place, Progress, error::quoted, polygon::triangulate,
        source::growth_limit, warn,
    },
    origin::Frame,
};
use glam::{DMat4, DVec3, Vec3};
use slimkd::TriangleMesh;
use std::{
    collections::{BTreeMap, HashMap},
    rc::Rc,
    sync::Arc,
};

/// Bytes that a vertex, a triangle and a surface take.
const VERTEX: u64 = 36;
const TRIANGLE: u64 = 16;
const SURFACE: u64 = 64;
/// Objects between two looks at the progress.
const BLOCK: usize = 256;
/// Surfaces that are triangulated before their triangles go into the mesh.
const PART: usize = 4096;
/// How fine coordinates are that have no transform, units.
const RESOLUTION: f64 = 0.001;

/// What was met and left out, or guessed.
#[derive(Default)]
struct Counts {
    geometries: u64,
    lower: u64,
    lines: u64,
    unknown: u64,
    textures: u64,
    surfaces: u64,
    slivers: u64,
    doubtful: u64,
}

/// The model while it is read.
pub(super) struct City<'p> {
    format: Format,
    progress: &'p Progress,
    input: u64,
    spent: u64,
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    material_ids: Vec<u32>,
    materials: Vec<Material>,
    /// By name, and by what an appearance says beside it.
    known: HashMap<String, u32>,
    /// How many geometries of lower detail were left out, by their detail.
    left_out: BTreeMap<String, u64>,
    /// Templates as triangles.
    templates: HashMap<usize, Rc<Cut>>,
    counts: Counts,
    resolution: f64,
}

/// Triangles of a geometry by its own vertices, and their materials; [`NONE`] is the one of the object.
type Cut = Vec<([u32; 3], u32)>;

/// Where the vertices of a geometry are, and what they became.
struct Vertices<'v> {
    places: &'v dyn Fn(usize) -> [f64; 3],
    /// Of each vertex its index in the mesh, or [`NONE`].
    indices: Vec<u32>,
    /// Triangles would face the other way.
    mirrored: bool,
}

/// What the objects of one text have in common.
struct Text<'a, 'r> {
    /// The text with the templates.
    shared: &'a Root<'r>,
    line: u64,
    /// Its materials, once they are used.
    painted: Vec<u32>,
}

impl<'p> City<'p> {
    pub(super) fn new(format: Format, input: usize, progress: &'p Progress) -> Self {
        Self {
            format,
            progress,
            input: input as u64,
            spent: 0,
            positions: Vec::new(),
            triangles: Vec::new(),
            material_ids: Vec::new(),
            materials: Vec::new(),
            known: HashMap::new(),
            left_out: BTreeMap::new(),
            templates: HashMap::new(),
            counts: Counts::default(),
            resolution: f64::INFINITY,
        }
    }

    fn spend(&mut self, bytes: u64) -> Result<(), LoadError> {
        self.spent = self.spent.saturating_add(bytes);
        let (limit, input) = (growth_limit(self.input), self.input);
        if self.spent > limit {
            let (what, fix) = ("the instances of templates", "write them out");
            return Err(LoadError::OutOfProportion { what, limit, input, fix });
        }
        Ok(())
    }

    /// Adds the objects of `root`; `shared` has the transform and the templates. The text begins at that line.
    pub(super) fn add(&mut self, root: &Root<'_>, shared: &Root<'_>, line: u64) -> Result<(), LoadError> {
        let transform = shared.transform;
        let resolution = transform.map_or(RESOLUTION, |t| t.scale.into_iter().fold(f64::INFINITY, f64::min));
        if !root.vertices.is_empty() {
            self.resolution = self.resolution.min(resolution);
        }
        if std::ptr::eq(root, shared) {
            self.templates.clear();
        }
        let transform = transform.unwrap_or(Transform { scale: [1.0; 3], translate: [0.0; 3] });
        self.counts.textures += root.appearance.as_ref().map_or(0, |a| a.textures.len() as u64);
        let place = |vertex: usize| transform.apply(root.vertices[vertex]);
        let indices = vec![NONE; root.vertices.len()];
        let mut vertices = Vertices { places: &place, indices, mirrored: false };
        let mut text = Text { shared, line, painted: Vec::new() };
        for (done, (name, object)) in root.objects.0.iter().enumerate() {
            if done.is_multiple_of(BLOCK) {
                self.progress.reach(0.0)?;
            }
            self.object(root, object, &mut text, &mut vertices).map_err(|fault| match fault {
                Fault::Load(error) => error,
                Fault::Wrong(what) => LoadError::Invalid {
                    format: self.format,
                    place: Place::Line(text.line),
                    what: format!("object {}: {what}", quoted(name.as_bytes())),
                    fix: "the file is damaged: write it again, or check it by a validator of CityJSON",
                },
            })?;
        }
        Ok(())
    }

    fn object(
        &mut self,
        root: &Root<'_>,
        object: &CityObject<'_>,
        text: &mut Text<'_, '_>,
        vertices: &mut Vertices<'_>,
    ) -> Result<(), Fault> {
        let geometries = object.geometry.as_deref().unwrap_or_default();
        let instance = |geometry: &&Geometry<'_>| geometry.kind == "GeometryInstance";
        let shared = text.shared;
        let lod = |geometry: &Geometry<'_>| {
            let templates = shared.templates.as_ref();
            let template = geometry.template.and_then(|template| templates?.templates.get(template));
            template.filter(|_| instance(&geometry)).map_or(geometry.lod, |template| template.lod)
        };
        let surfaces = geometries.iter().filter(|geometry| instance(geometry) || depth(geometry).is_some());
        let highest = surfaces.map(lod).fold(Lod(f64::NEG_INFINITY), |a, b| if b > a { b } else { a });
        for geometry in geometries {
            self.counts.geometries += 1;
            if depth(geometry).is_none() && !instance(&geometry) {
                let is_line = matches!(&*geometry.kind, "MultiPoint" | "MultiLineString");
                let count = if is_line { &mut self.counts.lines } else { &mut self.counts.unknown };
                *count += 1;
            } else if lod(geometry) < highest {
                self.counts.lower += 1;
                if self.left_out.len() < 32 {
                    *self.left_out.entry(lod(geometry).0.to_string()).or_default() += 1;
                }
            } else if instance(&geometry) {
                self.instance(root, object, geometry, text, vertices.places)?;
            } else {
                let lists = Lists::of(geometry)?;
                let materials = Materials::of(root, geometry, lists.count);
                for start in (0..lists.count).step_by(PART) {
                    let part = start..(start + PART).min(lists.count);
                    let painted = &mut text.painted;
                    let count = root.vertices.len();
                    let cut = self.cut(&lists, part, &materials, painted, vertices.places, count)?;
                    self.draw(&cut, object, vertices)?;
                }
            }
        }
        Ok(())
    }

    /// Draws a template where an object stands.
    fn instance(
        &mut self,
        root: &Root<'_>,
        object: &CityObject<'_>,
        geometry: &Geometry<'_>,
        text: &Text<'_, '_>,
        place: &dyn Fn(usize) -> [f64; 3],
    ) -> Result<(), Fault> {
        let wrong = |what: &str| Fault::Wrong(what.to_owned());
        let found = text.shared.templates.as_ref().zip(geometry.template);
        let found = found.and_then(|(all, index)| Some((all, index, all.templates.get(index)?)));
        let (all, index, template) =
            found.ok_or_else(|| wrong("an instance names no template that is there"))?;
        if depth(template).is_none() {
            self.counts.unknown += 1;
            return Ok(());
        }
        let at = match geometry.boundaries.values[..] {
            [at] if (at as usize) < root.vertices.len() => DVec3::from(place(at as usize)),
            _ => return Err(wrong("an instance needs one vertex that is there")),
        };
        let matrix = geometry.matrix.map_or(DMat4::IDENTITY, |m| DMat4::from_cols_array(&m).transpose());
        let cut = match self.templates.get(&index) {
            Some(known) => Rc::clone(known),
            None => {
                let lists = Lists::of(template)?;
                let materials = Materials::of(text.shared, template, lists.count);
                let own = |vertex: usize| all.vertices[vertex];
                let (whole, count) = (0..lists.count, all.vertices.len());
                let cut = Rc::new(self.cut(&lists, whole, &materials, &mut Vec::new(), &own, count)?);
                self.templates.insert(index, Rc::clone(&cut));
                cut
            }
        };
        self.spend(SURFACE + all.vertices.len() as u64 * (VERTEX / 4))?;
        let moved =
            |vertex: usize| (at + matrix.transform_point3(DVec3::from(all.vertices[vertex]))).to_array();
        let indices = vec![NONE; all.vertices.len()];
        let mirrored = matrix.determinant() < 0.0;
        self.draw(&cut, object, &mut Vertices { places: &moved, indices, mirrored })
    }

    /// Triangulates some of a geometry's surfaces. `painted` are the materials of the appearance that were used before,
    /// `count` the number of vertices.
    fn cut(
        &mut self,
        lists: &Lists<'_>,
        surfaces: std::ops::Range<usize>,
        materials: &Materials<'_>,
        painted: &mut Vec<u32>,
        places: &dyn Fn(usize) -> [f64; 3],
        count: usize,
    ) -> Result<Cut, Fault> {
        let mut cut = Cut::new();
        let mut rings: Vec<Vec<[f64; 3]>> = Vec::new();
        let mut corners: Vec<u32> = Vec::new();
        let mut classes: HashMap<u32, u32> = HashMap::new();
        for surface in surfaces {
            self.counts.surfaces += 1;
            self.spend(SURFACE)?;
            rings.clear();
            corners.clear();
            let mut is_sliver = false;
            for ring in lists.rings(surface) {
                let indices = lists.ring(ring);
                if indices.len() < 3 {
                    is_sliver = true;
                    if rings.is_empty() {
                        break;
                    }
                    continue;
                }
                if let Some(bad) = indices.iter().find(|&&index| index as usize >= count) {
                    return Err(Fault::Wrong(format!("a surface uses vertex {bad}, but there are {count}")));
                }
                rings.push(indices.iter().map(|&index| places(index as usize)).collect());
                corners.extend_from_slice(indices);
            }
            self.counts.slivers += u64::from(is_sliver || rings.is_empty());
            if rings.is_empty() {
                continue;
            }
            let material = match (materials.painted(surface), materials.class(surface)) {
                (Some(index), _) => {
                    painted.resize(materials.list.len(), NONE);
                    if painted[index] == NONE {
                        painted[index] = self.painted(&materials.list[index]);
                    }
                    painted[index]
                }
                (None, Some(class)) => *classes
                    .entry(class)
                    .or_insert_with(|| self.named(&materials.classes[class as usize].kind)),
                (None, None) => NONE,
            };
            if let [a, b, c] = corners[..] {
                cut.push(([a, b, c], material));
            } else {
                let found = triangulate(&rings);
                self.counts.doubtful += u64::from(found.is_doubtful);
                let whole = found.triangles.iter().map(|t| (t.map(|k| corners[k as usize]), material));
                cut.extend(whole);
            }
        }
        Ok(cut)
    }

    /// Adds triangles to the mesh.
    fn draw(
        &mut self,
        cut: &[([u32; 3], u32)],
        object: &CityObject<'_>,
        vertices: &mut Vertices<'_>,
    ) -> Result<(), Fault> {
        self.spend(TRIANGLE * cut.len() as u64)?;
        let before = self.positions.len();
        let own = self.named(&object.kind);
        for &(corners, material) in cut {
            let [a, b, c] = corners.map(|corner| {
                let known = &mut vertices.indices[corner as usize];
                if *known == NONE {
                    *known = u32::try_from(self.positions.len()).unwrap_or(NONE);
                    self.positions.push((vertices.places)(corner as usize));
                }
                *known
            });
            self.triangles.push(if vertices.mirrored { [a, c, b] } else { [a, b, c] });
            self.material_ids.push(if material == NONE { own } else { material });
        }
        self.spend(VERTEX * (self.positions.len() - before) as u64)?;
        Ok(())
    }

    /// The index of the material for a kind of surface or object.
    fn named(&mut self, class: &str) -> u32 {
        if let Some(&known) = self.known.get(class) {
            return known;
        }
        let material = Material { name: class.to_owned(), diffuse: colour(class), ..Default::default() };
        self.added(class.to_owned(), material)
    }

    /// The index of the material that an appearance says.
    fn painted(&mut self, of: &json::Material<'_>) -> u32 {
        let diffuse = Vec3::from(of.diffuse.unwrap_or([0.7; 3])).map(share);
        let emission = of.emissive.map_or(Vec3::ZERO, |emission| Vec3::from(emission).map(share));
        let transmission = of.transparency.map_or(0.0, share);
        let key = format!("{} {diffuse} {emission} {transmission}", of.name);
        let name = of.name.clone().into_owned();
        let ior = if transmission > 0.0 { 1.0 } else { 1.5 };
        self.added(key, Material { name, diffuse, emission, transmission, ior, ..Default::default() })
    }

    fn added(&mut self, key: String, material: Material) -> u32 {
        let (materials, next) = (&mut self.materials, self.known.len() as u32);
        *self.known.entry(key).or_insert_with(|| {
            materials.push(material);
            next
        })
    }

    /// The model as a scene. This is the one place where coordinates become f32.
    pub(super) fn finish(self, frame: &Frame) -> Result<Scene, LoadError> {
        let mut warnings = Vec::new();
        let Counts { geometries, lower, lines, unknown, textures, surfaces, slivers, doubtful } = self.counts;
        let mut tell = |kind: WarningKind, count: u64, total: u64, what: String| {
            if count > 0 {
                warn(&mut warnings, Warning::counted(kind, count, total, what));
            }
        };
        let details: Vec<String> =
            self.left_out.iter().map(|(lod, count)| format!("{count} of LoD {lod}")).collect();
        let what = format!(
            "geometries have a lower level of detail than another of their object and were left out: {}",
            details.join(", ")
        );
        tell(WarningKind::Ignored, lower, geometries, what);
        let what = "geometries are points or lines and were left out".to_owned();
        tell(WarningKind::Ignored, lines, geometries, what);
        tell(
            WarningKind::Ignored,
            unknown,
            geometries,
            "geometries are of unknown types and were left out".to_owned(),
        );
        tell(WarningKind::Ignored, textures, textures, "textures were left out".to_owned());
        let what = "surfaces have no ring, or rings of fewer than 3 corners, which were left out".to_owned();
        tell(WarningKind::Invalid, slivers, surfaces, what);
        let what = "surfaces cross themselves, and their triangles are a guess".to_owned();
        tell(WarningKind::Polygon, doubtful, surfaces, what);
        let near = |p: &[f64; 3]| [0, 1, 2].map(|axis| frame.near(axis, p[axis]).abs());
        let far = self.positions.iter().flat_map(near).fold(0.0, f64::max) as f32;
        let step = f64::from(far.next_up() - far);
        if step > self.resolution && step.is_finite() {
            let what = format!(
                "coordinates of {far} have steps of {step} in f32, beside {} in the file: give it an origin",
                self.resolution
            );
            warn(&mut warnings, Warning::new(WarningKind::Precision, what));
        }
        let vertices = self.positions.into_iter().map(|position| frame.put(position)).collect();
        Ok(Scene {
            mesh: Arc::new(TriangleMesh::new(vertices, self.triangles)?),
            material_ids: if self.materials.len() > 1 { self.material_ids } else { Vec::new() },
            materials: self.materials,
            up: Some(UpAxis::Z),
            warnings,
            ..Default::default()
        })
    }
}

/// Why a geometry was not read.
pub(super) enum Fault {
    Wrong(String),
    Load(LoadError),
}

impl From<LoadError> for Fault {
    fn from(error: LoadError) -> Self {
        Self::Load(error)
    }
}
