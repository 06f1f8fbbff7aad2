//! One side of the court, along x at z = -COURT: columns, arches, the walk behind them, the storey above.

use super::{BAYS, COURT, LEVELS, OUTER, Paints};
use crate::procedural::builder::{Builder, Closure};
use crate::procedural::frame::Frame;
use crate::procedural::math::sin_cos;
use crate::procedural::shapes::Leaf;
use glam::{Vec2, Vec3, vec2, vec3};
use std::f32::consts::PI;

/// Width of a bay and thickness of the wall above the arches, metres.
const BAY: f32 = 2.0 * COURT / BAYS as f32;
const WALL: f32 = 0.42;
/// Radius of an arch, metres.
const RADIUS: f32 = 0.5 * BAY - 0.24;

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    walk(b, p);
    for k in 0..=BAYS {
        let x = -COURT + BAY * k as f32;
        if k < BAYS {
            b.within(Frame::at(x, 0.0, -COURT), |b| column(b, p));
            b.within(Frame::at(x + 0.5 * BAY, 0.0, -COURT), |b| {
                arch(b, p);
                upper_bay(b, p, k % 2 == 0);
            });
        }
    }
    // String course and cornice run along the whole side.
    b.paint(p.stone);
    b.cuboid(vec3(-COURT, LEVELS[1] - 0.1, -COURT - 0.05), vec3(COURT, LEVELS[1] + 0.08, -COURT + 0.32));
    b.cuboid(vec3(-COURT, LEVELS[2] - 0.22, -COURT - 0.05), vec3(COURT, LEVELS[2], -COURT + 0.34));
    balustrade(b, p);
}

/// The vaultless walk: floor, back wall with doors, beams under the upper floor.
fn walk(b: &mut Builder, p: &Paints) {
    let (back, front) = (-OUTER + 0.4, -COURT + 0.35);
    b.paint(p.stone);
    b.cuboid(vec3(back, 0.0, back), vec3(-back, 0.12, front));
    b.paint(p.plaster).quad(vec3(back, 0.0, back), Vec3::X * (-2.0 * back), Vec3::Y * LEVELS[1]);
    b.paint(p.upper).quad(
        vec3(back, LEVELS[1] - 0.25, back),
        Vec3::X * (-2.0 * back),
        Vec3::Z * (front - back),
    );
    b.paint(p.wood);
    let beams = if b.has(0.06) { 30 } else { 4 };
    for k in 0..beams {
        let x = -COURT + 2.0 * COURT * (k as f32 + 0.5) / beams as f32;
        b.cuboid(vec3(x - 0.07, LEVELS[1] - 0.45, back), vec3(x + 0.07, LEVELS[1] - 0.26, -COURT));
    }
    for k in 0..if b.has(0.03) { 3 } else { 0 } {
        door(b, p, -6.0 + 6.0 * k as f32, back);
    }
}

fn door(b: &mut Builder, p: &Paints, x: f32, z: f32) {
    b.paint(p.wood).cuboid(vec3(x - 0.62, 0.12, z), vec3(x + 0.62, 2.5, z + 0.05));
    b.paint(p.stone);
    for (x0, x1, y0, y1) in [(-0.82, -0.62, 0.12, 2.7), (0.62, 0.82, 0.12, 2.7), (-0.62, 0.62, 2.5, 2.7)] {
        b.cuboid(vec3(x + x0, y0, z), vec3(x + x1, y1, z + 0.12));
    }
    if !b.has(0.1) {
        return;
    }
    let n = b.segments(5.0, 0);
    b.paint(p.green_wood);
    for column in 0..2 {
        for row in 0..3 {
            let center = vec3(x - 0.31 + 0.62 * column as f32, 0.52 + 0.78 * row as f32, z + 0.06);
            b.pillow(center, vec3(0.24, 0.33, 0.03), 0.02, n);
        }
    }
    let n = b.segments(20.0, 3);
    b.paint(p.iron).ball(vec3(x + 0.06, 1.2, z + 0.11), Vec3::splat(0.035), n);
    // A lantern above the door.
    b.paint(p.iron).cone(vec3(x, 3.15, z), vec3(x, 3.15, z + 0.3), 0.012, 0.012, n / 3, false);
    b.cone(vec3(x, 2.92, z + 0.3), vec3(x, 3.05, z + 0.3), 0.06, 0.10, 6, false);
    b.cone(vec3(x, 3.05, z + 0.3), vec3(x, 3.17, z + 0.3), 0.11, 0.01, 6, false);
    b.paint(p.bulb).ball(vec3(x, 3.0, z + 0.3), Vec3::splat(0.04), n);
}

