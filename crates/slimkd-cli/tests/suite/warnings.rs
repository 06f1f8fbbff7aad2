//! What a scene's loader warns of reaches the user: on stderr, in JSON, and as an error where that is asked for.

use crate::common::Tool;

const ODD: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\nnonsense 1 2\n";

#[test]
fn warnings_are_printed_listed_hidden_and_made_errors() {
    let tool = Tool::new();
    tool.file("odd.obj", ODD);
    for command in ["build odd.obj", "inspect odd.obj"] {
        let json = tool.json(&format!("{command} --json"));
        let listed: Vec<&str> =
            json["warnings"].as_array().unwrap().iter().map(|warning| warning.as_str().unwrap()).collect();
        assert_eq!(listed.len(), 2, "{listed:?}");
        assert!(listed.iter().any(|warning| warning.starts_with("1 of 2 faces")), "{listed:?}");
        let shown = tool.ok(command).stderr;
        assert_eq!(shown.matches("warning: odd.obj: ").count(), 2, "{shown}");
        assert_eq!(tool.ok(&format!("{command} --quiet")).stderr, "");
        tool.fails(&format!("{command} --strict --quiet"), 1, &["odd.obj", "--strict"]);
    }
}

#[test]
fn measuring_warns_too() {
    let tool = Tool::new();
    // Collinear corners, which only the mesh tells.
    tool.file("thin.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n");
    let bench = "bench thin.obj --presets standard --rounds 5 --rays 64";
    let json = tool.json(&format!("{bench} --json"));
    assert!(json["warnings"][0].as_str().unwrap().starts_with("1 of 2 triangles"), "{json}");
    for command in [bench, "report thin.obj -o report --quick"] {
        tool.fails(&format!("{command} --strict --quiet"), 1, &["thin.obj", "1 of 2 triangles", "--strict"]);
    }
    assert!(!tool.files().contains("report"));
}

#[test]
fn several_models_are_one_scene_and_are_converted() {
    let tool = Tool::new();
    tool.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    tool.file("b.off", "OFF\n4 1 0\n0 0 1\n4 0 1\n1 1 1\n0 4 1\n4 0 1 2 3\n");
    tool.ok("convert a.obj b.off -o both.ply");
    for command in ["build a.obj b.off --json", "inspect both.ply --json"] {
        let json = tool.json(command);
        assert_eq!(json["scene"]["triangles"], 3, "{command}");
        assert_eq!(json["scene"]["vertices"], 7, "{command}");
    }
    let check = &tool.json("inspect both.ply --json")["mesh_check"];
    assert_eq!((&check["parts"], &check["open_edges"]), (&2.into(), &7.into()));
    // Each built-in scene has so many triangles.
    let json = tool.json("build kitchen a.obj kitchen --triangles 3000 --json");
    assert_eq!(json["scene"]["triangles"], 6001);
    tool.fails("build a.obj b.off --triangles 10", 2, &["--triangles", "built-in"]);
    // Of several files, each warning names its own.
    tool.file("odd.obj", ODD);
    let warnings = &tool.json("build a.obj odd.obj --json")["warnings"];
    let warnings: Vec<_> = warnings.as_array().unwrap().iter().map(|text| text.as_str().unwrap()).collect();
    assert!(warnings.len() == 2 && warnings.iter().all(|text| text.starts_with("odd.obj: ")), "{warnings:?}");
    tool.fails("convert a.obj b.off -o a.obj", 2, &["a.obj"]);
    tool.fails("convert a.obj b.off -o a.stl", 2, &["end the name in .ply"]);
    tool.fails("convert a.obj nothing.off -o c.ply", 1, &["nothing.off"]);
    assert!(!tool.files().contains("c.ply"));
    // Colours of vertices and of faces are kept.
    tool.file("red.obj", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n");
    tool.ok("convert red.obj b.off -o red.ply");
    let colours = slimkd_scene::load(tool.path("red.ply")).unwrap().colours.unwrap();
    assert_eq!((colours.values[0], colours.values[3]), ([255, 0, 0, 255], [255; 4]));
}

#[test]
fn pictures_and_rates_of_several_models() {
    let tool = Tool::new();
    tool.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    tool.file("b.off", "OFF\n4 1 0\n0 0 1\n4 0 1\n1 1 1\n0 4 1\n4 0 1 2 3\n");
    tool.ok("convert a.obj b.off -o both.ply");
    for (scene, picture) in [("a.obj b.off", "two.png"), ("both.ply", "one.png")] {
        tool.ok(&format!("render {scene} --size 24x24 --spp 1 -o {picture}"));
    }
    let read = |name: &str| std::fs::read(tool.path(name)).unwrap();
    assert_eq!(read("two.png"), read("one.png"));
    let bench = "--presets standard --rounds 5 --rays 64 --json";
    let rows =
        |scene: &str| tool.json(&format!("bench {scene} {bench}"))["results"].as_array().unwrap().clone();
    let hits = |rows: Vec<serde_json::Value>| rows.iter().map(|row| row["hits"].clone()).collect::<Vec<_>>();
    assert_eq!(hits(rows("a.obj b.off")), hits(rows("both.ply")));
    tool.ok("build a.obj -o tree.skd");
    for command in ["render a.obj tree.skd -o c.png", "bench tree.skd a.obj"] {
        tool.fails(command, 2, &["tree.skd", "a saved tree is a scene alone"]);
    }
    tool.fails("render a.obj b.off -o b.off", 2, &[]);
    assert!(!tool.files().contains("c.png"));
}
