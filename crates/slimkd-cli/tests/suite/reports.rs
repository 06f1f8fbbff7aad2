//! `build`, `inspect` and `bench`: what scripts read.

use crate::common::{Tool, keys, set, square};
use serde_json::Value;

const REPORT: &str = "schema scene.triangles scene.vertices scene.degenerate scene.origin[] preset threads sah.traversal \
    sah.intersection sah.empty_bonus nodes.inner nodes.t_inner nodes.leaf nodes.empty_leaf references.leaf_4byte \
    references.leaf_2byte references.leaf_other references.t bytes.nodes bytes.t_references bytes.indices \
    bytes.id_map bytes.triangle_copies bytes.other bytes.tree bytes.mesh bytes.geometry bytes.resident bytes.build_peak \
    tree_bytes_per_triangle max_depth sah_cost seconds.load seconds.build";

/// What `inspect` says of the mesh besides.
const MESH_CHECK: &str = "mesh_check.coarse mesh_check.degenerate_triangles mesh_check.duplicate_triangles \
    mesh_check.flipped_edges mesh_check.maximum[] mesh_check.mean_edge mesh_check.minimum[] mesh_check.non_manifold_edges \
    mesh_check.open_edges mesh_check.parts mesh_check.step";

fn presets() -> Vec<&'static str> {
    slimkd::Preset::ALL.iter().map(|preset| preset.name()).collect()
}

#[test]
fn reports_have_exactly_the_documented_keys() {
    let tool = Tool::new();
    for preset in presets() {
        for command in ["build", "inspect"] {
            let line = format!("{command} kitchen --triangles 4000 --preset {preset} --threads 2 --json");
            let json = tool.json(&line);
            let more = if command == "inspect" { MESH_CHECK } else { "" };
            assert_eq!(keys(&json), set(&format!("{REPORT} {more}")), "{line}");
            assert_eq!(json["schema"], 1);
            assert_eq!(json["scene"]["triangles"], 4000);
            assert_eq!(json["preset"], preset);
            assert_eq!(json["threads"], 2);
        }
    }
    // A list that is not empty is a list of lines.
    tool.file("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nnonsense\n");
    let keys_of = |line: &str| keys(&tool.json(line));
    assert_eq!(keys_of("build lines.obj --json"), set(&format!("{REPORT} warnings[]")));
    assert_eq!(keys_of("inspect lines.obj --json"), set(&format!("{REPORT} {MESH_CHECK} warnings[]")));
}

#[test]
fn sums_add_up() {
    let tool = Tool::new();
    for preset in presets() {
        let json = tool.json(&format!("build kitchen --triangles 4000 --preset {preset} --json"));
        let number = |pointer: &str| json.pointer(pointer).and_then(Value::as_u64).unwrap();
        let parts = ["nodes", "t_references", "indices", "id_map", "triangle_copies", "other"];
        let tree: u64 = parts.iter().map(|part| number(&format!("/bytes/{part}"))).sum();
        assert_eq!(number("/bytes/tree"), tree);
        assert_eq!(number("/bytes/mesh"), 12 * (4000 + number("/scene/vertices")));
        assert_eq!(number("/bytes/resident"), tree + number("/bytes/mesh"));
        // The finished tree is alive at the end of the build.
        assert!(number("/bytes/build_peak") >= tree, "{json}");
        assert_eq!(json["tree_bytes_per_triangle"].as_f64().unwrap(), tree as f64 / 4000.0);
    }
}

#[test]
fn the_library_counts_the_same() {
    let tool = Tool::new();
    let json = tool.json("build kitchen --triangles 4000 --preset standard --json");
    let mesh = slimkd_scene::procedural::generate("kitchen", 4000).unwrap().mesh;
    let tree = slimkd::KdTree::build(mesh, &slimkd::Preset::Standard.into()).unwrap();
    let statistics = tree.statistics();
    assert_eq!(json["nodes"]["inner"], statistics.nodes.inner);
    assert_eq!(json["nodes"]["leaf"], statistics.nodes.leaf);
    assert_eq!(json["references"]["leaf_4byte"], statistics.leaf_references.four_byte);
    assert_eq!(json["max_depth"], statistics.max_depth);
    assert_eq!(json["sah_cost"], statistics.sah_cost);
    assert_eq!(json["bytes"]["tree"], tree.memory().tree());
}

