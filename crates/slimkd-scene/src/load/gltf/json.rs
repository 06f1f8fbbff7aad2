//! glTF's JSON (glTF 2.0, section 5) as far as it is read. What is not named here, `extras` of any kind among it, is passed
//! over without a look.

use serde::{
    Deserialize, Deserializer,
    de::{Error, IgnoredAny, MapAccess, Visitor},
};
use std::fmt;

/// A count, an offset or an index. Exporters that keep all numbers as floats write `3.0`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Whole(pub(super) usize);

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Numbers;
        impl Visitor<'_> for Numbers {
            type Value = Whole;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number from 0 on")
            }
            fn visit_u64<E: Error>(self, value: u64) -> Result<Whole, E> {
                usize::try_from(value).map(Whole).map_err(|_| E::custom("a number beyond all files"))
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Whole, E> {
                // Beyond 2⁵³ a float is no count any more.
                if value >= 0.0 && value.fract() == 0.0 && value < 9e15 {
                    self.visit_u64(value as u64)
                } else {
                    Err(E::invalid_value(serde::de::Unexpected::Float(value), &self))
                }
            }
        }
        deserializer.deserialize_any(Numbers)
    }
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Root {
    pub(super) asset: Asset,
    pub(super) scene: Option<Whole>,
    pub(super) scenes: Vec<Nodes>,
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) skins: Vec<Skin>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffer_views: Vec<BufferView>,
    pub(super) buffers: Vec<Buffer>,
    pub(super) materials: Vec<Material>,
    pub(super) textures: Vec<Texture>,
    pub(super) images: Vec<Image>,
    pub(super) cameras: Vec<Camera>,
    /// Only their number is of interest.
    pub(super) animations: Vec<IgnoredAny>,
    pub(super) extensions_used: Vec<String>,
    pub(super) extensions_required: Vec<String>,
    pub(super) extensions: RootExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Asset {
    pub(super) version: String,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct RootExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) lights: Lights,
    #[serde(rename = "CESIUM_RTC")]
    pub(super) centre: Option<Centre>,
}

#[derive(Deserialize)]
pub(super) struct Centre {
    pub(super) center: [f64; 3],
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Lights {
    pub(super) lights: Vec<Light>,
}

#[derive(Deserialize)]
pub(super) struct Light {
    #[serde(rename = "type", default)]
    pub(super) kind: String,
    #[serde(default = "ones")]
    pub(super) color: [f32; 3],
    #[serde(default = "one")]
    pub(super) intensity: f32,
}

/// An entry of `scenes`.
#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Nodes {
    pub(super) nodes: Vec<Whole>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Node {
    pub(super) children: Vec<Whole>,
    pub(super) mesh: Option<Whole>,
    pub(super) skin: Option<Whole>,
    pub(super) camera: Option<Whole>,
    pub(super) matrix: Option<[f64; 16]>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    pub(super) weights: Option<Vec<f64>>,
    pub(super) extensions: Option<Box<NodeExtensions>>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) light: Option<LightOfNode>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instances: Option<Instances>,
    #[serde(rename = "KHR_node_visibility")]
    pub(super) visibility: Option<Visibility>,
}

#[derive(Deserialize)]
pub(super) struct LightOfNode {
    pub(super) light: Whole,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Instances {
    pub(super) attributes: Attributes,
}

#[derive(Deserialize)]
pub(super) struct Visibility {
    #[serde(default = "yes")]
    pub(super) visible: bool,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Mesh {
    pub(super) primitives: Vec<Primitive>,
    pub(super) weights: Vec<f64>,
}

/// What an attribute is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Semantic {
    Position,
    Normal,
    TexCoord(usize),
    Colour,
    Joints(usize),
    Weights(usize),
    /// Of `EXT_mesh_gpu_instancing`.
    Translation,
    Rotation,
    Scale,
}

impl Semantic {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "POSITION" => Self::Position,
            "NORMAL" => Self::Normal,
            "COLOR_0" => Self::Colour,
            "TRANSLATION" => Self::Translation,
            "ROTATION" => Self::Rotation,
            "SCALE" => Self::Scale,
            _ => {
                let (name, set) = name.rsplit_once('_')?;
                let set = set.parse().ok()?;
                match name {
                    "TEXCOORD" => Self::TexCoord(set),
                    "JOINTS" => Self::Joints(set),
                    "WEIGHTS" => Self::Weights(set),
                    _ => return None,
                }
            }
        })
    }
}

