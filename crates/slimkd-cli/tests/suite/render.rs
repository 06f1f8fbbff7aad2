//! `slimkd render`, `scene` and `completions`: what people get.

use crate::common::{Tool, square};

/// Width and height of a PNG, from its header.
fn png_size(bytes: &[u8]) -> (u32, u32) {
    assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n");
    let word = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    (word(16), word(20))
}

#[test]
fn without_a_scene_the_kitchen_is_rendered_and_presets_are_compared() {
    let tool = Tool::new();
    let run = tool.ok("render --triangles 4000 --size 40x30 --spp 1");
    assert_eq!(png_size(&std::fs::read(tool.path("out.png")).unwrap()), (40, 30));
    for preset in slimkd::Preset::ALL {
        assert!(run.stdout.lines().any(|line| line.starts_with(preset.name())), "{}", run.stdout);
    }
    assert!(run.stdout.contains("4,000 triangles") && run.stdout.contains("% of standard"), "{}", run.stdout);
    assert!(run.stderr.contains("wrote out.png: 40 x 30"), "{}", run.stderr);

    let quiet = tool.ok("render --triangles 4000 --size 40x30 --spp 1 --quiet");
    assert_eq!((quiet.stdout, quiet.stderr), (String::new(), String::new()));
}

#[test]
fn every_preset_and_thread_count_gives_the_same_picture() {
    let tool = Tool::new();
    let mut pictures = Vec::new();
    for preset in slimkd::Preset::ALL {
        for threads in [1, 3] {
            let name = format!("{}-{threads}.png", preset.name());
            tool.ok(&format!(
                "render kitchen --triangles 4000 --size 64x64 --spp 2 --preset {} --threads {threads} -o {name}",
                preset.name()
            ));
            pictures.push(std::fs::read(tool.path(&name)).unwrap());
        }
    }
    assert!(pictures.iter().all(|picture| *picture == pictures[0]));
}

#[test]
fn views_cameras_and_exposures_make_different_pictures() {
    let tool = Tool::new();
    let mut pictures = Vec::new();
    for options in [
        "--view 1",
        "--view 2",
        "--view 3",
        "--camera -1,1.5,-1,1,1,1",
        "--camera -1,1.5,-1,1,1,1,30",
        "--camera -1,1.5,-1,1,1,1 --up x",
        "--view 1 --exposure -1.5",
        "--view 1 --tone clamp --bounces 0",
        "--view 1 --bits 16",
    ] {
        tool.ok(&format!("render kitchen --triangles 3000 --size 32x32 --spp 1 -o a.png {options}"));
        let picture = std::fs::read(tool.path("a.png")).unwrap();
        assert!(!pictures.contains(&picture), "{options}");
        pictures.push(picture);
    }
}

#[test]
fn a_file_without_cameras_gets_views() {
    let tool = Tool::new();
    tool.ok("scene kitchen --triangles 3000 -o bare.ply");
    for view in 1..=3 {
        tool.ok(&format!("render bare.ply --size 16x16 --spp 1 --up y --view {view} -o {view}.png"));
    }
    let pictures = [1, 2, 3].map(|view| std::fs::read(tool.path(&format!("{view}.png"))).unwrap());
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2]);
    tool.file("square.ply", square());
    tool.ok("render square.ply --size 16x16 -o square.exr");
    assert_eq!(std::fs::read(tool.path("square.exr")).unwrap()[..4], [0x76, 0x2f, 0x31, 0x01]);
}

#[test]
fn impossible_cameras_are_refused() {
    let tool = Tool::new();
    tool.file("square.ply", square());
    tool.fails("render square.ply --size 8x8 --camera 0,0,0,0,1,0 --up y", 1, &["up"]);
    assert!(!tool.files().contains("out.png"));
}

#[test]
fn built_in_scenes_survive_their_file() {
    let tool = Tool::new();
    let list = tool.ok("scene --list").stdout;
    for scene in slimkd_scene::procedural::list() {
        assert!(list.contains(scene.name), "{list}");
        let run = tool.ok(&format!("scene {} --triangles 9000 -o a.ply", scene.name));
        let loaded = slimkd_scene::load(tool.path("a.ply")).unwrap();
        let generated = slimkd_scene::procedural::generate(scene.name, 9000).unwrap();
        assert!(loaded.mesh == generated.mesh, "{}", scene.name);
        assert!(run.stderr.contains("wrote a.ply"), "{}", run.stderr);
    }
}

#[test]
fn shells_get_their_scripts() {
    let tool = Tool::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = tool.ok(&format!("completions {shell}")).stdout;
        assert!(script.contains("--preset") || script.contains("-l preset"), "{shell}");
    }
}
