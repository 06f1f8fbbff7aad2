//! What a file's extensions change: <https://github.com/KhronosGroup/glTF/tree/main/extensions>.

/// How much of an extension is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Known {
    /// All that triangles and pictures need of it.
    Followed,
    /// It moves no triangle. What it adds to looks, sound, behaviour or data is left out.
    Harmless,
    /// Not known: it could change anything.
    Unknown,
}

/// Followed, as far as it says something of triangles, their colours, cameras or lights.
const FOLLOWED: [&str; 15] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_mesh_primitive_restart",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_transform",
    // Another way of saying where its triangles' edges are drawn.
    "CESIUM_primitive_outline",
    // The same triangles again, joined.
    "EXT_mesh_manifold",
];

/// They move no triangle.
const HARMLESS: [&str; 43] = [
    "ADOBE_materials_clearcoat_specular",
    "ADOBE_materials_clearcoat_tint",
    "ADOBE_materials_thin_transparency",
    "AGI_articulations",
    "AGI_stk_metadata",
    // Places the whole model on the globe; a warning of its own says where.
    "CESIUM_RTC",
    "EXT_instance_features",
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_materials_bump",
    "EXT_mesh_features",
    "EXT_mesh_primitive_edge_visibility",
    "EXT_property_animation",
    "EXT_structural_metadata",
    "EXT_texture_avif",
    "EXT_texture_procedurals",
    "EXT_texture_webp",
    "FB_geometry_metadata",
    "GODOT_single_root",
    "GRIFFEL_bim_data",
    "KHR_animation_pointer",
    "KHR_audio_emitter",
    "KHR_environment_map",
    "KHR_interactivity",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_physics_rigid_bodies",
    "KHR_techniques_webgl",
    "KHR_texture_basisu",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
    "MSFT_texture_dds",
    "NV_materials_mdl",
    "VRM",
    "VRMC_materials_hdr_emissiveMultiplier",
    "VRMC_materials_mtoon",
    "VRMC_node_constraint",
    "VRMC_springBone",
    "VRMC_springBone_extended_collider",
    "VRMC_vrm",
];

/// Families that say how surfaces look or how bodies behave.
const HARMLESS_FAMILIES: [&str; 3] = ["KHR_materials_", "EXT_materials_", "OMI_"];

pub(super) fn known(name: &str) -> Known {
    if FOLLOWED.contains(&name) {
        Known::Followed
    } else if HARMLESS.contains(&name) || HARMLESS_FAMILIES.iter().any(|family| name.starts_with(family)) {
        Known::Harmless
    } else {
        Known::Unknown
    }
}
