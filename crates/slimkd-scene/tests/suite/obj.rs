//! OBJ files and their materials.

use glam::Vec3;
use slimkd_scene::{Format, LoadError, LoadOptions, Place, Scene, load_bytes, load_with};
use std::fs;

fn parse(text: &str) -> Scene {
    load_bytes(Format::Obj, text.as_bytes()).unwrap()
}

#[test]
fn faces_keep_their_order_across_groups_and_vertices_are_not_split() {
    let scene = parse(
        "# comment\no one\nv 0 0 0\nv 1 0 0\nv 1 1 0 1.0\nv 0 1 0 0.5 0.5 0.5\ng a\nf 1 2 3 4\ns off\no two\n\
         v 5 5 5\nf -1 -5 \\\n-4\nf 1 1 1 # degenerate\ng a\nf 4// 3/ 2\n",
    );
    assert_eq!(scene.mesh.vertices().len(), 5);
    assert_eq!(scene.mesh.triangles(), [[0, 1, 2], [0, 2, 3], [4, 0, 1], [0, 0, 0], [3, 2, 1]]);
    assert!(scene.normals.is_none() && scene.uvs.is_none() && scene.material_ids.is_empty());
    assert_eq!(scene.materials.len(), 1);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn corners_have_their_own_normals_and_texture_coordinates() {
    let scene = parse(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5\nvt 0 1 0\nvn 0 0 1\nvn 0 1 0\nf 1 2 3\nf 1/1/2 2/2/2 3/1/1\n\
         f 1//1 2//1 3//2\nf 3/2 2/1 1/2\nf 1/1 2 3/1\n",
    );
    let none = [u32::MAX; 3];
    let uvs = scene.uvs.unwrap();
    assert_eq!(uvs.values, [[0.5, 0.0], [0.0, 1.0]]);
    assert_eq!(uvs.indices.as_deref().unwrap(), [none, [0, 1, 0], none, [1, 0, 1], none]);
    assert_eq!(uvs.corners(1, [0, 1, 2]), Some([[0.5, 0.0], [0.0, 1.0], [0.5, 0.0]]));
    assert_eq!(uvs.corners(0, [0, 1, 2]), None);
    let normals = scene.normals.unwrap();
    assert_eq!(normals.indices.unwrap(), [none, [1, 1, 0], [0, 0, 1], none, none]);
    // The same indices everywhere need no copy.
    let shared = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\nf 1//1 2//2 3//3\n");
    assert_eq!(shared.normals.unwrap().indices, None);
}

#[test]
fn materials_and_textures_come_from_beside_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("maps")).unwrap();
    let picture = fs::File::create(at("maps/a b.png")).unwrap();
    slimkd_util::png::write(picture, [2, 1], &[0, 128, 0, 255, 128, 0]).unwrap();
    fs::write(
        at("scene materials.mtl"),
        "newmtl red\nKd 1 0 0\nKs .5 .5 .5\nNs 200\nNi 1.4\nd 0.25\nillum 2\nKe 3 0 0\n\
         newmtl broken\nKd red\n\
         newmtl mirror one\nKd 0 0 0\nKs .6 .9 .9\nillum 3\nmap_Kd -s 1 1 1 nothing.png\n\
         newmtl glass\nTr 0.75\nNi 1.5\nillum 7\nmap_Kd maps\\a b.png\n\
         newmtl filter\nTf .5 .5 .5\nillum 4\nmap_Kd maps/a b.png\n",
    )
    .unwrap();
    fs::write(
        at("scene.obj"),
        "mtllib scene materials.mtl\nmtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl red\nf 1 2 3\n\
         usemtl nobody\nusemtl mirror one\nf 1 2 3\nusemtl red\nf 1 2 3\nusemtl glass\nf 1 2 3\nusemtl broken\n\
         f 1 2 3\nusemtl filter\nf 1 2 3\n",
    )
    .unwrap();
    let progress = slimkd::Progress::new();
    let scene = load_with(at("scene.obj"), &LoadOptions::new(), &progress).unwrap();
    assert_eq!(progress.fraction(), 1.0);
    assert_eq!(scene.name, "scene");
    assert_eq!(scene.material_ids, [0, 1, 2, 1, 3, 4, 5]);
    let names: Vec<_> = scene.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["", "red", "mirror one", "glass", "broken", "filter"]);
    let [_, red, mirror, glass, _, filter] = &scene.materials[..] else { panic!() };
    assert_eq!((red.diffuse, red.specular, red.shininess), (Vec3::X, Vec3::splat(0.5), 200.0));
    assert_eq!((red.ior, red.transmission, red.reflection), (1.4, 0.75, 0.0));
    assert_eq!(red.emission, Vec3::new(3.0, 0.0, 0.0));
    assert!((mirror.reflection - 0.8).abs() < 1e-6);
    assert_eq!((glass.transmission, glass.ior, glass.texture), (0.75, 1.5, Some(0)));
    assert_eq!((filter.transmission, filter.texture), (0.5, Some(0)));
    assert_eq!(scene.textures.len(), 1);
    let texels = &scene.textures[0].texels;
    assert_eq!((texels[0][0], texels[1][0]), (0.0, 1.0));
    assert!((texels[0][1] - 0.2158605).abs() < 1e-5, "sRGB 128 is 0.2159 linear, not {}", texels[0][1]);
    // missing.mtl, the broken material twice (in the file, then in use), nothing.png
    assert_eq!(scene.warnings.len(), 4, "{:?}", scene.warnings);
    assert!(scene.warnings.iter().all(|warning| !warning.text().contains('\n')));
}

