//! What shading reads, as words behind the tree's and the mesh's; and what a picture's kernel knows beside them.

use crate::image::{Image, put};
use bytemuck::cast_slice;
use glam::{DVec3, Vec3};
use slimkd_render::{RenderSettings, Setup};
use slimkd_scene::{Attribute, Light, Material, Scene};

/// No such thing.
const NONE: u32 = u32::MAX;

/// What the picture's kernel knows; a uniform buffer. Addresses count words of the image. Vectors of the camera are sums of two
/// floats, the second being the rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
#[allow(missing_docs)] // the names are those of the shaders
pub struct Frame {
    pub eye: [f32; 4],
    pub forward: [f32; 4],
    pub forward_rest: [f32; 4],
    pub right: [f32; 4],
    pub right_rest: [f32; 4],
    pub above: [f32; 4],
    pub above_rest: [f32; 4],
    /// Its fourth is how far ambient occlusion reaches.
    pub up: [f32; 4],
    /// Its fourth is the ambient light's factor.
    pub zenith: [f32; 4],
    /// Its fourth is the least contribution of a ray.
    pub horizon: [f32; 4],
    pub ground: [f32; 4],
    pub width: u32,
    pub height: u32,
    pub samples: u32,
    pub max_depth: u32,
    pub first_sample: u32,
    pub sample_count: u32,
    pub occlusion: u32,
    pub transparent: u32,
    pub tile_x: u32,
    pub tile_y: u32,
    pub tile_width: u32,
    pub tile_height: u32,
    pub light_count: u32,
    pub materials: u32,
    pub material_ids: u32,
    pub material_id_count: u32,
    pub normals: u32,
    pub normal_indices: u32,
    pub normal_count: u32,
    pub uvs: u32,
    pub uv_indices: u32,
    pub uv_count: u32,
    pub textures: u32,
    pub spare: u32,
}

/// As `frame` in the shaders.
pub(crate) const FRAME_WGSL: &str = "
struct Frame {
    eye: vec4<f32>, forward: vec4<f32>, forward_rest: vec4<f32>, right: vec4<f32>, right_rest: vec4<f32>,
    above: vec4<f32>, above_rest: vec4<f32>,
    up: vec4<f32>, zenith: vec4<f32>, horizon: vec4<f32>, ground: vec4<f32>,
    width: u32, height: u32, samples: u32, max_depth: u32,
    first_sample: u32, sample_count: u32, occlusion: u32, transparent: u32,
    tile_x: u32, tile_y: u32, tile_width: u32, tile_height: u32,
    light_count: u32, materials: u32, material_ids: u32, material_id_count: u32,
    normals: u32, normal_indices: u32, normal_count: u32, uvs: u32,
    uv_indices: u32, uv_count: u32, textures: u32, spare: u32,
}
";

fn wide(v: Vec3, w: f32) -> [f32; 4] {
    v.extend(w).to_array()
}

/// A sum of two floats, 48 bits of each component.
fn two(v: DVec3) -> [[f32; 4]; 2] {
    let high = v.as_vec3();
    [wide(high, 0.0), wide((v - high.as_dvec3()).as_vec3(), 0.0)]
}

impl Frame {
    /// Appends what shading reads to the image, and says where; `None` beyond 2³² words.
    pub fn append(image: &mut Image, scene: &Scene) -> Option<Self> {
        let words = &mut image.words;
        let mut frame = Self { normals: NONE, normal_indices: NONE, ..Self::default() };
        (frame.uvs, frame.uv_indices) = (NONE, NONE);
        let fallback = [Material::default()];
        let materials = if scene.materials.is_empty() { &fallback[..] } else { &scene.materials };
        let records: Vec<[u32; 16]> = materials.iter().map(material).collect();
        frame.materials = put(words, cast_slice(&records))?;
        if !scene.materials.is_empty() {
            frame.material_ids = put(words, cast_slice(&scene.material_ids))?;
            frame.material_id_count = scene.material_ids.len() as u32;
        }
        if let Some(normals) = &scene.normals {
            frame.normal_count = normals.values.len() as u32;
            (frame.normals, frame.normal_indices) = attribute(words, normals)?;
        }
        if let Some(uvs) = &scene.uvs {
            frame.uv_count = uvs.values.len() as u32;
            (frame.uvs, frame.uv_indices) = attribute(words, uvs)?;
        }
        // A record a texture (where its texels are from here, width, height), then all texels.
        let mut records = vec![[0; 4]; scene.textures.len()];
        let mut texels = 4 * records.len() as u64;
        for (record, texture) in records.iter_mut().zip(&scene.textures) {
            *record = [u32::try_from(texels).ok()?, texture.width, texture.height, 0];
            texels += 3 * texture.texels.len() as u64;
        }
        frame.textures = put(words, cast_slice(&records))?;
        for texture in &scene.textures {
            put(words, cast_slice(&texture.texels))?;
        }
        Some(frame)
    }

