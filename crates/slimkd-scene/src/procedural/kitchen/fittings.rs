//! Cabinets, worktop, sink, stove, hood, refrigerator, shelves.

use super::{D, H, Paints, W, tableware};
use crate::procedural::builder::Builder;
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, cos, sin};
use glam::{Vec3, vec2, vec3};

/// Height and depth of the worktop, metres.
const TOP: f32 = 0.92;
const DEPTH: f32 = 0.62;

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    let back = -D;
    // The row along the back wall: three cabinets, the stove, four cabinets (one under the sink), the refrigerator.
    for k in 0..8 {
        let x = -2.95 + 0.6 * k as f32;
        if k != 2 {
            cabinet(b, p, vec3(x, 0.1, back), vec3(0.6, TOP - 0.14, DEPTH - 0.03));
        }
    }
    b.paint(p.black).cuboid(vec3(-2.95, 0.0, back), vec3(1.85, 0.1, back + DEPTH - 0.1));
    worktop(b, p);
    stove(b, p, -1.75, back);
    sink(b, p, 0.1, back + 0.31);
    fridge(b, p, 1.95, back);
    backsplash(b, p);
    for x in [-2.95, -2.35, 0.95, 1.45] {
        let width = if x > 0.0 { 0.5 } else { 0.6 };
        cabinet(b, p, vec3(x, 1.5, back), vec3(width, 0.75, 0.34));
    }
    hood(b, p);
    shelves(b, p);
    counter_things(b, p);
}

/// A carcass with a panelled door and a bar handle; `corner` is the lower left at the wall.
fn cabinet(b: &mut Builder, p: &Paints, corner: Vec3, size: Vec3) {
    b.within(Frame::to(corner), |b| {
        b.paint(p.cabinet).cuboid(Vec3::ZERO, size);
        if b.has(0.08) {
            let n = b.segments(3.0, 0);
            let (w, h, z) = (size.x, size.y, size.z);
            let half = vec3(0.5 * w - 0.006, 0.5 * h - 0.006, 0.012);
            b.pillow(vec3(0.5 * w, 0.5 * h, z + 0.012), half, 0.006, n);
            // The frame around the panel.
            for (center, half) in [
                (vec3(0.045, 0.5 * h, z + 0.028), vec3(0.035, 0.5 * h - 0.01, 0.006)),
                (vec3(w - 0.045, 0.5 * h, z + 0.028), vec3(0.035, 0.5 * h - 0.01, 0.006)),
                (vec3(0.5 * w, 0.045, z + 0.028), vec3(0.5 * w - 0.08, 0.035, 0.006)),
                (vec3(0.5 * w, h - 0.045, z + 0.028), vec3(0.5 * w - 0.08, 0.035, 0.006)),
            ] {
                b.pillow(center, half, 0.005, n);
            }
            let y = if corner.y > 1.0 { 0.16 } else { h - 0.16 };
            handle(b, p, vec3(w - 0.045, y, z + 0.034), Vec3::Y * 0.07);
        }
    });
}

/// A bent bar between `center` ± `half`, standing off by 3 cm along +z.
fn handle(b: &mut Builder, p: &Paints, center: Vec3, half: Vec3) {
    let (n, m) = (b.segments(16.0, 3), b.segments(8.0, 1));
    let off = Vec3::Z * 0.035;
    b.paint(p.chrome).pipe(
        &[center - half, center - half + off, center + half + off, center + half],
        0.006,
        0.015,
        n,
        m,
    );
}

fn worktop(b: &mut Builder, p: &Paints) {
    let (back, front) = (-D, -D + DEPTH);
    let n = b.segments(4.0, 0);
    b.paint(p.worktop);
    // Left of the stove; then around the sink's opening.
    for (x0, x1, z0, z1) in [
        (-2.98, -1.76, back, front),
        (-1.14, -0.25, back, front),
        (0.45, 1.87, back, front),
        (-0.25, 0.45, back, back + 0.10),
        (-0.25, 0.45, front - 0.10, front),
    ] {
        let half = vec3(0.5 * (x1 - x0), 0.02, 0.5 * (z1 - z0));
        b.pillow(vec3(0.5 * (x0 + x1), TOP - 0.02, 0.5 * (z0 + z1)), half, 0.008, n);
    }
}

