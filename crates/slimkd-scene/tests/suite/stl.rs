//! STL files, text and binary.

use slimkd_scene::{Format, LoadError, Scene, load_bytes};

fn load(bytes: &[u8]) -> Scene {
    load_bytes(Format::Stl, bytes).unwrap()
}

fn binary(head: &str, triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut out = vec![b' '; 80];
    out[..head.len()].copy_from_slice(head.as_bytes());
    out.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        out.extend([0; 12]);
        triangle.iter().flatten().for_each(|x| out.extend(x.to_le_bytes()));
        out.extend([0; 2]);
    }
    out
}

const QUAD: [[[f32; 3]; 3]; 2] = [
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
    [[-0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
];

#[test]
fn binary_is_told_by_its_size_and_welded() {
    for head in ["made by hand", "solid but binary"] {
        let scene = load(&binary(head, &QUAD));
        assert_eq!(scene.mesh.vertices().len(), 4);
        assert_eq!(scene.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
        assert!(scene.warnings.is_empty());
        let mut longer = binary(head, &QUAD);
        longer.extend([0; 7]);
        assert_eq!(load(&longer).warnings.len(), 1);
    }
    assert!(load(&binary("", &[])).mesh.is_empty());
}

#[test]
fn welding_keeps_many_vertices_apart() {
    let triangles: Vec<_> = (0..5000u16)
        .map(|k| {
            let x = f32::from(k);
            [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [f32::NAN, x, -0.5]]
        })
        .collect();
    let scene = load(&binary("", &triangles));
    assert_eq!(scene.mesh.len(), 5000);
    assert_eq!(scene.mesh.vertices().len(), 5001 + 5000);
    for (id, triangle) in triangles.iter().enumerate() {
        let bits = |corners: [[f32; 3]; 3]| corners.map(|corner| corner.map(f32::to_bits));
        assert_eq!(bits(scene.mesh.corners(id as u32)), bits(*triangle));
    }
}

#[test]
fn text_in_any_case_and_with_polygons() {
    let text = "solid vertex 1 2\n  FACET normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1e0 0 0\n  Vertex 1 1 0\n\
        \x20 vertex 0 1 0\n endloop\n endfacet\nendsolid\n\nsolid two\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\n\
        vertex 0 0 0\nvertex 0 0 0\nendloop\nendfacet\nendsolid two\n";
    for text in [text.to_owned(), text.replace('\n', "\r\n")] {
        let scene = load(text.as_bytes());
        assert_eq!(scene.mesh.triangles(), [[0, 1, 2], [0, 2, 3], [0, 0, 0]]);
    }
    assert!(load(b"solid nothing\nendsolid nothing").mesh.is_empty());
}

#[test]
fn broken_files_are_errors() {
    let whole = binary("solid", &QUAD);
    let mut absurd = binary("", &QUAD);
    absurd[80..84].copy_from_slice(&(u32::MAX - 1).to_le_bytes());
    let cases: [&[u8]; 8] = [
        b"",
        b"not an stl",
        &whole[..whole.len() - 1],
        &whole[..83],
        &absurd,
        b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nendloop\nendfacet\nendsolid",
        b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\n",
        b"solid\nvertices\nendsolid",
    ];
    for bytes in cases {
        let error = load_bytes(Format::Stl, bytes).unwrap_err();
        assert!(matches!(error, LoadError::Invalid { .. } | LoadError::Empty), "{error}");
        assert!(!error.to_string().contains('\n'));
    }
}