/// Indices, of accessors mostly, by their semantics; those that are not read are left out.
#[derive(Default)]
pub(super) struct Attributes(Vec<(Semantic, usize)>);

impl Attributes {
    pub(super) fn get(&self, semantic: Semantic) -> Option<usize> {
        self.0.iter().find(|entry| entry.0 == semantic).map(|entry| entry.1)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (Semantic, usize)> {
        self.0.iter().copied()
    }
}

impl<'de> Deserialize<'de> for Attributes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries;
        impl<'de> Visitor<'de> for Entries {
            type Value = Attributes;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("attributes by their names")
            }
            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Attributes, M::Error> {
                let mut entries = Vec::new();
                while let Some(name) = map.next_key::<std::borrow::Cow<'de, str>>()? {
                    match Semantic::of(&name) {
                        Some(semantic) => entries.push((semantic, map.next_value::<Whole>()?.0)),
                        None => drop(map.next_value::<IgnoredAny>()?),
                    }
                }
                Ok(Attributes(entries))
            }
        }
        deserializer.deserialize_map(Entries)
    }
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: Option<Whole>,
    pub(super) material: Option<Whole>,
    pub(super) mode: Option<Whole>,
    pub(super) targets: Vec<Attributes>,
    pub(super) extensions: PrimitiveExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub(super) draco: Option<Draco>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Draco {
    pub(super) buffer_view: Whole,
    /// Draco's own unique ids by semantics.
    #[serde(default)]
    pub(super) attributes: Attributes,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Skin {
    pub(super) inverse_bind_matrices: Option<Whole>,
    pub(super) joints: Vec<Whole>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<Whole>,
    #[serde(default)]
    pub(super) byte_offset: Whole,
    pub(super) component_type: Whole,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: Whole,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) sparse: Option<Box<Sparse>>,
}

#[derive(Deserialize)]
pub(super) struct Sparse {
    pub(super) count: Whole,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: Whole,
    #[serde(default)]
    pub(super) byte_offset: Whole,
    pub(super) component_type: Whole,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: Whole,
    #[serde(default)]
    pub(super) byte_offset: Whole,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: Whole,
    #[serde(default)]
    pub(super) byte_offset: Whole,
    pub(super) byte_length: Whole,
    pub(super) byte_stride: Option<Whole>,
    #[serde(default)]
    pub(super) extensions: ViewExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    ext: Option<Box<Meshopt>>,
    #[serde(rename = "KHR_meshopt_compression")]
    khr: Option<Box<Meshopt>>,
}