#[test]
fn errors_name_the_line() {
    for (text, line) in [
        ("v 0 0 0\nv 1 0\n", 2),
        ("v 0 0 0\nvn 0 x 0\n", 2),
        ("v 0 0 0\nvt\n", 2),
        ("v 0 0 0\n\nf 1 1 2\n", 3),
        ("v 0 0 0\nf 1 1 0\n", 2),
        ("v 0 0 0\nf 1 1 -2\n", 2),
        ("v 0 0 0\nf 1/1 1/1 1/1\n", 2),
        ("v 0 0 0\nf 1//1 1//1 1//1\n", 2),
        ("v 0 0 0\nf 1/1/1/1 1 1\n", 2),
        ("v 0 0 0\nf a b c\n", 2),
        ("v 0 0 0\nf 1 1 9223372036854775807\n", 2),
        ("v 0 0 0\nf 1 1 -9223372036854775808\n", 2),
        ("v 0 0 0\nf 1 1 99999999999999999999\n", 2),
        ("v 0 0 0\nf 1 1 4294967296\n", 2),
        ("hello\nworld\n", 1),
    ] {
        let error = load_bytes(Format::Obj, text.as_bytes()).unwrap_err();
        match error {
            LoadError::Invalid { place, .. } => assert_eq!(place, Place::Line(line), "{text}"),
            other => panic!("{other}"),
        }
    }
}

#[test]
fn odd_but_harmless_files_load() {
    assert!(parse("# nothing\n").mesh.is_empty());
    let scene = parse("v 0 0 0\nv 1 0 0\nl 1 2\nf 1 2\nsomething else\nf 1 2 3\nv nan inf 0\n");
    assert_eq!(scene.mesh.triangles(), [[0, 1, 2]]);
    assert_eq!(scene.warnings.len(), 3);
    assert_eq!(scene.warnings[1].to_string(), "1 of 3 elements are lines or points and were left out");
    let curves =
        parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ncstype bezier\ndeg 1\ncurv 0 1 1 2\nparm u 0 1\nend\n");
    assert_eq!(curves.mesh.len(), 1);
    assert!(
        curves.warnings[0].to_string().starts_with("1 of 2 elements are free-form"),
        "{:?}",
        curves.warnings
    );
    let bom = parse("\u{feff}v 0 0 0\nf 1 1 1");
    assert_eq!(bom.mesh.len(), 1);
    let missing = parse("mtllib a.mtl\nusemtl x\nv 0 0 0\nf 1 1 1\n");
    assert_eq!((missing.warnings.len(), missing.materials[0].name.as_str()), (2, "x"));
}
