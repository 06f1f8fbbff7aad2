//! The surfaces of city objects as one mesh.

use super::json::{self, CityObject, Geometry, Lod, NONE, Root, Transform};
use crate::{
    Material, Scene, UpAxis, Warning, WarningKind,
    load::{
        Format, LoadError, LoadProgress, Place, error::quoted, polygon::triangulate, source::growth_limit,
        warn,
    },
};
use glam::{DMat4, DVec3, Vec3};
use slimkd::TriangleMesh;
use std::{
    collections::{BTreeMap, HashMap},
    sync::Arc,
};

/// Bytes that a vertex, a triangle and a surface take.
const VERTEX: u64 = 36;
const TRIANGLE: u64 = 16;
const SURFACE: u64 = 64;
/// Objects between two looks at the progress.
const BLOCK: usize = 256;
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
    progress: &'p LoadProgress,
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
    counts: Counts,
    resolution: f64,
}

/// Where the vertices of a geometry are, and what they became.
struct Vertices<'v> {
    places: &'v dyn Fn(usize) -> [f64; 3],
    /// Of each vertex its index in the mesh, or [`NONE`].
    indices: Vec<u32>,
    /// Triangles would face the other way.
    mirrored: bool,
}

impl<'p> City<'p> {
    pub(super) fn new(format: Format, input: usize, progress: &'p LoadProgress) -> Self {
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
            counts: Counts::default(),
            resolution: f64::INFINITY,
        }
    }

    fn invalid(&self, line: u64, what: String, fix: &'static str) -> LoadError {
        LoadError::Invalid { format: self.format, place: Place::Line(line), what, fix }
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
        let transform = transform.unwrap_or(Transform { scale: [1.0; 3], translate: [0.0; 3] });
        self.counts.textures += root.appearance.as_ref().map_or(0, |a| a.textures.len() as u64);
        let place = |vertex: usize| transform.apply(root.vertices[vertex]);
        let indices = vec![NONE; root.vertices.len()];
        let mut vertices = Vertices { places: &place, indices, mirrored: false };
        for (done, (name, object)) in root.objects.0.iter().enumerate() {
            if done.is_multiple_of(BLOCK) {
                self.progress.reach(0.0)?;
            }
            let wrong = |what: String| format!("object {}: {what}", quoted(name.as_bytes()));
            let geometries = object.geometry.as_deref().unwrap_or_default();
            let instance = |geometry: &&Geometry<'_>| geometry.kind == "GeometryInstance";
            let lod = |geometry: &Geometry<'_>| {
                let templates = shared.templates.as_ref();
                let template = geometry.template.and_then(|template| templates?.templates.get(template));
                template.filter(|_| instance(&geometry)).map_or(geometry.lod, |template| template.lod)
            };
            let surfaces =
                geometries.iter().filter(|geometry| instance(geometry) || depth(geometry).is_some());
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
                    self.instance(root, shared, object, geometry, &place)
                        .map_err(|error| error.told(|what| self.invalid(line, wrong(what), FIX)))?;
                } else {
                    self.surfaces(root, object, geometry, &mut vertices)
                        .map_err(|error| error.told(|what| self.invalid(line, wrong(what), FIX)))?;
                }
            }
        }
        Ok(())
    }

    /// Draws a template where an object stands.
    fn instance(
        &mut self,
        root: &Root<'_>,
        shared: &Root<'_>,
        object: &CityObject<'_>,
        geometry: &Geometry<'_>,
        place: &dyn Fn(usize) -> [f64; 3],
    ) -> Result<(), Fault> {
        let templates = shared.templates.as_ref();
        let found = templates.zip(geometry.template);
        let Some((templates, template)) = found.and_then(|(t, index)| Some((t, t.templates.get(index)?)))
        else {
            return Err(Fault::Wrong("an instance names no template that is there".to_owned()));
        };
        if depth(template).is_none() {
            self.counts.unknown += 1;
            return Ok(());
        }
        let at = match geometry.boundaries.values[..] {
            [at] if (at as usize) < root.vertices.len() => DVec3::from(place(at as usize)),
            _ => return Err(Fault::Wrong("an instance needs one vertex that is there".to_owned())),
        };
        let matrix = geometry.matrix.map_or(DMat4::IDENTITY, |m| DMat4::from_cols_array(&m).transpose());
        self.spend(VERTEX * templates.vertices.len() as u64 / 4)?;
        let moved = |vertex: usize| {
            (at + matrix.transform_point3(DVec3::from(templates.vertices[vertex]))).to_array()
        };
        let indices = vec![NONE; templates.vertices.len()];
        let mirrored = matrix.determinant() < 0.0;
        self.surfaces(shared, object, template, &mut Vertices { places: &moved, indices, mirrored })
    }

    /// Triangulates a geometry's surfaces.
    fn surfaces(
        &mut self,
        root: &Root<'_>,
        object: &CityObject<'_>,
        geometry: &Geometry<'_>,
        vertices: &mut Vertices<'_>,
    ) -> Result<(), Fault> {
        let (lists, depth) = (&geometry.boundaries, depth(geometry).unwrap_or(3));
        if lists.depth() == 0 {
            return Ok(());
        }
        if lists.depth() != depth {
            let what = format!("a {} has lists {} deep, not {depth}", geometry.kind, lists.depth());
            return Err(Fault::Wrong(what));
        }
        let count = lists.count(depth - 2);
        let material = Materials::of(root, object, geometry, count);
        let mut rings: Vec<Vec<[f64; 3]>> = Vec::new();
        let mut corners: Vec<u32> = Vec::new();
        for surface in 0..count {
            self.counts.surfaces += 1;
            rings.clear();
            corners.clear();
            let mut is_sliver = false;
            for ring in lists.range(depth - 2, surface) {
                let indices = &lists.values[lists.range(depth - 1, ring)];
                if indices.len() < 3 {
                    is_sliver = true;
                    if rings.is_empty() {
                        break;
                    }
                    continue;
                }
                let mut places = Vec::with_capacity(indices.len());
                for &index in indices {
                    let Some(known) = vertices.indices.get_mut(index as usize) else {
                        let count = vertices.indices.len();
                        return Err(Fault::Wrong(format!(
                            "a surface uses vertex {index}, but there are {count}"
                        )));
                    };
                    let place = (vertices.places)(index as usize);
                    if *known == NONE {
                        *known = u32::try_from(self.positions.len()).unwrap_or(NONE);
                        self.positions.push(place);
                        self.spent = self.spent.saturating_add(VERTEX);
                    }
                    places.push(place);
                    corners.push(*known);
                }
                rings.push(places);
            }
            self.counts.slivers += u64::from(is_sliver);
            if rings.is_empty() {
                continue;
            }
            let before = self.triangles.len();
            let turned = |[a, b, c]: [u32; 3]| if vertices.mirrored { [a, c, b] } else { [a, b, c] };
            if let [a, b, c] = corners[..] {
                self.triangles.push(turned([a, b, c]));
            } else {
                let found = triangulate(&rings);
                self.counts.doubtful += u64::from(found.is_doubtful);
                let whole = found.triangles.iter().map(|t| turned(t.map(|corner| corners[corner as usize])));
                self.triangles.extend(whole);
            }
            let material = self.material(&material, surface);
            self.material_ids.resize(self.triangles.len(), material);
            self.spend(SURFACE + TRIANGLE * (self.triangles.len() - before) as u64)?;
        }
        Ok(())
    }

    /// The index of a surface's material.
    fn material(&mut self, of: &Materials<'_>, surface: usize) -> u32 {
        let (key, material) = match (of.painted(surface), of.class(surface)) {
            (Some(painted), _) => {
                let colour = Vec3::from(painted.diffuse.unwrap_or([0.7; 3])).map(share);
                let emission =
                    painted.emissive.map_or(Vec3::ZERO, |emission| Vec3::from(emission).map(share));
                let transmission = painted.transparency.map_or(0.0, share);
                let key = format!("{} {colour} {emission} {transmission}", painted.name);
                let name = painted.name.clone().into_owned();
                let ior = if transmission > 0.0 { 1.0 } else { 1.5 };
                (key, Material { name, diffuse: colour, emission, transmission, ior, ..Default::default() })
            }
            (None, class) => {
                if let Some(&known) = self.known.get(class) {
                    return known;
                }
                let material =
                    Material { name: class.to_owned(), diffuse: colour(class), ..Default::default() };
                (class.to_owned(), material)
            }
        };
        let (materials, next) = (&mut self.materials, self.known.len() as u32);
        *self.known.entry(key).or_insert_with(|| {
            materials.push(material);
            next
        })
    }

    /// The model as a scene. This is the one place where coordinates become f32.
    pub(super) fn finish(self) -> Result<Scene, LoadError> {
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
        let what = "surfaces have rings of fewer than 3 corners, which were left out".to_owned();
        tell(WarningKind::Invalid, slivers, surfaces, what);
        let what = "surfaces cross themselves, and their triangles are a guess".to_owned();
        tell(WarningKind::Polygon, doubtful, surfaces, what);
        let far = self.positions.iter().flatten().fold(0.0f64, |far, x| far.max(x.abs())) as f32;
        let step = f64::from(far.next_up() - far);
        if step > self.resolution && step.is_finite() {
            let what = format!(
                "coordinates of {far} have steps of {step} in f32, beside {} in the file: subtract an origin",
                self.resolution
            );
            warn(&mut warnings, Warning::new(WarningKind::Precision, what));
        }
        let vertices = self.positions.into_iter().map(|position| position.map(|x| x as f32)).collect();
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

const FIX: &str = "the file is damaged: write it again, or check it by a validator of CityJSON";

/// Why a geometry was not read.
enum Fault {
    Wrong(String),
    Load(LoadError),
}

impl From<LoadError> for Fault {
    fn from(error: LoadError) -> Self {
        Self::Load(error)
    }
}

impl Fault {
    fn told(self, as_error: impl FnOnce(String) -> LoadError) -> LoadError {
        match self {
            Self::Wrong(what) => as_error(what),
            Self::Load(error) => error,
        }
    }
}

/// How many lists enclose an index, for geometries of surfaces.
fn depth(geometry: &Geometry<'_>) -> Option<usize> {
    match &*geometry.kind {
        "MultiSurface" | "CompositeSurface" => Some(3),
        "Solid" => Some(4),
        "MultiSolid" | "CompositeSolid" => Some(5),
        _ => None,
    }
}

/// What the surfaces of a geometry are made of.
struct Materials<'a> {
    list: &'a [json::Material<'a>],
    /// One for all, or one for each surface.
    all: Option<usize>,
    each: &'a [u32],
    classes: &'a [json::Surface<'a>],
    class_of: &'a [u32],
    object: &'a str,
}