impl ViewExtensions {
    pub(super) fn meshopt(&self) -> Option<&Meshopt> {
        self.khr.as_deref().or(self.ext.as_deref())
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Meshopt {
    pub(super) buffer: Whole,
    #[serde(default)]
    pub(super) byte_offset: Whole,
    pub(super) byte_length: Whole,
    pub(super) byte_stride: Whole,
    pub(super) count: Whole,
    pub(super) mode: String,
    pub(super) filter: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    pub(super) byte_length: Whole,
    #[serde(default)]
    pub(super) extensions: BufferExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct BufferExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    ext: Fallback,
    #[serde(rename = "KHR_meshopt_compression")]
    khr: Fallback,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Fallback {
    fallback: bool,
}

impl BufferExtensions {
    /// True for a buffer that only readers without meshopt need.
    pub(super) fn is_fallback(&self) -> bool {
        self.ext.fallback || self.khr.fallback
    }
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) name: String,
    pub(super) pbr_metallic_roughness: Pbr,
    pub(super) emissive_factor: [f32; 3],
    pub(super) alpha_mode: String,
    pub(super) extensions: Option<Box<MaterialExtensions>>,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Pbr {
    pub(super) base_color_factor: [f32; 4],
    pub(super) base_color_texture: Option<TextureInfo>,
    pub(super) metallic_factor: f32,
    pub(super) roughness_factor: f32,
}

impl Default for Pbr {
    fn default() -> Self {
        let (metallic_factor, roughness_factor) = (1.0, 1.0);
        Self { base_color_factor: [1.0; 4], base_color_texture: None, metallic_factor, roughness_factor }
    }
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_transmission")]
    pub(super) transmission: Option<Transmission>,
    #[serde(rename = "KHR_materials_ior")]
    pub(super) ior: Option<Ior>,
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub(super) emission: Option<EmissiveStrength>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub(super) glossy: Option<SpecularGlossiness>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Transmission {
    pub(super) transmission_factor: f32,
}

#[derive(Deserialize)]
pub(super) struct Ior {
    #[serde(default = "glass")]
    pub(super) ior: f32,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct EmissiveStrength {
    #[serde(default = "one")]
    pub(super) emissive_strength: f32,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct SpecularGlossiness {
    pub(super) diffuse_factor: [f32; 4],
    pub(super) diffuse_texture: Option<TextureInfo>,
    pub(super) specular_factor: [f32; 3],
    pub(super) glossiness_factor: f32,
}

impl Default for SpecularGlossiness {
    fn default() -> Self {
        let (specular_factor, glossiness_factor) = ([1.0; 3], 1.0);
        Self { diffuse_factor: [1.0; 4], diffuse_texture: None, specular_factor, glossiness_factor }
    }
}

impl Material {
    pub(super) fn glossy(&self) -> Option<&SpecularGlossiness> {
        self.extensions.as_ref()?.glossy.as_ref()
    }

    /// The texture of the diffuse colour.
    pub(super) fn texture(&self) -> Option<&TextureInfo> {
        match self.glossy() {
            Some(glossy) => glossy.diffuse_texture.as_ref(),
            None => self.pbr_metallic_roughness.base_color_texture.as_ref(),
        }
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub(super) index: Whole,
    #[serde(default)]
    tex_coord: Whole,
    #[serde(default)]
    extensions: TextureInfoExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    transform: Option<TextureTransform>,
}

/// `KHR_texture_transform`: scaled, then turned, then moved.
#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct TextureTransform {
    pub(super) offset: [f64; 2],
    /// Radians.
    pub(super) rotation: f64,
    pub(super) scale: [f64; 2],
    tex_coord: Option<Whole>,
}

impl Default for TextureTransform {
    fn default() -> Self {
        Self { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None }
    }
}

impl TextureInfo {
    pub(super) fn transform(&self) -> Option<&TextureTransform> {
        self.extensions.transform.as_ref()
    }

    /// The set of texture coordinates.
    pub(super) fn set(&self) -> usize {
        self.transform().and_then(|transform| transform.tex_coord).unwrap_or(self.tex_coord).0
    }
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Texture {
    pub(super) source: Option<Whole>,
    pub(super) extensions: TextureExtensions,
}

/// The images of extensions that bring another encoding.
#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct TextureExtensions {
    #[serde(rename = "KHR_texture_basisu")]
    basisu: Option<Texture1>,
    #[serde(rename = "EXT_texture_webp")]
    webp: Option<Texture1>,
    #[serde(rename = "EXT_texture_avif")]
    avif: Option<Texture1>,
    #[serde(rename = "MSFT_texture_dds")]
    dds: Option<Texture1>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Texture1 {
    source: Option<Whole>,
}

impl Texture {
    /// The image: the plain one where there is one, else that of an extension.
    pub(super) fn image(&self) -> Option<usize> {
        let TextureExtensions { basisu, webp, avif, dds } = &self.extensions;
        let others = [basisu, webp, avif, dds].into_iter().flatten();
        self.source.or_else(|| others.filter_map(|texture| texture.source).next()).map(|image| image.0)
    }
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Image {
    pub(super) uri: Option<String>,
    pub(super) buffer_view: Option<Whole>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Camera {
    pub(super) perspective: Option<Perspective>,
}

#[derive(Deserialize)]
pub(super) struct Perspective {
    /// Vertical, radians.
    pub(super) yfov: f64,
}

fn one() -> f32 {
    1.0
}

fn ones() -> [f32; 3] {
    [1.0; 3]
}

fn glass() -> f32 {
    1.5
}

fn yes() -> bool {
    true
}
