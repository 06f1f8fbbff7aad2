//! Small scenes and single pixels, shared by the tests.
#![allow(missing_docs, unreachable_pub)] // tests
#![allow(dead_code)] // each test file uses its own part

use glam::Vec3;
use slimkd::{BuildOptions, KdTree, TriangleMesh};
use slimkd_render::{Film, RenderSettings, Sky, render};
use slimkd_scene::{Attribute, Camera, Light, Material, Scene};

/// Builds a scene part by part, a material each.
#[derive(Default)]
pub struct Parts {
    vertices: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<[f32; 3]>,
    ids: Vec<u32>,
    materials: Vec<Material>,
}

impl Parts {
    pub fn material(&mut self, material: Material) -> &mut Self {
        self.materials.push(material);
        self
    }

    /// A parallelogram; its front is where `a × b` points.
    pub fn quad(&mut self, corner: Vec3, a: Vec3, b: Vec3) -> &mut Self {
        let base = self.vertices.len() as u32;
        self.vertices.extend([corner, corner + a, corner + a + b, corner + b].map(|v| v.to_array()));
        self.normals.extend([a.cross(b).normalize().to_array(); 4]);
        self.push(&[[base, base + 1, base + 2], [base, base + 2, base + 3]])
    }

    /// A closed box, fronts outwards.
    pub fn cuboid(&mut self, min: Vec3, max: Vec3) -> &mut Self {
        let size = max - min;
        let (x, y, z) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
        self.quad(min, y, x).quad(min, z, y).quad(min, x, z);
        self.quad(max, -x, -y).quad(max, -y, -z).quad(max, -z, -x)
    }

    /// A sphere of latitude and longitude with smooth normals.
    pub fn sphere(&mut self, center: Vec3, radius: f32, rows: u32) -> &mut Self {
        let base = self.vertices.len() as u32;
        let columns = 2 * rows;
        for row in 0..=rows {
            let (ring, height) = (row as f32 / rows as f32 * std::f32::consts::PI).sin_cos();
            for column in 0..=columns {
                let (sin, cos) = (column as f32 / columns as f32 * std::f32::consts::TAU).sin_cos();
                let normal = Vec3::new(ring * cos, height, ring * sin);
                self.vertices.push((center + normal * radius).to_array());
                self.normals.push(normal.to_array());
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let a = base + row * (columns + 1) + column;
                let b = a + columns + 1;
                self.push(&[[a, a + 1, b], [a + 1, b + 1, b]]);
            }
        }
        self
    }

    fn push(&mut self, triangles: &[[u32; 3]]) -> &mut Self {
        self.triangles.extend(triangles);
        self.ids.extend(triangles.iter().map(|_| self.materials.len() as u32 - 1));
        self
    }

    /// With `smooth`, with vertex normals.
    pub fn scene(&mut self, smooth: bool) -> (Scene, KdTree) {
        let parts = std::mem::take(self);
        let mesh = TriangleMesh::new(parts.vertices, parts.triangles).unwrap();
        let scene = Scene {
            mesh: mesh.into(),
            materials: parts.materials,
            material_ids: parts.ids,
            normals: smooth.then_some(Attribute { values: parts.normals, indices: None }),
            ..Scene::default()
        };
        let tree = tree(&scene);
        (scene, tree)
    }
}

pub fn tree(scene: &Scene) -> KdTree {
    KdTree::build(scene.mesh.clone(), &BuildOptions::default()).unwrap()
}

pub fn diffuse(colour: Vec3) -> Material {
    Material { diffuse: colour, ..Material::default() }
}

pub fn emitter(emission: Vec3) -> Material {
    Material { diffuse: Vec3::ZERO, emission, ..Material::default() }
}

pub fn glass(ior: f32) -> Material {
    Material { diffuse: Vec3::ZERO, transmission: 1.0, ior, ..Material::default() }
}

/// A light that gives nothing, so that no default lights are chosen.
pub const DARK: Light = Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ZERO };

/// Black surroundings, one sample, no occlusion: what can be calculated by hand.
pub fn plain(width: u32, height: u32) -> RenderSettings {
    let mut settings = RenderSettings::sized(width, height);
    settings.samples = 1;
    settings.occlusion = 0;
    settings.min_contribution = 0.0;
    settings.sky = Sky { zenith: Vec3::ZERO, horizon: Vec3::ZERO, ground: Vec3::ZERO, ambient: 0.0 };
    settings
}

pub fn picture(
    (scene, tree): &(Scene, KdTree),
    camera: &Camera,
    lights: &[Light],
    settings: &RenderSettings,
) -> Film {
    render(scene, tree, camera, lights, settings, &slimkd::Progress::new()).unwrap()
}

/// What one ray from `eye` to `target` sees.
pub fn probe(scene: &(Scene, KdTree), eye: Vec3, target: Vec3, light: Light, depth: u32) -> Vec3 {
    let up = if (target - eye).cross(Vec3::Y).length() > 1e-3 { Vec3::Y } else { Vec3::X };
    let mut settings = plain(1, 1);
    settings.max_depth = depth;
    picture(scene, &Camera { eye, target, up, fov: 1.0 }, &[light], &settings).pixel(0, 0)
}

/// A mirror ball, a glass ball and a clay ball on a floor, under a lamp and a sun.
pub fn three_balls() -> ((Scene, KdTree), Camera, [Light; 2]) {
    let mut parts = Parts::default();
    parts.material(diffuse(Vec3::new(0.6, 0.55, 0.5)));
    parts.quad(Vec3::new(-6.0, 0.0, 6.0), Vec3::X * 12.0, Vec3::NEG_Z * 12.0);
    parts.material(Material { reflection: 0.85, ..diffuse(Vec3::splat(0.5)) });
    parts.sphere(Vec3::new(-1.6, 1.0, -0.6), 1.0, 24);
    parts.material(Material { specular: Vec3::splat(0.4), ..glass(1.5) });
    parts.sphere(Vec3::new(0.4, 0.8, 1.2), 0.8, 24);
    let clay = diffuse(Vec3::new(0.7, 0.25, 0.15));
    parts.material(Material { specular: Vec3::splat(0.3), shininess: 60.0, ..clay });
    parts.sphere(Vec3::new(1.9, 1.0, -0.8), 1.0, 24);
    let eye = Vec3::new(0.5, 2.4, 6.5);
    let camera = Camera { eye, target: Vec3::new(0.1, 0.8, 0.0), up: Vec3::Y, fov: 40.0 };
    let lights = [
        Light::Point { position: Vec3::new(-3.0, 5.0, 3.0), intensity: Vec3::splat(12.0) },
        Light::Directional { direction: Vec3::new(-0.5, -1.0, -0.4), irradiance: Vec3::new(0.5, 0.48, 0.42) },
    ];
    (parts.scene(true), camera, lights)
}
