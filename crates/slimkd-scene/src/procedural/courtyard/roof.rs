//! The roof of one side: barrel tiles that fall towards the court.

use super::{COURT, LEVELS, OUTER, Paints};
use crate::procedural::builder::{Builder, Closure};
use crate::procedural::math::sin_cos;
use glam::{Vec3, vec3};
use std::f32::consts::PI;

/// Eaves: how far before the columns, and their height; ridge height; metres.
const EAVES: f32 = COURT - 0.62;
const LOW: f32 = LEVELS[2] + 0.05;
const HIGH: f32 = LEVELS[2] + 1.75;

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    let slope = vec3(0.0, HIGH - LOW, EAVES - OUTER);
    let at = |x: f32, t: f32| vec3(x, LOW, -EAVES) + slope * t;
    let normal = vec3(0.0, OUTER - EAVES, HIGH - LOW).normalize();
    b.paint(p.tile_dark);
    // Below the tiles: one trapezium; the outer wall behind it.
    b.patch(1, 1, Closure::OPEN, |u, v| {
        let half = EAVES + (OUTER - EAVES) * v;
        (at(half * (2.0 * u - 1.0), v) - normal * 0.03, normal)
    });
    b.paint(p.wood).patch(1, 1, Closure::OPEN, |u, v| {
        let half = EAVES + (COURT - EAVES) * v;
        (vec3(half * (2.0 * u - 1.0), LOW - 0.06, -half), Vec3::NEG_Y)
    });
    b.paint(p.upper).quad(vec3(OUTER, 0.0, -OUTER), Vec3::X * (-2.0 * OUTER), Vec3::Y * HIGH);
    let (columns, rows) = match () {
        () if b.has(0.35) => (110, 14),
        () if b.has(0.12) => (80, 1),
        () if b.has(0.04) => (40, 1),
        () => (12, 1),
    };
    let n = b.segments(9.0, 2);
    let m = b.segments(2.0, 1);
    let width = 2.0 * OUTER / columns as f32;
    let mut rng = b.rng.fork();
    for column in 0..columns {
        let x = -OUTER + width * (column as f32 + 0.5);
        // Near the corners a column starts where the valley is.
        let start = ((x.abs() + 0.5 * width - EAVES) / (OUTER - EAVES)).max(0.0);
        for row in 0..rows {
            let (t0, t1) = (row as f32 / rows as f32, (row as f32 + 1.08) / rows as f32);
            if t1 <= start {
                continue;
            }
            let (t0, t1) = (t0.max(start) - if row == 0 && start == 0.0 { 0.03 } else { 0.0 }, t1.min(1.0));
            if t1 - t0 < 0.004 {
                continue;
            }
            b.paint(if rng.below(4) == 0 { p.tile_dark } else { p.tile });
            let (skew, lift) = (0.008 * rng.signed(), 0.004 * rng.unit());
            b.patch(n, m, Closure::OPEN, |u, v| {
                let (s, c) = sin_cos(PI * u);
                let radius = 0.48 * width * (1.0 - 0.12 * v);
                let out = Vec3::X * c + normal * (s * (0.2 / width).min(1.0));
                // The lower end of a tile lies on the one below it.
                (
                    at(x + skew * v, t0 + (t1 - t0) * v) + out * radius + normal * (0.045 * (1.0 - v) + lift),
                    out,
                )
            });
        }
    }
    // Rafters' ends under the eaves.
    let rafters = if b.has(0.1) { 60 } else { 0 };
    b.paint(p.wood);
    for k in 0..rafters {
        let x = -EAVES + 2.0 * EAVES * (k as f32 + 0.5) / rafters as f32;
        b.beam(at(x, -0.01) - normal * 0.09, at(x, 0.16) - normal * 0.09, 0.07, 0.09);
    }
}
