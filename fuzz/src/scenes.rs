//! Scene files: one target for each parser, and one for all of them with their compressions.

use slimkd_scene::{
    Attribute, Compression, FileKind, Format, LoadOptions, Origin, Scene, load_bytes, load_bytes_with,
    write_ply,
};

/// Formats that [`scene`]'s first byte chooses from.
pub const FORMATS: [Format; 12] = [
    Format::Ply,
    Format::Obj,
    Format::Stl,
    Format::Gltf,
    Format::Glb,
    Format::Off,
    Format::AsciiGrid,
    Format::Npy,
    Format::Mitsuba,
    Format::Serialized,
    Format::CityJson,
    Format::CityJsonSeq,
];
/// Compressions that it chooses from, in steps of the formats.
pub const COMPRESSIONS: [Compression; 3] = [Compression::None, Compression::Zstd, Compression::Gzip];

/// Scene files: the first byte names the format, the rest is the file.
pub fn scene(data: &[u8]) {
    let Some((&kind, file)) = data.split_first() else { return };
    let kind = usize::from(kind) % (FORMATS.len() * COMPRESSIONS.len());
    let (format, compression) = (FORMATS[kind % FORMATS.len()], COMPRESSIONS[kind / FORMATS.len()]);
    load(FileKind { format, compression }, file);
}

/// PLY files.
pub fn ply(file: &[u8]) {
    load(Format::Ply.into(), file);
}

/// OBJ files.
pub fn obj(file: &[u8]) {
    load(Format::Obj.into(), file);
}

/// STL files.
pub fn stl(file: &[u8]) {
    load(Format::Stl.into(), file);
}

/// OFF files.
pub fn off(file: &[u8]) {
    load(Format::Off.into(), file);
}

/// glTF, as JSON after an even first byte, as GLB after an odd one.
pub fn gltf(data: &[u8]) {
    one_of([Format::Gltf, Format::Glb], data);
}

/// Scenes of Mitsuba after an even first byte, serialized meshes after an odd one.
pub fn mitsuba(data: &[u8]) {
    one_of([Format::Mitsuba, Format::Serialized], data);
}

/// City models after an even first byte, sequences of them after an odd one.
pub fn cityjson(data: &[u8]) {
    one_of([Format::CityJson, Format::CityJsonSeq], data);
}

/// Grids as text after an even first byte, arrays after an odd one.
pub fn grids(data: &[u8]) {
    one_of([Format::AsciiGrid, Format::Npy], data);
}

/// Streams of meshoptimizer: mode and filter, bytes of an element, and two bytes of their number, then the stream. It is the
/// buffer view of a primitive's positions or indices.
pub fn meshopt(data: &[u8]) {
    if let Some(file) = meshopt_file(data) {
        load(Format::Glb.into(), &file);
    }
}

/// The file that [`meshopt`] reads.
pub fn meshopt_file(data: &[u8]) -> Option<Vec<u8>> {
    let (&[kind, stride, low, high], stream) = data.split_first_chunk()?;
    let (stride, count) = (u32::from(stride), u32::from(u16::from_le_bytes([low, high])));
    let filter = ["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"][usize::from(kind >> 2) % 5];
    let mode = ["ATTRIBUTES", "TRIANGLES", "INDICES"][usize::from(kind & 3) % 3];
    let is_indices = mode != "ATTRIBUTES";
    // What is not compressed is all zeros.
    let (view, other) = if is_indices { (r#""bufferView":0,"#, "") } else { ("", r#""bufferView":0,"#) };
    let vertices = if is_indices { 65_535 } else { count };
    let corners = if is_indices { count } else { 3 };
    let component = if stride == 2 { 5123 } else { 5125 };
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsRequired":["EXT_meshopt_compression"],
        "buffers":[{{"byteLength":{0}}},{{"byteLength":{1},"extensions":{{"EXT_meshopt_compression":{{"fallback":true}}}}}}],
        "bufferViews":[{{"buffer":1,"byteLength":{1},"byteStride":{stride},"extensions":{{"EXT_meshopt_compression":{{"buffer":0,
        "byteLength":{0},"byteStride":{stride},"count":{count},"mode":"{mode}","filter":"{filter}"}}}}}}],
        "accessors":[{{{other}"componentType":{2},"count":{vertices},"type":"VEC3"}},
        {{{view}"componentType":{component},"count":{corners},"type":"SCALAR"}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"nodes":[{{"mesh":0}}],
        "scenes":[{{"nodes":[0]}}],"scene":0}}"#,
        stream.len(),
        stride * count,
        if stride == 12 { 5126 } else { 5120 },
    );
    Some(glb(&json, stream))
}

/// Streams of Draco, as a primitive of four vertices and two triangles, or of as many as the first two bytes say.
pub fn draco(data: &[u8]) {
    if let Some(file) = draco_file(data) {
        load(Format::Glb.into(), &file);
    }
}

/// The file that [`draco`] reads.
pub fn draco_file(data: &[u8]) -> Option<Vec<u8>> {
    let (&[vertices, triangles], stream) = data.split_first_chunk()?;
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsRequired":["KHR_draco_mesh_compression"],"buffers":[{{"byteLength":{0}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{0}}}],"accessors":[{{"componentType":5126,"count":{vertices},"type":"VEC3"}},
        {{"componentType":5121,"count":{1},"type":"SCALAR"}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},
        "indices":1,"extensions":{{"KHR_draco_mesh_compression":{{"bufferView":0,"attributes":{{"POSITION":0}}}}}}}}]}}],
        "nodes":[{{"mesh":0}}],"scenes":[{{"nodes":[0]}}],"scene":0}}"#,
        stream.len(),
        3 * u32::from(triangles),
    );
    Some(glb(&json, stream))
}