fn column(b: &mut Builder, p: &Paints) {
    let (n, m) = (b.segments(52.0, 4), b.segments(56.0, 1));
    let top = LEVELS[0];
    b.paint(p.stone);
    if !b.has(0.04) {
        return b.block(0.0, 0.0, 0.0, vec3(0.4, top, 0.4));
    }
    b.block(0.0, 0.0, 0.0, vec3(0.56, 0.30, 0.56));
    b.block(0.0, top - 0.14, 0.0, vec3(0.58, 0.14, 0.58));
    let shaft: [Vec2; 8] = [
        vec2(0.27, 0.30),
        vec2(0.28, 0.36),
        vec2(0.22, 0.43),
        vec2(0.205, 0.60),
        vec2(0.21, 1.20),
        vec2(0.175, top - 0.38),
        vec2(0.20, top - 0.34),
        vec2(0.28, top - 0.13),
    ];
    b.lathe(&shaft, n, m);
    if b.has(0.08) {
        b.torus(0.36, 0.24, 0.045, n, m / 4);
        b.torus(top - 0.40, 0.185, 0.03, n, m / 4);
    }
}

/// The wall over one bay with its round arch; the frame stands in the bay's middle.
fn arch(b: &mut Builder, p: &Paints) {
    let (n, spring, top) = (b.segments(44.0, 4), LEVELS[0], LEVELS[1]);
    let edge = |u: f32| {
        let (s, c) = sin_cos(PI * (1.0 - u));
        (vec3(RADIUS * c, spring + RADIUS * s, 0.0), vec3(c, s, 0.0))
    };
    let half = 0.5 * WALL;
    b.paint(p.plaster);
    let sides = if b.has(0.035) { 2 } else { 1 };
    for side in [1.0, -1.0].into_iter().take(sides) {
        b.patch(n, 1, Closure::OPEN, |u, v| {
            let (low, _) = edge(u);
            let high = vec3(BAY * (u - 0.5), top, 0.0);
            (low.lerp(high, v) + Vec3::Z * (side * half), Vec3::Z * side)
        });
        // The corners between the abacus and the arch's feet.
        for x in [-1.0, 1.0] {
            let foot = vec3(x * RADIUS, spring, side * half);
            let out = Vec3::X * (x * (0.5 * BAY - RADIUS));
            b.patch(1, 1, Closure { last_pole: true, ..Closure::OPEN }, |u, v| {
                let high = vec3(x * 0.5 * BAY, top, side * half);
                ((foot + out * u).lerp(high, v), Vec3::Z * side)
            });
        }
    }
    let m = b.segments(10.0, 1);
    b.patch(n, m, Closure::OPEN, |u, v| {
        let (at, out) = edge(u);
        (at + Vec3::Z * (WALL * (v - 0.5)), -out)
    });
    if !b.has(0.04) {
        return;
    }
    // A moulding around the arch on the court's side.
    let (n, m) = (b.segments(60.0, 6), b.segments(12.0, 3));
    let path: Vec<Vec3> = (0..=n)
        .map(|k| edge(k as f32 / n as f32))
        .map(|(at, out)| at + out * 0.10 + Vec3::Z * half)
        .collect();
    b.paint(p.stone).tube(&path, 0.065, m);
}