#[test]
fn constants_can_be_set() {
    let tool = Tool::new();
    let line =
        "build kitchen --triangles 4000 --sah-traversal 30 --sah-intersection 2.5 --empty-bonus 0.8 --json";
    let json = tool.json(line);
    let sah: [f64; 3] =
        ["traversal", "intersection", "empty_bonus"].map(|key| json["sah"][key].as_f64().unwrap());
    assert_eq!(sah, [30.0, 2.5, 0.8]);
    let plain = tool.json("build kitchen --triangles 4000 --json");
    assert!(json["nodes"]["leaf"].as_u64() < plain["nodes"]["leaf"].as_u64());
}

/// The savings of every preset, and of a tree with all of them, add up, and each is what two builds differ by.
#[test]
fn savings_add_up() {
    let tool = Tool::new();
    // Without a weight of bytes: that prices each layout's own, so the nodes would differ.
    let all = "standard --occupancy 0.5 --frequency 0.4 --collapse --layout two-byte";
    for choice in presets().into_iter().chain([all]) {
        let json = tool.json(&format!("build kitchen --triangles 4000 --preset {choice} --savings --json"));
        let with_savings =
            format!("{REPORT} savings.baseline savings.hoisting savings.collapse savings.layout");
        assert_eq!(keys(&json), set(&with_savings));
        let saved = |step: &str| json["savings"][step].as_i64().unwrap();
        let steps: i64 = ["hoisting", "collapse", "layout"].into_iter().map(saved).sum();
        assert_eq!(saved("baseline") - steps, json["bytes"]["tree"].as_i64().unwrap(), "{choice}");
        if json["references"]["leaf_other"] == 0 {
            assert_eq!(saved("layout"), 2 * json["references"]["leaf_2byte"].as_i64().unwrap());
        }
        if choice == "standard" {
            assert_eq!(steps, 0);
        }
        if choice == all {
            assert!(["hoisting", "collapse", "layout"].into_iter().all(|step| saved(step) > 0), "{json}");
            let bytes = |line: &str| {
                tool.json(&format!("build kitchen --triangles 4000 --preset {line} --json"))["bytes"]["tree"]
                    .as_i64()
                    .unwrap()
            };
            assert_eq!(bytes(&all.replace("two-byte", "four-byte")), bytes(all) + saved("layout"));
            assert_eq!(bytes("standard"), saved("baseline"));
            let hoisted = bytes("standard --occupancy 0.5 --frequency 0.4");
            assert_eq!(saved("hoisting"), saved("baseline") - hoisted);
        }
    }
}

#[test]
fn the_table_tells_the_savings_apart() {
    let tool = Tool::new();
    let table = tool.ok("build kitchen --triangles 4000 --preset paper-small --savings").stdout;
    for line in ["hoisting above occupancy 0.5", "standard-style ", "- hoisting ", "- layout "] {
        assert!(table.contains(line), "{line}: {table}");
    }
    let plain = tool.ok("build kitchen --triangles 4000 --preset paper-small").stdout;
    assert!(plain.lines().last().unwrap().contains("--savings"), "{plain}");
}

/// Dense trees hold no T-references, whatever the preset would like.
#[test]
fn the_table_names_the_layout_that_is_written() {
    let tool = Tool::new();
    let options = |choice: &str| {
        let table = tool.ok(&format!("build kitchen --triangles 4000 {choice} -o tree.skd")).stdout;
        let line = |text: &str| text.lines().find(|line| line.starts_with("options")).unwrap().to_owned();
        assert_eq!(line(&tool.ok("inspect tree.skd").stdout), line(&table), "{choice}");
        line(&table)
    };
    assert!(options("").ends_with(", dense layout"));
    assert!(options("--preset standard").ends_with(", 4-byte leaves alone"));
    assert!(options("--preset paper-fast").ends_with(", 2-byte leaves"));
    let cannot = ", 2-byte leaves (the dense layout cannot hold it)";
    assert!(options("--occupancy 0.5 --frequency 0.4").ends_with(cannot));
    assert!(options("--preset paper-small --layout dense").ends_with(cannot));
    // Nothing is hoisted, so nothing stands in the way.
    assert!(options("--occupancy 1 --frequency 1").contains("hoisting above"));
}

#[test]
fn thread_counts_do_not_show_in_the_tree() {
    let tool = Tool::new();
    let shape = |threads: u32| {
        let mut json = tool.json(&format!("build kitchen --triangles 6000 --threads {threads} --json"));
        for varying in ["seconds", "threads", "bytes"] {
            json.as_object_mut().unwrap().remove(varying);
        }
        json
    };
    assert_eq!(shape(1), shape(3));
}