/// A GLB of that JSON and buffer.
fn glb(json: &str, buffer: &[u8]) -> Vec<u8> {
    let mut out = b"glTF\x02\0\0\0".to_vec();
    let lengths = [json.len().next_multiple_of(4), buffer.len().next_multiple_of(4)];
    out.extend((28 + (lengths[0] + lengths[1]) as u32).to_le_bytes());
    for (length, name, content, fill) in
        [(lengths[0], b"JSON", json.as_bytes(), b' '), (lengths[1], b"BIN\0", buffer, 0)]
    {
        out.extend((length as u32).to_le_bytes());
        out.extend(name);
        out.extend(content);
        out.resize(out.len() + length - content.len(), fill);
    }
    out
}

fn one_of(formats: [Format; 2], data: &[u8]) {
    let Some((&which, file)) = data.split_first() else { return };
    load(formats[usize::from(which & 1)].into(), file);
}

/// A scene or an error in one line; a scene is whole.
fn load(kind: FileKind, file: &[u8]) {
    match load_bytes(kind, file) {
        Ok(scene) => check(&scene),
        Err(error) => {
            let text = error.to_string();
            assert!(!text.is_empty() && !text.contains('\n'), "{text:?}");
        }
    }
}

fn check(scene: &Scene) {
    assert!(!scene.materials.is_empty());
    for id in 0..scene.mesh.len() as u32 {
        let material = scene.material(id);
        assert!(material.texture.is_none_or(|texture| (texture as usize) < scene.textures.len()));
    }
    let ids = [scene.material_ids.len(), scene.face_colours.len()];
    assert!(ids.iter().all(|&count| count == 0 || count == scene.mesh.len()), "{ids:?}");
    attribute(scene, scene.normals.as_ref());
    attribute(scene, scene.uvs.as_ref());
    attribute(scene, scene.colours.as_ref());
    assert!(
        scene.warnings.iter().all(|warning| !warning.text().is_empty() && !warning.text().contains('\n'))
    );
    // What was read is written, and read again as it was.
    if scene.mesh.len() < 4096 && !scene.mesh.is_empty() {
        let mut file = Vec::new();
        write_ply(&scene.mesh, &mut file).unwrap();
        let options = LoadOptions::default().origin(Origin::At(scene.mesh.origin()));
        let again = load_bytes_with(Format::Ply, &file, &options).unwrap();
        assert_eq!(again.mesh.triangles(), scene.mesh.triangles());
        let bits = |scene: &Scene| {
            scene.mesh.vertices().as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>()
        };
        // Far from 0, the sum of a vertex and the origin is rounded once in the file.
        if scene.mesh.origin() == [0.0; 3] {
            assert_eq!(bits(&again), bits(scene));
        }
    }
}

/// Every triangle has its three values, or none.
fn attribute<T: Copy>(scene: &Scene, attribute: Option<&Attribute<T>>) {
    let Some(attribute) = attribute else { return };
    for (id, &corners) in scene.mesh.triangles().iter().enumerate() {
        let own = attribute.indices.as_ref().map_or(corners, |indices| indices[id]);
        assert!(own[0] == u32::MAX || attribute.corners(id as u32, corners).is_some(), "{id}: {own:?}");
    }
}