fn sink(b: &mut Builder, p: &Paints, x: f32, z: f32) {
    b.within(Frame::at(x, TOP - 0.002, z), |b| {
        let (nu, nv) = (b.segments(96.0, 12), b.segments(40.0, 4));
        let closure = crate::procedural::builder::Closure { ring: true, first_pole: false, last_pole: true };
        // A rounded rectangle that shrinks and sinks: rim, wall, floor.
        b.paint(p.steel).patch(nu, nv, closure, |u, v| {
            let (s, c) = crate::procedural::math::sin_cos(TURN * u);
            let blunt = |x: f32| x * (1.0 + 0.55 * (1.0 - x.abs()) * x.abs()) / 1.0;
            let grow = (1.0 / s.abs().max(c.abs())).min(1.28);
            let shrink = if v < 0.55 { 1.0 - 0.12 * v } else { 0.934 * (1.0 - (v - 0.55) / 0.45) };
            let depth = -0.17 * (1.0 - (1.0 - (v / 0.6).min(1.0)) * (1.0 - (v / 0.6).min(1.0)));
            let p = vec3(
                0.36 * blunt(c * grow * 0.999).clamp(-1.0, 1.0) * shrink,
                depth,
                0.22 * (s * grow).clamp(-1.0, 1.0) * shrink,
            );
            (p, if v < 0.5 { vec3(-c, 0.25, -s) } else { Vec3::Y })
        });
        let n = b.segments(28.0, 4);
        let m = b.segments(14.0, 3);
        b.paint(p.chrome).rod(vec3(0.0, 0.0, -0.25), vec3(0.0, 0.05, -0.25), 0.026, n);
        b.pipe(
            &[vec3(0.0, 0.04, -0.25), vec3(0.0, 0.36, -0.25), vec3(0.0, 0.36, -0.05), vec3(0.0, 0.24, -0.05)],
            0.012,
            0.095,
            n,
            m,
        );
        for side in [-1.0, 1.0] {
            b.rod(vec3(0.11 * side, 0.0, -0.25), vec3(0.11 * side, 0.06, -0.25), 0.016, n);
            b.beam(vec3(0.11 * side, 0.065, -0.25), vec3(0.16 * side, 0.075, -0.22), 0.012, 0.012);
        }
    });
}

fn stove(b: &mut Builder, p: &Paints, x: f32, back: f32) {
    b.within(Frame::at(x, 0.0, back), |b| {
        b.paint(p.steel).cuboid(vec3(0.0, 0.02, 0.0), vec3(0.6, TOP, DEPTH));
        b.paint(p.black).cuboid(vec3(0.06, 0.20, DEPTH), vec3(0.54, 0.66, DEPTH + 0.012));
        handle_bar(b, p);
        let n = b.segments(36.0, 5);
        for k in 0..if b.has(0.06) { 5 } else { 0 } {
            let knob = vec3(0.1 + 0.1 * k as f32, 0.85, DEPTH);
            b.paint(p.black).rod(knob, knob + Vec3::Z * 0.03, 0.022, n);
            b.paint(p.chrome).rod(knob, knob + Vec3::Z * 0.008, 0.029, n);
        }
        if !b.has(0.04) {
            return;
        }
        for (k, (u, v)) in [(0.16, 0.17), (0.44, 0.17), (0.16, 0.44), (0.44, 0.44)].into_iter().enumerate() {
            b.within(Frame::at(u, TOP, v), |b| {
                b.paint(p.black);
                let (n, m) = (b.segments(60.0, 6), b.segments(10.0, 3));
                b.torus(0.008, 0.055, 0.009, n, m);
                b.torus(0.030, 0.100, 0.006, n, m);
                for spoke in 0..4 {
                    let angle = TURN * (spoke as f32 / 4.0 + 0.125);
                    let way = vec3(cos(angle), 0.0, sin(angle));
                    b.beam(way * 0.02 + Vec3::Y * 0.03, way * 0.13 + Vec3::Y * 0.03, 0.008, 0.010);
                }
                match k {
                    0 => tableware::pot(b, p.copper, p.chrome, 0.105, 0.15),
                    1 => tableware::pan(b, p.black, p.wood),
                    3 => tableware::kettle(b, p.chrome, p.black),
                    _ => {}
                }
            });
        }
    });
}