#[test]
fn tables_for_people() {
    let tool = Tool::new();
    let table = tool.ok("build kitchen --triangles 4000").stdout;
    let default = slimkd::Preset::default().name();
    for word in ["4,000 triangles", default, "leaves", "B/triangle", "build peak", "SAH cost"] {
        assert!(table.contains(word), "{word}: {table}");
    }
    let longer = tool.ok("inspect kitchen --triangles 4000").stdout;
    assert!(longer.contains("depth of a leaf") && longer.contains("references of a triangle"), "{longer}");
}

#[test]
fn bench_reports_every_preset_and_workload() {
    let tool = Tool::new();
    let json = tool.json("bench kitchen --triangles 3000 --rays 2000 --json");
    assert_eq!(
        keys(&json),
        set(
            "results[].preset results[].kernel results[].device results[].threads results[].workload results[].rays \
             results[].hits results[].mrays_per_s"
        )
    );
    let results = json["results"].as_array().unwrap();
    for preset in presets() {
        for workload in ["primary", "shadow", "bounce", "random"] {
            let matching: Vec<_> =
                results.iter().filter(|r| r["preset"] == preset && r["workload"] == workload).collect();
            assert_eq!(matching.len(), 1, "{preset} {workload}");
            let result = matching[0];
            assert_eq!((&result["kernel"], &result["device"]), (&"single".into(), &"cpu".into()));
            assert_eq!(result["threads"], 1);
            assert!(result["hits"].as_u64() <= result["rays"].as_u64());
            assert!(result["rays"].as_u64() > Some(0) && result["mrays_per_s"].as_f64() > Some(0.0));
        }
    }
    assert_eq!(results.len(), 4 * presets().len());
    let hits = |preset: &str| -> Vec<_> {
        results.iter().filter(|r| r["preset"] == preset).map(|r| (&r["workload"], &r["hits"])).collect()
    };
    assert!(presets().iter().all(|preset| hits(preset) == hits("standard")));
}

#[test]
fn bench_measures_pictures_too() {
    let tool = Tool::new();
    tool.file("square.ply", square());
    let line = "bench square.ply --presets standard,paper-fast,standard --rays 100 --camera 0.5,0.5,3,0.5,0.5,0 \
                --frames --threads 2 --json";
    let json = tool.json(line);
    let frames = json["frames"].as_array().unwrap();
    assert_eq!(keys(&json["frames"]), set("[].preset [].device [].threads [].view [].frames_per_s"));
    assert_eq!(frames.len(), 2, "a preset that is named twice is measured once");
    assert!(frames.iter().all(|frame| frame["view"] == 1 && frame["threads"] == 2));

    let json = tool.json(&line.replace("--threads 2", "--threads 1,2 --size 32x16"));
    let threads = |key: &str| -> Vec<_> {
        json[key].as_array().unwrap().iter().map(|result| result["threads"].as_u64().unwrap()).collect()
    };
    assert_eq!(threads("frames"), [1, 1, 2, 2]);
    assert_eq!(
        threads("results").iter().filter(|&&threads| threads == 2).count() * 2,
        threads("results").len()
    );
    let table = tool.ok(&line.replace("--threads 2 --json", "--threads 1,2 --size 32x16")).stdout;
    for words in ["view 1, 1 thread (32 x 16,", "view 1, 2 threads (32 x 16,", "frames/s    (0.0 %)"] {
        assert!(table.contains(words), "{words}: {table}");
    }
}

#[test]
fn bench_prints_shares_and_rates() {
    let tool = Tool::new();
    let run = tool.ok("bench kitchen --triangles 3000 --rays 500 --presets standard --view 2");
    assert!(run.stdout.contains("random (500 rays,") && run.stdout.contains("Mrays/s"), "{}", run.stdout);
    assert!(run.stderr.contains("% hit"), "{}", run.stderr);
}

#[test]
fn a_report_goes_on_and_is_written_again() {
    let tool = Tool::new();
    let line = "report kitchen --triangles 2700 --quick --size 16x16 --threads 1 --scaling 0 -o out";
    tool.fails(&format!("{line} --time-limit 0"), 1, &["time is up", "run the same command again"]);
    assert!(!tool.path("out/index.html").exists());
    tool.ok(line);
    let page = std::fs::read(tool.path("out/index.html")).unwrap();
    tool.ok("report --from out/raw.json -o again");
    // The pictures stay where they were measured.
    assert!(std::fs::read(tool.path("again/index.html")).unwrap() == page);
    for (wrong, status) in [
        ("report --from out/index.html -o x", 1),
        ("report nosuch.ply -o x", 1),
        ("report kitchen --size 32x16 -o x", 2),
        ("report kitchen --from out/raw.json -o x", 2),
        ("report kitchen", 2),
    ] {
        tool.fails(wrong, status, &[]);
    }
}
