//! The same picture at any thread count; progress and cancelling.

use crate::common::*;
use slimkd::Progress;
use slimkd_render::{RenderError, RenderSettings, render};
use std::num::NonZeroUsize;

#[test]
fn the_same_picture_at_any_thread_count() {
    let ((scene, tree), camera, lights) = three_balls();
    let run = |threads| {
        let mut settings = RenderSettings::sized(67, 41);
        settings.threads = NonZeroUsize::new(threads);
        let progress = Progress::new();
        let film = render(&scene, &tree, &camera, &lights, &settings, &progress).unwrap();
        assert_eq!(progress.fraction(), 1.0);
        let rays = film.rays();
        (film, rays)
    };
    let (film, rays) = run(1);
    assert_eq!(rays.primary, 67 * 41 * 4);
    assert!(rays.shadow > 0 && rays.reflection > 0 && rays.refraction > 0 && rays.occlusion > 0);
    assert_eq!(rays.total(), rays.primary + rays.shadow + rays.reflection + rays.refraction + rays.occlusion);
    for threads in [0, 2, 5] {
        assert!(run(threads) == (film.clone(), rays), "{threads} threads");
    }
}

#[test]
fn cancelled_is_an_error() {
    let ((scene, tree), camera, lights) = three_balls();
    let progress = Progress::new();
    progress.cancel();
    let result = render(&scene, &tree, &camera, &lights, &RenderSettings::sized(64, 64), &progress);
    assert!(matches!(result, Err(RenderError::Cancelled)));
    assert!(progress.is_cancelled() && progress.fraction() < 1.0);
}

#[test]
fn the_recursion_limit_and_the_cut_off_save_rays() {
    let ((scene, tree), camera, lights) = three_balls();
    let rays = |max_depth, min_contribution| {
        let mut settings = RenderSettings::sized(48, 32);
        (settings.max_depth, settings.min_contribution) = (max_depth, min_contribution);
        let film = render(&scene, &tree, &camera, &lights, &settings, &Progress::new()).unwrap();
        film.rays().reflection + film.rays().refraction
    };
    assert_eq!(rays(0, 0.0), 0);
    assert!(rays(1, 0.0) < rays(5, 0.0));
    assert!(rays(5, 0.05) < rays(5, 0.0));
}
