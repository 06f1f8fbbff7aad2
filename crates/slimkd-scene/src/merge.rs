//! Several scenes as one.

use crate::{Attribute, Scene, Warning, WarningKind, origin::Frame, warning::warn};
use glam::{DMat3, DMat4, DVec3};
use slimkd::{Aabb, MeshError, TriangleMesh};
use std::sync::Arc;

/// A corner without that attribute.
const NONE: u32 = u32::MAX;
/// A scene whose vertices move by a larger share of its extent, on the way to the origin of others, is warned of.
const MOST_ROUNDING: f64 = 1.0 / 4096.0;

impl Scene {
    /// Puts scenes into one: triangles, vertices and materials of the first come first. Nothing is moved in the world or welded. The
    /// result has the first scene's name and its way up, and the first origin that is not 0. A scene that is so far from there that `f32`
    /// spoils it is warned of. Fails when there are more vertices or triangles than ids can name.
    ///
    /// ```
    /// use slimkd_scene::{Format, Scene, load_bytes};
    /// let one = load_bytes(Format::Obj, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")?;
    /// let both = Scene::merge(vec![one.clone(), one])?;
    /// assert_eq!(both.mesh.triangles(), [[0, 1, 2], [3, 4, 5]]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn merge(mut scenes: Vec<Self>) -> Result<Self, MeshError> {
        if scenes.len() < 2 {
            return Ok(scenes.pop().unwrap_or_default());
        }
        let origins = scenes.iter().map(|scene| scene.mesh.origin());
        let origin = origins.into_iter().find(|origin| *origin != [0.0; 3]).unwrap_or_default();
        let (mut gathered, mut spoiled) = (Gather::default(), Vec::new());
        let mut whole = Self {
            name: scenes[0].name.clone(),
            up: scenes.iter().find_map(|scene| scene.up),
            ..Self::default()
        };
        for mut scene in scenes {
            let before = scene.rounding;
            scene.move_to(origin)?;
            if scene.rounding - before > MOST_ROUNDING * extent(&scene.mesh) {
                let what =
                    "lies so far from the origin of the others that rounding moves its vertices by up to";
                spoiled.push(format!("{} {what} {:.1e}", scene.name, scene.rounding));
            }
            whole.rounding = whole.rounding.max(scene.rounding);
            let (materials, textures) = (whole.materials.len() as u32, whole.textures.len() as u32);
            gathered.append(&scene, None);
            whole.materials.extend(scene.materials.into_iter().map(|mut material| {
                material.texture = material.texture.map(|texture| texture + textures);
                material
            }));
            whole.textures.extend(scene.textures);
            whole.material_ids.extend(scene.material_ids.iter().map(|id| id + materials));
            whole.material_ids.resize(gathered.triangles.len(), materials);
            whole.cameras.extend(scene.cameras);
            whole.lights.extend(scene.lights);
            whole.warnings.extend(scene.warnings);
        }
        for what in spoiled {
            warn(&mut whole.warnings, Warning::new(WarningKind::Precision, what));
        }
        let Self { mesh, normals, uvs, colours, face_colours, .. } = gathered.finish()?;
        let mesh = Arc::new(Arc::unwrap_or_clone(mesh).with_origin(origin));
        Ok(Self { mesh, normals, uvs, colours, face_colours, ..whole })
    }
}

/// The longest side of the box of all vertices.
fn extent(mesh: &TriangleMesh) -> f64 {
    let vertices = mesh.vertices().iter().filter(|vertex| vertex.iter().all(|x| x.is_finite()));
    let mut bounds = Aabb::EMPTY;
    vertices.for_each(|&vertex| bounds.include(vertex));
    bounds.extent().into_iter().fold(0.0, f64::max)
}

/// Where a part is put, and how it is turned.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement<'f> {
    frame: &'f Frame,
    world: DMat4,
    for_normals: DMat3,
    /// Two corners change places: a mirrored triangle would face the other way.
    turned: bool,
    /// Normals point the other way.
    flipped: bool,
    /// Texture coordinates count from the upper edge.
    from_above: bool,
    /// The part's normals are left out.
    faceted: bool,
}

impl<'f> Placement<'f> {
    /// A placement by a transform to the world, and the frame that positions there go through.
    pub(crate) fn new(world: DMat4, frame: &'f Frame) -> Self {
        let linear = DMat3::from_mat4(world);
        let determinant = linear.determinant();
        let for_normals = if determinant == 0.0 { linear } else { linear.inverse().transpose() };
        let turned = determinant < 0.0;
        Self { frame, world, for_normals, turned, flipped: false, from_above: false, faceted: false }
    }

    /// Makes what is outside the inside.
    pub(crate) fn flipped(self, flipped: bool) -> Self {
        Self { turned: self.turned != flipped, flipped, ..self }
    }

    /// Turns texture coordinates round that count from the upper edge.
    pub(crate) fn uvs_from_above(self, from_above: bool) -> Self {
        Self { from_above, ..self }
    }

    /// Leaves the part's normals out.
    pub(crate) fn faceted(self, faceted: bool) -> Self {
        Self { faceted, ..self }
    }
}