fn handle_bar(b: &mut Builder, p: &Paints) {
    let n = b.segments(18.0, 3);
    b.paint(p.chrome).rod(vec3(0.06, 0.73, DEPTH + 0.04), vec3(0.54, 0.73, DEPTH + 0.04), 0.011, n);
    for x in [0.1, 0.5] {
        b.rod(vec3(x, 0.73, DEPTH), vec3(x, 0.73, DEPTH + 0.04), 0.007, n);
    }
}

fn hood(b: &mut Builder, p: &Paints) {
    // A frustum of four slanted sheets and a chimney up to the ceiling.
    let z = -D;
    let (lo, hi) = ([-1.85, -1.05], [-1.60, -1.30]);
    let (front_lo, front_hi) = (z + 0.52, z + 0.28);
    b.paint(p.steel);
    b.cuboid(vec3(lo[0], 1.58, z), vec3(lo[1], 1.63, front_lo));
    let low = [
        vec3(lo[0], 1.63, z),
        vec3(lo[0], 1.63, front_lo),
        vec3(lo[1], 1.63, front_lo),
        vec3(lo[1], 1.63, z),
    ];
    let high = [
        vec3(hi[0], 1.95, z),
        vec3(hi[0], 1.95, front_hi),
        vec3(hi[1], 1.95, front_hi),
        vec3(hi[1], 1.95, z),
    ];
    for k in 0..3 {
        let (a, c, d, e) = (low[k], low[k + 1], high[k + 1], high[k]);
        let normal = (c - a).cross(e - a).normalize();
        b.patch(1, 1, crate::procedural::builder::Closure::OPEN, |u, v| {
            (a.lerp(c, u).lerp(e.lerp(d, u), v), normal)
        });
    }
    b.cuboid(vec3(hi[0], 1.95, z), vec3(hi[1], H, front_hi));
}

fn fridge(b: &mut Builder, p: &Paints, x: f32, back: f32) {
    b.within(Frame::at(x, 0.0, back), |b| {
        let n = b.segments(12.0, 0);
        b.paint(p.steel);
        b.pillow(vec3(0.5, 0.42, 0.33), vec3(0.49, 0.40, 0.33), 0.03, n);
        b.pillow(vec3(0.5, 1.40, 0.33), vec3(0.49, 0.56, 0.33), 0.03, n);
        handle(b, p, vec3(0.08, 0.62, 0.655), Vec3::Y * 0.14);
        handle(b, p, vec3(0.08, 1.10, 0.655), Vec3::Y * 0.20);
    });
}

/// Small glazed tiles between worktop and cabinets.
fn backsplash(b: &mut Builder, p: &Paints) {
    if !b.has(0.25) {
        return;
    }
    let (columns, rows, size) = (40, 4, 0.12);
    let n = b.segments(1.6, 0);
    for i in 0..columns {
        for j in 0..rows {
            let x = -2.95 + size * (i as f32 + 0.5);
            let y = TOP + 0.02 + size * (j as f32 + 0.5);
            // The window reaches down into the upper rows.
            if x > -0.85 && x < 1.05 && y > 1.03 {
                continue;
            }
            b.paint(if (i * 7 + j * 5) % 11 == 0 { p.blue } else { p.china });
            b.pillow(vec3(x, y, -D + 0.004), vec3(0.5 * size - 0.002, 0.5 * size - 0.002, 0.006), 0.004, n);
        }
    }
}

