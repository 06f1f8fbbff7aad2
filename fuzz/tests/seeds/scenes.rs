//! Seeds of scene files.

use super::put;
use base64::{Engine, engine::general_purpose::STANDARD};
use flate2::{Compression, write::ZlibEncoder};
use slimkd_fuzz::{FORMATS, draco_file, meshopt_file};
use slimkd_scene::{Format, load_bytes};
use std::io::Write;

/// Mode and filter, bytes of an element, how many, and the stream that meshoptimizer's own encoder made of made-up numbers.
const MESHOPT: [(u8, u8, u32, &str); 14] = [
    (0, 4, 5, "of8AvQ2piwCCgoB6AL0NqYsAgoKAegAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=="),
    (0, 4, 5, "of8AZfvP3ACV67a3AMezSwoA9jKtFwAAAAAAAAAAAAAAAAAAAAAAAACrzgXOAA=="),
    (
        0,
        12,
        16,
        "oAMAMjuvgyRU36DNNbUTdAYaAwCwdsTX343htKlS5VEaaKADAM3+lGZGQD4kGhYUDg4IBAE4AIAAfAMAtRN0BhpWiIAHfqV/n+6HAwDlURpooM7215M1Tv4d93ACD+6EAXnf//8UERMXGx0AAwCuwE+JKVuxeX5/4l3CpCcDANeBDYQgIiqGw1I5y1HmiwMACQkLDRsfHyMlIyc7S0tVAQAAAEAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAD7j2FA5UqXQA==",
    ),
    (
        0,
        12,
        16,
        "oX+fvwAyxFCD26vfoM3KtRN0BhoAsHfD2N+N4rSqU+ZSGmigADL+lGZGQD4kGhYUDg4IBAACAH0AtRN0BhpWiIAHfqV/n+6HAOVRGmigzvbXkzVO/h33cAIP7oQBed///xQRExcbHQBRP0921qROhoGAHV09pCcA2YEOgx8jKYXDUTnMUeSMAAkJCw0bHx8jJSMnO0tLVQAAAAAAAAAAAAAAAAD7j2FA5UqXQAEAAQ==",
    ),
    (0, 12, 16, "oaqqqgAAAAAAAAAAAAcHBwcHBwcHBwcHBwAAAA=="),
    (
        12,
        12,
        16,
        "oAMA4F9SMuAF7HYwi6gr9gzdAg8P///2ZEQgSiQlEBAQNQABOICAABIDAKgr9gzdMr1Uk4hR3hyTyAIEQiIAExNVVwAAAwApj/FfyDhBqfnMrFehVaECARH1d5eX//86MBMRKgABAEAAQQAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA8hI3AP7wJAD/",
    ),
    (
        4,
        4,
        40,
        "oW8A//wP1Kfr4t4moagqnNXIoUB3MDQae/lObx6zlzj+w1ZKHJyRjQcMAPT5YhPbEqzk5PBwpQYb/FhzfciU4N16ZZD8KucqA1H2Vh76gS4YvABCMgMEAwQDgg8EAwQDBAPHAAQDBAMEAAAAAAAAAAAAAAAAAAAAAAAAALO6f4EA",
    ),
    (
        8,
        8,
        40,
        "oB8AcA0f/nACLXtmqmk1IT5ibrepW3n4iT6s5AqEwr/n6v//AAD3o4ozmkeneC4BIdD/Nj//kxYTFg8QEBMSEwoJEAARCBIVCAQBAID2mnYAAAAAER8ARsh2sAbPJs6TkPyAhvLtTmSZacoJXrZ3Z5J4U1wjZP//AACniokNxsIpiioEhEdgNvh6rxMXZYS/vLok/zYQDxC1Yk0EAAAAAB8APK0gxgNdNKZn4WerZxv6vLPK52P9NYgqnPSu3DiM7P//AACZ4MGmc82MqioC18Dft6a/HRYScv/Db2xP//QSDxMTEhESG3/RTwAAAAAaDxoEMgFDEkBUAAEiNFIUNhAQc4sAAAYDBQAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAABbAQv7QwX9Bw==",
    ),
    (
        16,
        8,
        40,
        "oXd3AEf9/DFEoteElHhTKVT5jo7J0Z5HfzZ/VrGsM1tIY16Dm+tMb8yOaioOWVEGVl5SBbifDp/yMplbFhEPSy2hKgAAAAAA5/C3OiS9EGAbwD6Bu5RVNi8ySlUssAnbYGj+SDWlDsEjzGVefckyKgB/VQU6N5v2ExCsKILT45FPTxIPsuBcKQAAAAAA/8Lg4XS00V3ybX2YDR6sqSlWDOc7RLseMaCex3RTyYcHSJSL5OvJGgVyQmkCIlloWnUQSHc3rYNsswAABAkFADAUo+ydF3Jq50DDqOIhi1a1osJ7DWxo8TkRgAN56N+G92VEK3zDnCoKKYsiinYncqMxZCMwCWIhaBi6WgAAAAAAAAAAAAAAAAAAAAAAAAgOwv+E/3YJAQE=",
    ),
    (1, 4, 6, "4fAQAHaHVmd4qYZliWiYAWkAAA=="),
    (
        1,
        2,
        216,
        "4f4eEA4QDhAOEA4QDv4eGw4aDhkOGA4XDv8eFw4XDhcOFw4XDv8eFw4XDhcOFw4XDv8eFw4XDhcOFw4XDv8eFw4XDhcOFw4XDg8OvwJvCw5vCw5vCw5vCw4AdodWZ3iphmWJaJgBaQAA",
    ),
    (
        2,
        4,
        216,
        "0QAEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhIEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhIEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhIEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhIEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhIEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAgAAAAA=",
    ),
    (
        1,
        4,
        216,
        "4f///////////////5///1v////+//8P///////+z/9v/2//////f///oP/v///////////+//8v/////6////7//28P/w3///8eAgz/JQIM/xEOAf8aDgH/Bg4B3xsO/wMOAf87Agz1JA7/Nw4B/woCDPMbAh7/Ew4B/wIOAf8pDgGvFg7/EA4BD03/PgIM/w8OAQ38Cg7/SQIM/wUOAf8YAgz/Iw4B/yUBEv8YAgwpLygOCf8ZAgz/JQIMbAj/GwIMCP8aDgHyCQ7/CQ4BMf8TAgz/HAIM/zMOAf8wDgH/QQ4B/wIOAf8BDgFDF/8NAf88Agz/HQ4BCS8IDm8lDP8RAgz1FQI0eh3/EgIMD0P/FQIM/wwCDBMN/zYCDP8nDgH/BwIMAHaHVmd4qYZliWiYAWkAAA==",
    ),
    (
        1,
        4,
        192,
        "4f4eEA4QDhAOzh4WDhUOFA7OHhQOFA4UDs4eFA4UDhQO/gAeAB4AHgDAEBYAFQAUAMAQFAAUABQAwBAUABQAFAAPCv8vAgB2h1ZneKmGZYlomAFpAAA=",
    ),
];
/// Two triangles of a unit square by Google's encoder, at its speeds 1, 7 and 10.
const DRACO: [&str; 3] = [
    "RFJBQ08CAgEBAAAABAIAAgAAAR//AREB/wAAAQAJAwAAAgABAQADAwEgASADACCEmJAAAAAAAP8/AAAAAAAAAAAAAAAAAAAAAIA/Dg==",
    "RFJBQ08CAgEBAAAABAIAAgAAAR//AREB/wAAAQAJAwAAAgEBAQADAwEwARADACiCmAAAAAAA/z8AAAAAAAAAAAAAAAAAAAAAgD8O",
    "RFJBQ08CAgEAAAACBAEAAQIAAgMBAQAJAwAAAgABAQADAwEwARADADSCiAQAAAAA/z8AAAAAAAAAAAAAAAAAAAAAgD8O",
];