/// The upper wall of a bay: a window with panes and bars, louvred shutters, a sill.
fn upper_bay(b: &mut Builder, p: &Paints, open: bool) {
    let (bottom, top, half) = (LEVELS[1], LEVELS[2], 0.55);
    let (y0, y1) = (bottom + 0.75, bottom + 2.45);
    let z = 0.5 * WALL;
    b.paint(p.upper);
    b.within(Frame::at(-0.5 * BAY, bottom, z), |b| {
        b.wall(BAY, top - bottom, Some([0.5 * BAY - half, y0 - bottom, 0.5 * BAY + half, y1 - bottom]));
    });
    b.paint(p.pane).quad(vec3(-half, y0, z - 0.18), Vec3::X * (2.0 * half), Vec3::Y * (y1 - y0));
    if !b.has(0.045) {
        return;
    }
    b.paint(p.dark);
    b.quad(vec3(-half, y0, z - 0.18), Vec3::Y * (y1 - y0), Vec3::Z * 0.18);
    b.quad(vec3(half, y0, z), Vec3::Y * (y1 - y0), Vec3::Z * -0.18);
    b.quad(vec3(-half, y1, z - 0.18), Vec3::X * (2.0 * half), Vec3::Z * 0.18);
    b.paint(p.stone).cuboid(vec3(-half - 0.1, y0 - 0.09, z - 0.18), vec3(half + 0.1, y0, z + 0.10));
    b.paint(p.flower_white);
    for x in [-half + 0.03, 0.0, half - 0.03] {
        b.cuboid(vec3(x - 0.03, y0, z - 0.17), vec3(x + 0.03, y1, z - 0.12));
    }
    for k in 1..4 {
        let y = y0 + (y1 - y0) * k as f32 / 4.0;
        b.cuboid(vec3(-half, y - 0.02, z - 0.17), vec3(half, y + 0.02, z - 0.13));
    }
    for side in [-1.0f32, 1.0] {
        let swing = if open { 0.0 } else { 0.5 };
        let hinge = Frame::at(side * half, y0, z + 0.03).turned(-side * swing);
        b.within(hinge, |b| shutter(b, p, side * half, y1 - y0));
    }
    if open && b.has(0.1) {
        flower_box(b, p, y0, z + 0.2);
    }
}

/// A leaf of `width` (signed: to which side it hangs) with slanting louvres.
fn shutter(b: &mut Builder, p: &Paints, width: f32, height: f32) {
    let (x0, x1) = (width.min(0.0), width.max(0.0));
    b.paint(p.green_wood);
    for (a, c) in [(x0, x0 + 0.06), (x1 - 0.06, x1)] {
        b.cuboid(vec3(a, 0.0, 0.0), vec3(c, height, 0.04));
    }
    for (a, c) in [(0.0, 0.06), (height - 0.06, height)] {
        b.cuboid(vec3(x0, a, 0.001), vec3(x1, c, 0.039));
    }
    let louvres = if b.has(0.3) { 24 } else { 6 };
    for k in 0..louvres {
        let y = 0.06 + (height - 0.16) * k as f32 / louvres as f32;
        b.quad(vec3(x0 + 0.06, y, 0.038), Vec3::X * (x1 - x0 - 0.12), vec3(0.0, 0.09, -0.034));
    }
}

fn flower_box(b: &mut Builder, p: &Paints, y: f32, z: f32) {
    b.paint(p.clay).cuboid(vec3(-0.5, y - 0.02, z - 0.1), vec3(0.5, y + 0.14, z + 0.1));
    let count = b.count(110.0, 6, 8_000) as usize;
    for (paint, share) in [(p.leaf_light, count), (p.flower, count / 2)] {
        b.paint(paint).leaves(share, |rng| {
            let base = rng.point(vec3(-0.5, y + 0.08, z - 0.08), vec3(0.5, y + 0.28, z + 0.16));
            Leaf::scattered(rng, base, 0.09, 0.6)
        });
    }
}

/// An iron railing before the upper windows: thin bars and a hand rail as long as the side.
fn balustrade(b: &mut Builder, p: &Paints) {
    let (y, z) = (LEVELS[1] + 0.08, -COURT + 0.29);
    let n = b.segments(8.0, 3);
    b.paint(p.iron);
    for height in [0.08, 0.62] {
        b.cone(vec3(-COURT, y + height, z), vec3(COURT, y + height, z), 0.016, 0.016, n, false);
    }
    let bars = if b.has(0.2) {
        150
    } else if b.has(0.06) {
        60
    } else {
        0
    };
    let knob = b.segments(10.0, 3);
    for k in 0..bars {
        let x = -COURT + 2.0 * COURT * (k as f32 + 0.5) / bars as f32;
        b.cone(vec3(x, y, z), vec3(x, y + 0.62, z), 0.007, 0.007, n, false);
        if b.has(0.6) {
            b.ball(vec3(x, y + 0.35, z), vec3(0.016, 0.03, 0.016), knob);
        }
    }
}