    /// The same of one picture, with its lights, eight words each: whether it shines from afar, its place or the way to it, its
    /// strength. Those without a direction add nothing and are left out.
    pub fn of_picture(self, setup: &Setup<'_>, settings: &RenderSettings) -> (Self, Vec<[f32; 8]>) {
        let [forward, right, above] = setup.frame.axes().map(two);
        let sky = settings.sky;
        let lights: Vec<_> = setup.lights.iter().filter_map(light).collect();
        let frame = Self {
            eye: wide(setup.frame.eye(), 0.0),
            forward: forward[0],
            forward_rest: forward[1],
            right: right[0],
            right_rest: right[1],
            above: above[0],
            above_rest: above[1],
            up: wide(setup.up, setup.occlusion_reach),
            zenith: wide(sky.zenith, sky.ambient),
            horizon: wide(sky.horizon, settings.min_contribution),
            ground: wide(sky.ground, 0.0),
            width: settings.width,
            height: settings.height,
            samples: settings.samples,
            max_depth: settings.max_depth,
            occlusion: settings.occlusion,
            transparent: u32::from(setup.transparent),
            light_count: lights.len() as u32,
            ..self
        };
        (frame, lights)
    }
}

/// Its values and its corners' indices, if it has own ones.
fn attribute<T: bytemuck::NoUninit>(words: &mut Vec<u32>, attribute: &Attribute<T>) -> Option<(u32, u32)> {
    let values = put(words, cast_slice(&attribute.values))?;
    let indices = match &attribute.indices {
        Some(indices) => put(words, cast_slice(indices))?,
        None => NONE,
    };
    Some((values, indices))
}

/// As `shaders/shade.wgsl` reads it, with all that does not depend on the ray worked out.
fn material(material: &Material) -> [u32; 16] {
    let reflection = material.reflection.clamp(0.0, 1.0);
    let transmission = (1.0 - reflection) * material.transmission.clamp(0.0, 1.0);
    let ior = if material.ior.is_finite() && material.ior > 0.0 { material.ior } else { 1.0 };
    let [dr, dg, db] = material.diffuse.to_array().map(f32::to_bits);
    let [sr, sg, sb] = material.specular.to_array().map(f32::to_bits);
    let [er, eg, eb] = material.emission.to_array().map(f32::to_bits);
    let shininess = material.shininess.max(1.0).to_bits();
    let shares = [reflection, transmission, 1.0 - reflection - transmission].map(f32::to_bits);
    let texture = material.texture.unwrap_or(NONE);
    let [mirrored, through, opaque] = shares;
    [dr, dg, db, texture, sr, sg, sb, shininess, er, eg, eb, ior.to_bits(), mirrored, through, opaque, 0]
}

/// As `shaders/shade.wgsl` reads it.
fn light(light: &Light) -> Option<[f32; 8]> {
    let (kind, place, strength) = match *light {
        Light::Point { position, intensity } => (0.0, position, intensity),
        Light::Directional { direction, irradiance } => (1.0, (-direction).try_normalize()?, irradiance),
    };
    let ([x, y, z], [r, g, b]) = (place.to_array(), strength.to_array());
    Some([kind, x, y, z, r, g, b, 0.0])
}
