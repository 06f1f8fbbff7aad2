//! `--device` of render, bench and report; a software GPU is enough.
#![cfg(feature = "gpu")]

use crate::common::Tool;

/// Whether there is any adapter.
fn there_is_one(tool: &Tool) -> bool {
    let there = tool.ok("devices").stdout.contains("gpu  ");
    if !there {
        slimkd_util::missing("gpu", "Debian: apt-get install mesa-vulkan-drivers");
    }
    there
}

#[test]
fn a_gpu_renders_what_the_cpu_renders() {
    let tool = Tool::new();
    if !there_is_one(&tool) {
        return;
    }
    let line = "render kitchen --triangles 3000 --size 48x32 --spp 1";
    tool.ok(&format!("{line} -o cpu.png"));
    let run = tool.ok(&format!("{line} --device gpu -o gpu.png"));
    assert!(
        run.stderr.contains("slimkd: on ") && run.stderr.contains("wrote gpu.png: 48 x 32"),
        "{}",
        run.stderr
    );
    let read = |name: &str| {
        let bytes = std::fs::read(tool.path(name)).unwrap();
        slimkd_util::png::read(&bytes, |_| Ok(1 << 30)).unwrap().1
    };
    let (cpu, gpu) = (read("cpu.png"), read("gpu.png"));
    let apart = cpu.iter().zip(&gpu).filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1));
    assert!(apart.count() <= 1);
}

#[test]
fn bench_and_report_measure_a_gpu() {
    let tool = Tool::new();
    if !there_is_one(&tool) {
        return;
    }
    let json = tool.json(
        "bench kitchen --triangles 2000 --presets standard,slim --rays 500 --device cpu,gpu --frames --size 16x16 \
         --view 1 --json",
    );
    for (list, each) in [("results", 8), ("frames", 2)] {
        for device in ["cpu", "gpu"] {
            let on = json[list].as_array().unwrap().iter().filter(|entry| entry["device"] == device);
            assert_eq!(on.clone().count(), each, "{list} on {device}");
            assert!(on.into_iter().all(|entry| entry["threads"] == 1));
        }
    }
    let line =
        "report kitchen --triangles 1500 --quick --size 16x16 --threads 1 --scaling 0 --device gpu -o out";
    tool.ok(line);
    let raw = std::fs::read(tool.path("out/raw.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&raw).unwrap();
    assert!(json["machine"]["gpu"].is_string(), "{}", json["machine"]);
    let frames = json["scenes"][0]["frames"].as_array().unwrap();
    let on = |device: &str| frames.iter().filter(|unit| unit["device"] == device).count();
    assert_eq!((on("cpu"), on("gpu")), (frames.len() / 2, frames.len() / 2));
    // What is there is not measured again.
    tool.ok(line);
    let again: serde_json::Value =
        serde_json::from_slice(&std::fs::read(tool.path("out/raw.json")).unwrap()).unwrap();
    assert_eq!(again["scenes"], json["scenes"]);
}

/// Vulkan's loader finds no driver.
#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter_there_is_an_error_or_the_cpu() {
    let tool = Tool::new();
    let run = |line: &str| {
        let mut command = tool.command(line);
        for name in ["VK_ICD_FILENAMES", "VK_DRIVER_FILES"] {
            command.env(name, "/nonexistent.json");
        }
        let output = command.env_remove("XDG_RUNTIME_DIR").output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    for line in ["render kitchen --triangles 500 --size 8x8", "bench kitchen --triangles 500"] {
        let (status, stderr) = run(&format!("{line} --device gpu"));
        assert_eq!(status, Some(1), "{stderr}");
        assert!(stderr.starts_with("slimkd: error: no GPU") && stderr.lines().count() == 1, "{stderr}");
    }
    let (status, stderr) = run("render kitchen --triangles 500 --size 8x8 --device auto --quiet");
    assert_eq!((status, stderr.as_str()), (Some(0), ""));
    assert!(tool.path("out.png").exists());
}

/// Mesa says nothing of its own.
#[test]
fn an_adapter_adds_no_line() {
    let tool = Tool::new();
    let output = tool.command("devices").env_remove("XDG_RUNTIME_DIR").output().unwrap();
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}