impl<'a> Materials<'a> {
    fn of(
        root: &'a Root<'a>,
        object: &'a CityObject<'a>,
        geometry: &'a Geometry<'a>,
        surfaces: usize,
    ) -> Self {
        let theme = geometry.material.as_ref().and_then(|themes| themes.0.as_ref());
        let semantics = geometry.semantics.as_ref();
        // Lists of another length do not say which surface they mean.
        let fitting = |values: &'a [u32]| if values.len() == surfaces { values } else { &[] };
        Self {
            list: root.appearance.as_ref().map_or(&[], |appearance| &appearance.materials),
            all: theme.and_then(|theme| theme.value),
            each: theme.map_or(&[], |theme| fitting(&theme.values.values)),
            classes: semantics.map_or(&[], |semantics| &semantics.surfaces),
            class_of: semantics.map_or(&[], |semantics| fitting(&semantics.values.values)),
            object: &object.kind,
        }
    }

    fn painted(&self, surface: usize) -> Option<&json::Material<'a>> {
        let index = self.all.or_else(|| self.each.get(surface).map(|&index| index as usize))?;
        self.list.get(index)
    }

    fn class(&self, surface: usize) -> &str {
        let class = self.class_of.get(surface).and_then(|&class| self.classes.get(class as usize));
        class.map_or(self.object, |class| &class.kind)
    }
}

fn share(value: f32) -> f32 {
    if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
}

/// What a kind of surface or object looks like, roughly.
fn colour(class: &str) -> Vec3 {
    match class {
        "RoofSurface" => Vec3::new(0.5, 0.17, 0.12),
        "Window" | "Door" => Vec3::new(0.2, 0.25, 0.3),
        "WaterBody" | "WaterSurface" | "WaterGroundSurface" => Vec3::new(0.1, 0.25, 0.45),
        "PlantCover" | "SolitaryVegetationObject" => Vec3::new(0.1, 0.3, 0.08),
        "LandUse" | "TINRelief" | "GroundSurface" => Vec3::new(0.35, 0.32, 0.25),
        "Road" | "Railway" | "TransportSquare" | "TrafficArea" | "AuxiliaryTrafficArea" => Vec3::splat(0.25),
        _ => Vec3::splat(0.7),
    }
}