/// Open shelves on the left wall with stacks of plates, bowls, jars and bottles.
fn shelves(b: &mut Builder, p: &Paints) {
    for (level, y) in [1.25f32, 1.65, 2.05].into_iter().enumerate() {
        b.paint(p.wood).cuboid(vec3(-W, y - 0.03, -1.5), vec3(-W + 0.30, y, 1.6));
        for z in [-1.3, 0.0, 1.4].into_iter().take(if b.has(0.03) { 3 } else { 0 }) {
            b.paint(p.black).beam(vec3(-W + 0.01, y - 0.25, z), vec3(-W + 0.26, y - 0.03, z), 0.02, 0.02);
        }
        let items = if b.has(0.3) {
            12
        } else if b.has(0.1) {
            4
        } else {
            0
        };
        for k in 0..items {
            let z = -1.35 + 2.85 * (k as f32 + 0.5) / items as f32;
            b.within(Frame::at(-W + 0.15, y, z), |b| match (k + 2 * level) % 6 {
                0 => tableware::plates(b, p.china, 6),
                1 => tableware::jar(b, p.glass, p.wood, p.orange),
                2 => tableware::bottle(b, p.wine),
                3 => tableware::bowl(b, p.blue, 0.11),
                4 => tableware::cup(b, if level == 1 { p.red } else { p.china }),
                _ => tableware::pot(b, p.copper, p.chrome, 0.09, 0.12),
            });
        }
    }
    // A low sideboard under the shelves.
    b.within(Frame::at(-W, 0.0, 1.6).turned(0.25 * TURN), |b| {
        for k in 0..4 {
            cabinet(b, p, vec3(0.775 * k as f32, 0.08, 0.0), vec3(0.775, 0.74, 0.40));
        }
        b.paint(p.wood).cuboid(vec3(-0.02, 0.82, 0.0), vec3(3.12, 0.86, 0.44));
    });
}

/// What stands about on worktop and sideboard.
fn counter_things(b: &mut Builder, p: &Paints) {
    let z = -D + 0.26;
    b.within(Frame::at(-2.6, TOP, z), |b| tableware::jar(b, p.glass, p.wood, p.yellow));
    b.within(Frame::at(-2.35, TOP, z - 0.05), |b| tableware::jar(b, p.glass, p.wood, p.red));
    if !b.has(0.08) {
        return;
    }
    b.within(Frame::at(-2.05, TOP, z), |b| tableware::bottle(b, p.wine));
    b.within(Frame::at(-0.75, TOP, z + 0.05), |b| {
        b.paint(p.wood).cuboid(vec3(-0.2, 0.0, -0.14), vec3(0.2, 0.02, 0.14));
        for k in 0..3 {
            tableware::lemon(b, p.yellow, vec3(-0.1 + 0.09 * k as f32, 0.052, 0.03 - 0.04 * k as f32));
        }
    });
    b.within(Frame::at(0.75, TOP, z), |b| tableware::plates(b, p.china, 9));
    b.within(Frame::at(1.15, TOP, z), |b| tableware::bowl(b, p.blue, 0.13));
    b.within(Frame::at(1.55, TOP, z), |b| toaster(b, p));
    for (x, z) in [(-0.55, -D + 0.07), (0.72, -D + 0.07)] {
        b.within(Frame::at(x, 1.14, z), |b| tableware::herb(b, p.clay, p.leaf));
    }
    b.within(Frame::at(-W + 0.22, 0.86, 1.0), |b| tableware::herb(b, p.blue, p.leaf));
    b.within(Frame::at(-W + 0.22, 0.86, 0.2), |b| tableware::plates(b, p.blue, 7));
    b.within(Frame::at(-W + 0.22, 0.86, -0.6), |b| tableware::kettle(b, p.copper, p.black));
}

fn toaster(b: &mut Builder, p: &Paints) {
    let n = b.segments(24.0, 3);
    b.paint(p.chrome).pillow(vec3(0.0, 0.11, 0.0), vec3(0.15, 0.09, 0.085), 0.04, n / 3);
    b.paint(p.black).cuboid(vec3(-0.13, 0.0, -0.07), vec3(0.13, 0.025, 0.07));
    for z in [-0.03, 0.03] {
        b.cuboid(vec3(-0.11, 0.198, z - 0.010), vec3(0.11, 0.203, z + 0.010));
    }
    let lever = [vec2(0.0, 0.0), vec2(0.012, 0.004), vec2(0.0, 0.016)];
    b.within(Frame::at(0.155, 0.13, 0.0), |b| b.lathe(&lever, n, n / 2));
}
