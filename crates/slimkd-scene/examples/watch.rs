//! How honest a build's progress is, and how soon it ends when it is cancelled.
//!
//! ```text
//! cargo run --release -p slimkd-scene --example watch -- SCENE [PRESET] [THREADS] [CANCELS]
//! ```
//! Builds once while another thread reads the fraction every millisecond: prints the elapsed share of time at each tenth of it,
//! and the largest difference between the two. Then cancels so many builds, spread evenly over that time, and prints how long
//! they took to end, milliseconds.

use slimkd::{BuildError, BuildOptions, KdTree, Preset, Progress};
use slimkd_scene::{load, procedural};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let arg = |k: usize| args.get(k).map(String::as_str);
    let name = arg(0).ok_or("give a scene file, or NAME:TRIANGLES of a built-in one")?;
    let mesh = match name.split_once(':') {
        Some((name, triangles)) => {
            procedural::generate(name, triangles.parse()?).ok_or("no such scene")?.mesh
        }
        None => load(name)?.mesh,
    };
    let preset: Preset = arg(1).unwrap_or("slim").parse()?;
    let mut options = BuildOptions::from(preset);
    options.threads = arg(2).map(str::parse).transpose()?.and_then(NonZeroUsize::new);
    let cancels: u32 = arg(3).map_or(Ok(0), str::parse)?;

    let progress = Progress::new();
    let (ended, started) = (AtomicBool::new(false), Instant::now());
    let (seen, total) = std::thread::scope(|scope| {
        let watcher = scope.spawn(|| {
            let mut seen = Vec::new();
            while !ended.load(Relaxed) {
                seen.push((started.elapsed(), progress.fraction()));
                std::thread::sleep(Duration::from_millis(1));
            }
            seen
        });
        let tree = KdTree::build_with_progress(Arc::clone(&mesh), &options, &progress);
        let total = started.elapsed();
        ended.store(true, Relaxed);
        (watcher.join(), tree.map(|_| total))
    });
    let (seen, total) = (seen.map_err(|_| "the watcher died")?, total?);
    let share = |time: Duration| time.as_secs_f64() / total.as_secs_f64();
    let mut largest = (0.0f64, 0.0);
    let (mut tenth, mut before) = (1, 0.0);
    print!("{} triangles, {}, {:.3} s;", mesh.len(), preset.name(), total.as_secs_f64());
    print!(" share of time at each tenth:");
    for &(time, fraction) in seen.iter().filter(|(time, _)| *time < total) {
        assert!(fraction >= before, "progress fell");
        before = fraction;
        let off = fraction - share(time);
        if off.abs() > largest.0.abs() {
            largest = (off, share(time));
        }
        while tenth < 10 && fraction >= f64::from(tenth) / 10.0 {
            print!(" {:.2}", share(time));
            tenth += 1;
        }
    }
    println!(
        "; largest difference {:+.3} at {:.2}; at the end {}",
        largest.0,
        largest.1,
        progress.fraction()
    );

    let mut latencies = Vec::new();
    for k in 0..cancels {
        let progress = Progress::new();
        let built = std::thread::scope(|scope| {
            let build = scope.spawn(|| {
                let built = KdTree::build_with_progress(Arc::clone(&mesh), &options, &progress);
                (Instant::now(), matches!(built, Err(BuildError::Cancelled)))
            });
            std::thread::sleep(total.mul_f64((f64::from(k) + 0.5) / f64::from(cancels)));
            let asked = Instant::now();
            progress.cancel();
            build.join().map(|(ended, cancelled)| (ended.saturating_duration_since(asked), cancelled))
        });
        let (latency, cancelled) = built.map_err(|_| "the build died")?;
        if cancelled {
            latencies.push(latency.as_secs_f64() * 1e3);
        }
    }
    latencies.sort_by(f64::total_cmp);
    if let (Some(median), Some(most)) = (latencies.get(latencies.len() / 2), latencies.last()) {
        println!("cancelled {} of {cancels}: median {median:.1} ms, most {most:.1} ms", latencies.len());
    }
    Ok(())
}