/// Two meshes of a triangle, and the list of their places.
fn serialized(version: u16, is_double: bool) -> Vec<u8> {
    let (mut out, mut places) = (Vec::new(), Vec::new());
    for x in [0u8, 5] {
        places.push(out.len());
        let mut content = (0x0003u32 | if is_double { 0x2000 } else { 0x1000 }).to_le_bytes().to_vec();
        if version == 4 {
            content.extend(b"part\0");
        }
        content.extend([3u64, 1].map(u64::to_le_bytes).as_flattened());
        let x = f32::from(x);
        let numbers =
            [x, 0.0, 0.0, x + 1.0, 0.0, 0.0, x, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
        for number in numbers.into_iter().chain([0.0, 0.0, 1.0, 0.0, 0.0, 1.0]) {
            match is_double {
                true => content.extend(f64::from(number).to_le_bytes()),
                false => content.extend(number.to_le_bytes()),
            }
        }
        content.extend([0u32, 1, 2].map(u32::to_le_bytes).as_flattened());
        out.extend([0x041C, version].map(u16::to_le_bytes).as_flattened());
        let mut encoder = ZlibEncoder::new(&mut out, Compression::default());
        encoder.write_all(&content).unwrap();
        encoder.finish().unwrap();
    }
    for place in places {
        match version {
            3 => out.extend((place as u32).to_le_bytes()),
            _ => out.extend((place as u64).to_le_bytes()),
        }
    }
    out.extend(2u32.to_le_bytes());
    out
}

/// Writes them.
pub fn write() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n";
    let mut binary = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n".to_vec();
    for x in 0..3u8 {
        binary.extend([0, 0, 128, 63, 0, 0, 0, 64, x, 0, 0, 65, x]);
    }
    binary.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    let obj = "mtllib a.mtl\no box\nv 0 0 0\nv 1 0 0\nv 1 1 0 1\nv 0 1 0\nvt 0 0\nvn 0 0 1\ng a\nusemtl m\ns 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf -1//1 -2//1 -3//1\nf 1 2 3\n";
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    let mut stl_binary = vec![0; 84 + 50];
    stl_binary[80] = 1;
    stl_binary[84 + 24..84 + 28].copy_from_slice(&1f32.to_le_bytes());
    stl_binary[84 + 40..84 + 44].copy_from_slice(&1f32.to_le_bytes());
    let json = |buffer: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"scale":[2,2,2],"children":[1]}},{{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1]}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],"materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[1,0,0,1]}}}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},{{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],"buffers":[{{"byteLength":44{buffer}}}]}}"#
        )
    };
    let gltf = json(
        r#","uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=""#,
    );
    let mut text = json("").into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut buffer = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect::<Vec<_>>();
    buffer.extend([0, 0, 1, 0, 2, 0, 0, 0]);
    let mut glb = b"glTF".to_vec();
    for number in [2, (12 + 8 + text.len() + 8 + buffer.len()) as u32, text.len() as u32] {
        glb.extend(number.to_le_bytes());
    }
    glb.extend(b"JSON");
    glb.extend(&text);
    glb.extend((buffer.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(&buffer);
    let off = "COFF\n4 1 0\n0 0 0 1 0 0\n4 0 0 0 1 0\n1 1 0 0 0 1\n0 4 0 255 255 255\n4 0 1 2 3 9 9 9\n";
    let grid = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9\n1 2\n3 4\n";
    let npy = b"\x93NUMPY\x01\x00\x3c\x00{'descr': '|u1', 'fortran_order': False, 'shape': (2, 2), }\n\x01\x02\x03\x04";
    let strips = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 3 1 0\n";
    let coloured = "ply\rformat ascii 1.0\relement face 1\rproperty list uchar int vertex_index\rproperty list uchar float texcoord\rproperty uchar red\rproperty uchar green\rproperty uchar blue\relement vertex 3\rproperty float x\rproperty float y\rproperty float z\rproperty float nx\rproperty float ny\rproperty float nz\rproperty uchar red\rproperty uchar green\rproperty uchar blue\rend_header\r3 0 1 2 6 0 0 1 0 0 1 9 8 7\r0 0 0 0 0 1 1 2 3\r1 0 0 0 0 1 1 2 3\r0 1 0 0 0 1 1 2 3\r";
    let concave =
        "v 0 0 0 1 0 0\nv 4 0 0 1 0 0\nv 1 1 0 1 0 0\nv 0 4 0 1 0 0\nf 1 2 \\\n3 4\n# c:\\\nf -4 -3 -2 -2\n";
    let words = "solid a b\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 vertex 0 1 0 end loop end facet\n";
    let textured = "STNOFF3 1 0\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n3 0 1 2 0.5 0.5 0.5\n";
    let morphed = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]},{"nodes":[1]}],"scene":1,"nodes":[{"mesh":0,"weights":[0.5]},{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}}],"meshes":[{"weights":[1],"primitives":[{"mode":5,"attributes":{"POSITION":0,"COLOR_0":0},"targets":[{"POSITION":1}]}]}],"accessors":[{"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":1}}},{"componentType":5126,"count":4,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":1},{"buffer":0,"byteOffset":4,"byteLength":12}],"buffers":[{"byteLength":16,"uri":"data:;base64,AgAAAAAAgD8AAIA/AACAPw=="}]}"#;
    let shapes = r#"<?xml version="1.0"?><!-- all --><scene version="3.0.0"><default name="r" value="0.5"/><shape type="rectangle"><transform name="to_world"><scale value="2"/><rotate x="1" angle="45"/><translate value="1, 2 3"/></transform></shape><shape type="cube"><boolean name="flip_normals" value="true"/><transform name="toWorld"><lookAt origin="0,0,5" target="0,0,0" up="0,1,0"/></transform></shape><shape type="sphere"><point name="center" x="1" y="2"/><float name="radius" value="$r"/></shape><shape type="cylinder"><point name="p1" value="0 0 3"/></shape><shape type="disk"><transform name="to_world"><matrix value="1 0 0 7 0 1 0 8 0 0 1 9 0 0 0 1"/></transform></shape><shape type="ply"/><sensor type="perspective"><float name="fov" value="40"/></sensor></scene>"#.replace(r#"<shape type="ply"/>"#, r#"<shape type="hair"/>"#);
    let group = r##"<scene version="0.6.0"><shape type="shapegroup" id="g"><shape type="rectangle"><ref id="m"/></shape><shape type="cube"/></shape><bsdf type="diffuse" id="m"><rgb name="reflectance" value="#ff8000"/></bsdf><alias id="g" as="h"/><shape type="instance"><ref id="h"/><transform name="to_world"><scale x="-1"/></transform></shape><shape type="merge"><shape type="instance"><ref id="g"/></shape><shape type="disk"/></shape></scene>"##;
    let materials = r#"<scene><bsdf type="twosided" id="a"><bsdf type="roughplastic"><spectrum name="diffuse_reflectance" value="400:0.2, 700:0.4"/><float name="alpha" value="0.2"/></bsdf></bsdf><shape type="rectangle"><ref id="a"/><emitter type="area"><rgb name="radiance" value="1 2 3"/></emitter></shape><shape type="rectangle"><bsdf type="dielectric"><string name="int_ior" value="diamond"/></bsdf></shape><shape type="rectangle"><bsdf type="conductor"><string name="material" value="Au"/></bsdf></shape><shape type="rectangle"><bsdf type="principled"><texture type="bitmap" name="base_color"><string name="filename" value="a.png"/></texture></bsdf></shape><emitter type="point"><rgb name="intensity" value="5"/></emitter></scene>"#;
    let city = r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[0.5,0.5,1],"translate":[100,200,0]},"appearance":{"materials":[{"name":"a","diffuseColor":[1,0,0]}],"textures":[{}]},"CityObjects":{"b":{"type":"Building","geometry":[{"type":"Solid","lod":"2.2","boundaries":[[[[0,1,2,3],[4,5,6]],[[0,1,3]]]],"semantics":{"surfaces":[{"type":"RoofSurface"}],"values":[[0,null]]},"material":{"t":{"values":[[0,null]]}}},{"type":"MultiSurface","lod":1,"boundaries":[[[0,1,2]]]},{"type":"MultiPoint","lod":"0","boundaries":[0]}]}},"vertices":[[0,0,0],[8,0,0],[8,8,0],[0,8,0],[1,1,0],[1,2,0],[2,1,0]]}"#;
    let templates = r#"{"type":"CityJSON","version":"1.0","geometry-templates":{"templates":[{"type":"CompositeSurface","lod":1,"boundaries":[[[0,1,2]]]}],"vertices-templates":[[0,0,0],[1,0,0],[0,1,0.5]]},"CityObjects":{"t":{"type":"SolitaryVegetationObject","geometry":[{"type":"GeometryInstance","template":0,"boundaries":[0],"transformationMatrix":[2,0,0,7,0,2,0,0,0,0,-2,0,0,0,0,1]}]}},"vertices":[[5,6,7]]}"#;
    let sequence = r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"CityObjects":{},"vertices":[]}
{"type":"CityJSONFeature","id":"a","CityObjects":{"a":{"type":"Bridge","geometry":[{"type":"MultiSolid","lod":"1","boundaries":[[[[[0,1,2]]]]]}]}},"vertices":[[0,0,0],[1,0,0],[0,1,0]]}
"#;
    let doubles = b"\x93NUMPY\x01\x00\x3b\x00{'descr': '>f8', 'fortran_order': True, 'shape': (2, 2), }\n?\xf0\0\0\0\0\0\0@\0\0\0\0\0\0\0@\x08\0\0\0\0\0\0@\x10\0\0\0\0\0\0";
    let seeds: [(&str, Option<u8>, Format, &[u8]); 30] = [
        ("ply", None, Format::Ply, ply.as_bytes()),
        ("ply", None, Format::Ply, &binary),
        ("ply", None, Format::Ply, strips.as_bytes()),
        ("ply", None, Format::Ply, coloured.as_bytes()),
        ("obj", None, Format::Obj, obj.as_bytes()),
        ("obj", None, Format::Obj, concave.as_bytes()),
        ("stl", None, Format::Stl, stl.as_bytes()),
        ("stl", None, Format::Stl, &stl_binary),
        ("stl", None, Format::Stl, words.as_bytes()),
        ("off", None, Format::Off, off.as_bytes()),
        ("off", None, Format::Off, textured.as_bytes()),
        ("gltf", Some(0), Format::Gltf, gltf.as_bytes()),
        ("gltf", Some(1), Format::Glb, &glb),
        ("gltf", Some(0), Format::Gltf, morphed.as_bytes()),
        ("mitsuba", Some(0), Format::Mitsuba, shapes.as_bytes()),
        ("mitsuba", Some(0), Format::Mitsuba, group.as_bytes()),
        ("mitsuba", Some(0), Format::Mitsuba, materials.as_bytes()),
        ("mitsuba", Some(1), Format::Serialized, &serialized(4, false)),
        ("mitsuba", Some(1), Format::Serialized, &serialized(3, true)),
        ("cityjson", Some(0), Format::CityJson, city.as_bytes()),
        ("cityjson", Some(0), Format::CityJson, templates.as_bytes()),
        ("cityjson", Some(1), Format::CityJsonSeq, sequence.as_bytes()),
        ("grids", Some(0), Format::AsciiGrid, grid.as_bytes()),
        ("grids", Some(1), Format::Npy, npy),
        ("grids", Some(1), Format::Npy, doubles),
        ("scene", Some(0), Format::Ply, &binary),
        ("scene", Some(4), Format::Glb, &glb),
        ("scene", Some(8), Format::Mitsuba, group.as_bytes()),
        ("scene", Some(9), Format::Serialized, &serialized(4, true)),
        ("scene", Some(11), Format::CityJsonSeq, sequence.as_bytes()),
    ];
    for (k, (target, first, format, file)) in seeds.into_iter().enumerate() {
        load_bytes(format, file).unwrap_or_else(|error| panic!("seed {k}: {error}"));
        put(target, &format!("seed-{k}"), &[first.as_slice(), file].concat());
    }
    let is_sound = |file: Option<Vec<u8>>| load_bytes(Format::Glb, &file.unwrap()).map(drop);
    for (k, (kind, stride, count, stream)) in MESHOPT.into_iter().enumerate() {
        let [low, high] = (count as u16).to_le_bytes();
        let seed = [&[kind, stride, low, high], &STANDARD.decode(stream).unwrap()[..]].concat();
        is_sound(meshopt_file(&seed)).unwrap_or_else(|error| panic!("meshopt {k}: {error}"));
        put("meshopt", &format!("seed-{k}"), &seed);
    }
    for (k, stream) in DRACO.into_iter().enumerate() {
        let seed = [&[4, 2], &STANDARD.decode(stream).unwrap()[..]].concat();
        is_sound(draco_file(&seed)).unwrap_or_else(|error| panic!("Draco {k}: {error}"));
        put("draco", &format!("seed-{k}"), &seed);
    }
    put(
        "scene",
        "seed-zst",
        &[&[FORMATS.len() as u8], &zstd::encode_all(ply.as_bytes(), 3).unwrap()[..]].concat(),
    );
    let mut gzip = flate2::write::GzEncoder::new(vec![2 * FORMATS.len() as u8], flate2::Compression::best());
    gzip.write_all(ply.as_bytes()).unwrap();
    put("scene", "seed-gz", &gzip.finish().unwrap());
}
