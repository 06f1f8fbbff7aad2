//! City models: solids, surfaces with holes, levels of detail, templates, sequences, far coordinates, and broken files.

use slimkd_scene::{
    Format, LoadError, LoadOptions, Origin, Scene, WarningKind, load, load_bytes, load_bytes_with,
};
use std::fs;

/// The corners of a cube of 10 steps, and a smaller square in its upper side.
const VERTICES: &str = "[0,0,0],[10,0,0],[10,10,0],[0,10,0],[0,0,10],[10,0,10],[10,10,10],[0,10,10],\
    [2,2,10],[2,4,10],[4,4,10],[4,2,10]";
const CUBE: &str = "[[[[0,3,2,1]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]]";

fn model(objects: &str, more: &str) -> String {
    format!(
        r#"{{"type":"CityJSON","version":"2.0","transform":{{"scale":[0.5,0.5,0.5],"translate":[100,200,0]}},{more}
        "CityObjects":{{{objects}}},"vertices":[{VERTICES}]}}"#
    )
}

fn city(text: &str) -> Scene {
    load_bytes(Format::CityJson, text.as_bytes()).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn geometry(kind: &str, lod: &str, boundaries: &str) -> String {
    format!(r#"{{"type":"{kind}","lod":{lod},"boundaries":{boundaries}}}"#)
}

fn object(name: &str, geometries: &[String]) -> String {
    format!(
        r#""{name}":{{"type":"Building","attributes":{{"a":[{{}}]}},"geometry":[{}]}}"#,
        geometries.join(",")
    )
}

/// A vertex in the model's coordinates.
fn world(scene: &Scene, vertex: [f32; 3]) -> [f64; 3] {
    let origin = scene.mesh.origin();
    [0, 1, 2].map(|k| origin[k] + f64::from(vertex[k]))
}

/// The corners of a triangle there.
fn corners(scene: &Scene, id: u32) -> [[f64; 3]; 3] {
    scene.mesh.corners(id).map(|vertex| world(scene, vertex))
}

fn area(scene: &Scene) -> f64 {
    let triangle = |id: u32| {
        let [a, b, c] = scene.mesh.corners(id).map(|p| p.map(f64::from));
        let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        0.5 * n.iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    (0..scene.mesh.len() as u32).map(triangle).sum()
}

#[test]
fn solids_of_every_kind() {
    let surfaces = &CUBE[1..CUBE.len() - 1];
    let (solids, kinds) = (format!("[{CUBE}]"), ["MultiSurface", "CompositeSurface"]);
    let surfaces = kinds.map(|kind| geometry(kind, "1", surfaces));
    let solids = ["MultiSolid", "CompositeSolid"].map(|kind| geometry(kind, "\"1.2\"", &solids));
    for one in surfaces.into_iter().chain(solids).chain([geometry("Solid", "\"2\"", CUBE)]) {
        let scene = city(&model(&object("house", &[one]), ""));
        assert_eq!((scene.mesh.len(), scene.mesh.vertices().len()), (12, 8));
        assert_eq!(area(&scene), 150.0);
        assert_eq!(world(&scene, scene.mesh.vertices()[0]), [100.0, 200.0, 0.0]);
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        assert_eq!((scene.materials.len(), scene.material(0).name.as_str()), (1, "Building"));
    }
}

#[test]
fn holes_take_two_triangles_more() {
    let roof = geometry("MultiSurface", "2", "[[[4,5,6,7],[8,9,10,11]],[[0,1,2]]]");
    let scene = city(&model(&object("house", &[roof]), ""));
    assert_eq!(scene.mesh.len(), 4 + 4 - 2 + 2 + 1);
    assert_eq!(area(&scene), 25.0 - 1.0 + 12.5);
    // A hole of a courtyard goes through: a solid of two shells.
    let shells = format!("[{},[[[8,9,10]]]]", &CUBE[1..CUBE.len() - 1]);
    assert_eq!(city(&model(&object("house", &[geometry("Solid", "2", &shells)]), "")).mesh.len(), 13);
}

#[test]
fn the_highest_level_of_detail_of_each_object() {
    let square =
        |lod: &str, z: u32| geometry("MultiSurface", lod, &format!("[[[{},{},{}]]]", z, z + 1, z + 2));
    let first = object(
        "a",
        &[
            square("\"1.2\"", 0),
            square("\"2.2\"", 4),
            square("\"1.3\"", 0),
            geometry("MultiPoint", "3", "[0]"),
        ],
    );
    let second = object("b", &[square("0", 0)]);
    let scene = city(&model(&format!("{first},{second}"), ""));
    assert_eq!(scene.mesh.len(), 2);
    assert_eq!((scene.mesh.corners(0)[0][2], scene.mesh.corners(1)[0][2]), (5.0, 0.0));
    assert_eq!(scene.warnings[0].count(), Some((2, 5)));
    assert!(scene.warnings[0].text().contains("1 of LoD 1.2, 1 of LoD 1.3"), "{}", scene.warnings[0]);
    assert_eq!(scene.warnings[1].count(), Some((1, 5)));
}

#[test]
fn surfaces_have_names_and_colours() {
    let semantics =
        r#""semantics":{"surfaces":[{"type":"RoofSurface"},{"type":"WallSurface"}],"values":[0,null,1]}"#;
    let three = geometry("MultiSurface", "2", "[[[0,1,2]],[[0,1,3]],[[0,2,3]]]");
    let named = three.replace(r#""lod""#, &format!(r#"{semantics},"lod""#));
    let scene = city(&model(&object("house", std::slice::from_ref(&named)), ""));
    let names: Vec<_> = (0..3).map(|id| scene.material(id).name.as_str()).collect();
    assert_eq!(names, ["RoofSurface", "Building", "WallSurface"]);
    let appearance = r#""appearance":{"materials":[{"name":"red","diffuseColor":[1,0,0]},{"name":"glass","transparency":0.5}],"textures":[{}]},"#;
    let painted =
        named.replace(r#""lod""#, r#""material":{"day":{"values":[1,0,null]},"night":{"value":0}},"lod""#);
    let scene = city(&model(&object("house", &[painted]), appearance));
    let names: Vec<_> = (0..3).map(|id| scene.material(id).name.as_str()).collect();
    assert_eq!(names, ["glass", "red", "WallSurface"]);
    assert_eq!(
        (scene.material(0).transmission, scene.material(1).diffuse.to_array()),
        (0.5, [1.0, 0.0, 0.0])
    );
    assert_eq!(scene.warnings[0].text(), "1 of 1 textures were left out");
    // Lists of another length, or nothing where a list belongs, say nothing.
    for values in ["null", "[0]", "[0,1,2,3]", "[[0],[1]]"] {
        let odd = named.replace("[0,null,1]", values);
        assert_eq!(city(&model(&object("house", &[odd]), "")).material(0).name, "Building", "{values}");
    }
}

#[test]
fn templates_are_drawn_where_their_instances_are() {
    let templates = r#""geometry-templates":{"templates":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2]],[[0,1,2]]]}],
        "vertices-templates":[[0,0,0],[1,0,0],[0,1,0.5]]},"#;
    let tree = |at: u32, matrix: &str| {
        format!(
            r#"{{"type":"GeometryInstance","template":0,"boundaries":[{at}],"transformationMatrix":[{matrix}]}}"#
        )
    };
    let moved = tree(6, "2,0,0,7, 0,2,0,0, 0,0,2,0, 0,0,0,1");
    let mirrored = tree(0, "-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1");
    let scene = city(&model(&format!("{},{}", object("a", &[moved]), object("b", &[mirrored])), templates));
    assert_eq!(scene.mesh.len(), 4);
    assert_eq!(corners(&scene, 0), [[112.0, 205.0, 5.0], [114.0, 205.0, 5.0], [112.0, 207.0, 6.0]]);
    assert_eq!(corners(&scene, 2)[0], [100.0, 200.0, 0.0]);
    // Mirrored, two corners change places, so that it faces the same way.
    assert_eq!(corners(&scene, 2)[2], [99.0, 200.0, 0.0]);
    for wrong in [tree(99, "1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1"), tree(0, "").replace(":0,\"b", ":5,\"b")] {
        let error = load_bytes(Format::CityJson, model(&object("a", &[wrong]), templates).as_bytes());
        assert!(matches!(error, Err(LoadError::Invalid { .. })));
    }
}

/// Templates are triangulated once, and what instances cost is counted.
#[test]
fn many_instances_of_much_that_is_no_triangle() {
    let empty = "[],".repeat(100_000);
    let templates = format!(
        r#""geometry-templates":{{"templates":[{{"type":"MultiSurface","lod":"2","boundaries":[{empty}[[0,1,2]]]}}],"vertices-templates":[[0,0,0],[1,0,0],[0,1,0]]}},"#
    );
    let places: Vec<String> = (0..20_000)
        .map(|k| {
            object(
                &k.to_string(),
                &[r#"{"type":"GeometryInstance","template":0,"boundaries":[0]}"#.to_owned()],
            )
        })
        .collect();
    let scene = city(&model(&places.join(","), &templates));
    assert_eq!((scene.mesh.len(), scene.warnings.len()), (20_000, 1));
    let many = format!("{}[0,0,0]", "[0,0,0],".repeat(200_000));
    let templates = templates.replace("[0,1,0]]}", &format!("[0,1,0],{many}]}}"));
    let loaded = load_bytes(Format::CityJson, model(&places.join(","), &templates).as_bytes());
    assert!(matches!(loaded, Err(LoadError::OutOfProportion { .. })));
}

#[test]
fn sequences_share_their_transform() {
    let head = model("", "").replace('\n', " ");
    let feature = |name: &str, x: u32| {
        let shape = geometry("MultiSurface", "\"2\"", "[[[0,1,2]]]");
        format!(
            r#"{{"type":"CityJSONFeature","id":"{name}","CityObjects":{{{}}},"vertices":[[{x},0,0],[{x},2,0],[{x},0,2]]}}"#,
            object(name, &[shape])
        )
    };
    let lines = [head.clone(), feature("b", 2), String::new(), feature("a", 4)];
    let scene = load_bytes(Format::CityJsonSeq, lines.join("\r\n").as_bytes()).unwrap();
    assert_eq!(corners(&scene, 0), [[101.0, 200.0, 0.0], [101.0, 201.0, 0.0], [101.0, 200.0, 1.0]]);
    assert_eq!(corners(&scene, 1)[0], [102.0, 200.0, 0.0]);
    for lines in [vec![feature("a", 1)], vec![String::from("\n")], vec![head, "{\"type\":\"House\"}".into()]]
    {
        assert!(load_bytes(Format::CityJsonSeq, lines.join("\n").as_bytes()).is_err());
    }
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in [("a.city.jsonl", lines.join("\n")), ("A.JSONL", lines.join("\n"))] {
        fs::write(folder.path().join(name), content).unwrap();
        assert_eq!(load(folder.path().join(name)).unwrap().mesh.len(), 2);
    }
    for name in ["b.city.json", "b.json"] {
        fs::write(folder.path().join(name), model(&object("a", &[geometry("Solid", "1", CUBE)]), ""))
            .unwrap();
        let scene = load(folder.path().join(name)).unwrap();
        assert_eq!((scene.mesh.len(), scene.name.as_str()), (12, "b"));
    }
}

#[test]
fn far_coordinates_are_f64_until_the_end() {
    let far = model(&object("a", &[geometry("Solid", "1", CUBE)]), "")
        .replace("[100,200,0]", "[85000.05,446000.03,0]")
        .replace("[0.5,0.5,0.5]", "[0.001,0.001,0.001]");
    let near = city(&far);
    // With an origin, nothing of the file's steps is lost.
    assert!(near.rounding < 1e-8 && near.warnings.is_empty(), "{} {:?}", near.rounding, near.warnings);
    let wanted = [85000.06, 446000.04, 0.01];
    let found = world(&near, near.mesh.vertices()[6]);
    assert!((0..3).all(|k| (found[k] - wanted[k]).abs() < 1e-8), "{found:?}");
    let none = LoadOptions::new().origin(Origin::None);
    let scene = load_bytes_with(Format::CityJson, far.as_bytes(), &none).unwrap();
    assert_eq!(scene.mesh.vertices()[6], [85000.06_f64 as f32, 446000.04_f64 as f32, 0.01]);
    assert_eq!(scene.warnings[0].kind, WarningKind::Precision);
    let bare = model(&object("a", &[geometry("Solid", "1", CUBE)]), "")
        .replace(r#""transform":{"scale":[0.5,0.5,0.5],"translate":[100,200,0]},"#, "");
    assert_eq!(city(&bare).mesh.vertices()[6], [10.0, 10.0, 10.0]);
}

#[test]
fn broken_models_are_errors() {
    let of = |kind: &str, boundaries: &str| model(&object("a", &[geometry(kind, "1", boundaries)]), "");
    for text in [
        String::new(),
        "{".to_owned(),
        "[]".to_owned(),
        r#"{"type":"FeatureCollection"}"#.to_owned(),
        of("MultiSurface", "[[[0,1,12]]]"),
        of("MultiSurface", "[[[0,1,-1]]]"),
        of("MultiSurface", "[[[0,1,1.5]]]"),
        of("MultiSurface", "[[[0,1,null]]]"),
        of("MultiSurface", "[[0,1,2]]"),
        of("Solid", "[[[0,1,2]]]"),
        of("MultiSurface", "[[[0,[1],2]]]"),
        of("MultiSurface", "[[[0,1,2]],[0]]"),
        of("MultiSurface", &format!("{}{}", "[".repeat(100), "]".repeat(100))),
        model(&"[".repeat(100_000), ""),
    ] {
        let loaded = load_bytes(Format::CityJson, text.as_bytes());
        assert!(matches!(loaded, Err(LoadError::Invalid { .. } | LoadError::Empty)), "{text}");
    }
    // Empty lists and rings that are too short are no errors.
    for (boundaries, triangles, warnings) in [
        ("[]", 0, 0),
        ("[[]]", 0, 0),
        ("[[[]],[[0,1,2]]]", 1, 1),
        ("[[[0,1]],[[0,1,2],[3]]]", 1, 1),
        ("[[[0,1,2,3]]]", 2, 0),
    ] {
        let scene = city(&of("MultiSurface", boundaries));
        assert_eq!((scene.mesh.len(), scene.warnings.len()), (triangles, warnings), "{boundaries}");
    }
    let text = of("Solid", CUBE);
    for length in 0..text.len() {
        assert!(load_bytes(Format::CityJson, &text.as_bytes()[..length]).is_err());
    }
}