/// Meshes and the attributes of their vertices while they are put together.
#[derive(Default)]
pub(crate) struct Gather {
    vertices: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    normals: Column<[f32; 3]>,
    uvs: Column<[f32; 2]>,
    colours: Column<[u8; 4]>,
    face_colours: Vec<[u8; 4]>,
}

impl Gather {
    /// How many triangles there are so far.
    pub(crate) fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Adds a part's triangles behind those that are there. Without a placement, its coordinates are those of the whole.
    pub(crate) fn append(&mut self, part: &Scene, placement: Option<&Placement<'_>>) {
        let (mesh, before) = (&part.mesh, self.triangles.len());
        let turned = placement.is_some_and(|placement| placement.turned);
        let at = Place {
            mesh,
            turned,
            // Where the sum is more than ids can name, `TriangleMesh::new` refuses it.
            vertices: u32::try_from(self.vertices.len()).unwrap_or(NONE),
            before: &self.triangles,
        };
        match placement {
            None => {
                self.normals.append(part.normals.as_ref(), &at, |normal| normal);
                self.uvs.append(part.uvs.as_ref(), &at, |uv| uv);
                self.vertices.extend_from_slice(mesh.vertices());
            }
            Some(&Placement { frame, world, for_normals, flipped, from_above, faceted, .. }) => {
                let sign = if flipped { -1.0 } else { 1.0 };
                let normal = |n: [f32; 3]| {
                    let n = for_normals * DVec3::from(n.map(f64::from));
                    (sign * n).normalize_or_zero().as_vec3().to_array()
                };
                self.normals.append(part.normals.as_ref().filter(|_| !faceted), &at, normal);
                let uv = |[u, v]: [f32; 2]| if from_above { [u, 1.0 - v] } else { [u, v] };
                self.uvs.append(part.uvs.as_ref(), &at, uv);
                let origin = DVec3::from(mesh.origin());
                self.vertices.extend(mesh.vertices().iter().map(|&p| {
                    let p = origin + DVec3::from(p.map(f64::from));
                    frame.put(world.transform_point3(p).to_array())
                }));
                let linear = DMat3::from_mat4(world);
                frame.carry(part.rounding * linear.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt());
            }
        }
        self.colours.append(part.colours.as_ref(), &at, |colour| colour);
        let offset = at.vertices;
        self.triangles.extend(mesh.triangles().iter().map(|&corners| turn(shift(corners, offset), turned)));
        if !part.face_colours.is_empty() {
            self.face_colours.resize(before, [255; 4]);
            self.face_colours.extend_from_slice(&part.face_colours);
        }
    }

    /// The whole as a scene without anything else.
    pub(crate) fn finish(mut self) -> Result<Scene, MeshError> {
        if !self.face_colours.is_empty() {
            self.face_colours.resize(self.triangles.len(), [255; 4]);
        }
        Ok(Scene {
            mesh: Arc::new(TriangleMesh::new(self.vertices, self.triangles)?),
            normals: self.normals.finish(),
            uvs: self.uvs.finish(),
            colours: self.colours.finish(),
            face_colours: self.face_colours,
            ..Scene::default()
        })
    }
}

/// What an attribute must know of the part that it belongs to.
struct Place<'a> {
    mesh: &'a TriangleMesh,
    turned: bool,
    vertices: u32,
    before: &'a [[u32; 3]],
}

/// An attribute while parts are put together; without indices of its own while it goes with the vertices.
#[derive(Default)]
struct Column<T> {
    values: Vec<T>,
    indices: Option<Vec<[u32; 3]>>,
    is_there: bool,
}

impl<T: Copy> Column<T> {
    fn append(&mut self, part: Option<&Attribute<T>>, at: &Place<'_>, each: impl Fn(T) -> T) {
        let (mesh, before) = (at.mesh, at.before);
        let Some(part) = part else {
            if self.is_there {
                let indices = self.indices.get_or_insert_with(|| before.to_vec());
                indices.resize(before.len() + mesh.len(), [NONE; 3]);
            }
            return;
        };
        let offset = u32::try_from(self.values.len()).unwrap_or(NONE);
        let goes_with_vertices = part.indices.is_none()
            && part.values.len() == mesh.vertices().len()
            && offset == at.vertices
            && self.indices.is_none()
            && (self.is_there || before.is_empty());
        if !goes_with_vertices {
            let is_there = self.is_there;
            let all = || if is_there { before.to_vec() } else { vec![[NONE; 3]; before.len()] };
            let indices = self.indices.get_or_insert_with(all);
            let own = part.indices.as_deref().unwrap_or(mesh.triangles());
            indices.extend(own.iter().map(|&corners| turn(shift(corners, offset), at.turned)));
        }
        self.is_there = true;
        self.values.extend(part.values.iter().map(|&value| each(value)));
    }

    fn finish(self) -> Option<Attribute<T>> {
        self.is_there.then_some(Attribute { values: self.values, indices: self.indices })
    }
}

fn shift(corners: [u32; 3], offset: u32) -> [u32; 3] {
    corners.map(|corner| corner.saturating_add(offset))
}

fn turn([a, b, c]: [u32; 3], turned: bool) -> [u32; 3] {
    if turned { [a, c, b] } else { [a, b, c] }
}
