//! Inputs that users of other programs reported, described anew with other numbers; each test names the report.

use slimkd_scene::{Format, LoadError, load_bytes};

/// assimp#2534: a binary PLY whose header's lines end in CR LF, with faces of different sizes and a first byte that could
/// be taken for a line's end.
#[test]
fn binary_ply_behind_a_header_of_cr_lf() {
    for end in ["\r\n", "\n", "\r"] {
        let header = "ply\nformat binary_little_endian 1.0\ncomment made by hand\nobj_info none\nelement vertex 4\n\
            property float x\nproperty float y\nproperty float z\nelement face 2\n\
            property list uchar int vertex_index\nend_header\n";
        let mut bytes = header.replace('\n', end).into_bytes();
        let first = f32::from_le_bytes([10, 13, 10, 63]);
        for corner in [[first, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]] {
            bytes.extend(corner.iter().flat_map(|x: &f32| x.to_le_bytes()));
        }
        for face in [&[0i32, 1, 2][..], &[0, 1, 2, 3]] {
            bytes.push(face.len() as u8);
            bytes.extend(face.iter().flat_map(|index| index.to_le_bytes()));
        }
        let scene = load_bytes(Format::Ply, &bytes).unwrap();
        assert_eq!(scene.mesh.vertices()[0][0], first);
        assert_eq!(scene.mesh.triangles(), [[0, 1, 2], [0, 1, 2], [0, 2, 3]]);
    }
}

/// magnum-plugins#94 and 3DBear/PlyImporter#4: `vertex_index` as well as `vertex_indices`, double coordinates and normals,
/// colours, unsigned indices.
#[test]
fn ply_as_open3d_and_cloudcompare_write_it() {
    for name in ["vertex_index", "vertex_indices"] {
        let text = format!(
            "ply\nformat ascii 1.0\ncomment Created\nobj_info Generated\nelement vertex 3\nproperty double x\n\
             property double y\nproperty double z\nproperty double nx\nproperty double ny\nproperty double nz\n\
             property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
             property list uchar uint {name}\nend_header\n0.1 0 0 0 0 1 9 8 7\n1 0 0 0 0 1 6 5 4\n0 1 0 0 0 1 3 2 1\n3 0 1 2\n"
        );
        let scene = load_bytes(Format::Ply, text.as_bytes()).unwrap();
        assert_eq!(scene.mesh.vertices()[0][0], 0.1);
        assert_eq!(scene.normals.unwrap().values, [[0.0, 0.0, 1.0]; 3]);
        assert_eq!(scene.colours.unwrap().values, [[9, 8, 7, 255], [6, 5, 4, 255], [3, 2, 1, 255]]);
    }
}

/// trimesh#2364: negative indices between blocks of vertices count from the face's line, not from the end.
#[test]
fn obj_negative_indices_between_vertices() {
    let text = "v 0 0 0\nv 3 0 0\nv 0 3 0\nf -1 -2 -3\nv 0 0 5\nv 3 0 5\nv 0 3 5\nv 3 3 5\nf -4 -3 -1 -2\n";
    let scene = load_bytes(Format::Obj, text.as_bytes()).unwrap();
    assert_eq!(scene.mesh.triangles(), [[2, 1, 0], [3, 4, 6], [3, 6, 5]]);
}

/// tinyobjloader#140: an index of 0 is an error, since indices count from 1.
#[test]
fn obj_indices_of_zero() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n";
    assert!(matches!(load_bytes(Format::Obj, text.as_bytes()), Err(LoadError::Invalid { .. })));
}

/// three.js#19254: an object without vertex colours before one that has them does not shift the colours.
#[test]
fn obj_colours_of_some_objects() {
    let text = "o plain\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no coloured\nv 0 0 1 1 0 0\nv 1 0 1 0 1 0\nv 0 1 1 0 0 1\nf 4 5 6\n";
    let colours = load_bytes(Format::Obj, text.as_bytes()).unwrap().colours.unwrap().values;
    assert_eq!(colours[..3], [[255; 4]; 3]);
    assert_eq!(colours[3..], [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]]);
}

/// trimesh#1103: Rhino breaks long faces by a backslash.
#[test]
fn obj_faces_over_several_lines() {
    let text = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nusemtl \nf 1// 2// \\\n3// \\\n4//\n";
    let scene = load_bytes(Format::Obj, text.as_bytes()).unwrap();
    assert_eq!(scene.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
}

/// assimp#1970, assimp#104, fstl#33, numpy-stl#206 and meshlab#734: empty solids, several solids, no name behind `solid`,
/// `end solid NAME`, and a name of many hundred letters.
#[test]
fn stl_solids_of_every_kind() {
    let facet = "facet normal 0 0 0\n outer loop\n  vertex 0 0 0\n  vertex 2 0 0\n  vertex 0 2 0\n endloop\nendfacet\n";
    let long = "/".repeat(900);
    let text = format!(
        "solid 4\nendsolid\nsolid\n{facet}endsolid\nsolid a\n{facet}end solid a\nsolid x{long}\n{facet}endsolid x{long}\n"
    );
    let scene = load_bytes(Format::Stl, text.as_bytes()).unwrap();
    assert_eq!((scene.mesh.len(), scene.warnings.len()), (3, 0));
}

/// PyMesh#162, trimesh#753, mayo#258, meshlab#292 and trimesh#2591: counts behind the word, colours under a plain `OFF`, and
/// a file that ends behind its first word.
#[test]
fn off_headers() {
    let text = "OFF4 1 0\n0 0 0 10 20 30 255\n2 0 0 10 20 30 255\n2 2 0 10 20 30 255\n0 2 0 10 20 30 255\n4 0 1 2 3\n";
    let scene = load_bytes(Format::Off, text.as_bytes()).unwrap();
    assert_eq!((scene.mesh.len(), scene.colours.unwrap().values), (2, vec![[10, 20, 30, 255]; 4]));
    assert!(load_bytes(Format::Off, b"OFF\n").is_err());
}
