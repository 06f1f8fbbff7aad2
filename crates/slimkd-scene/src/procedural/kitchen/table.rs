//! The laid table and its chairs.

use super::{Paints, tableware};
use crate::procedural::builder::Builder;
use crate::procedural::frame::Frame;
use crate::procedural::math::TURN;
use glam::{Vec3, vec2, vec3};

/// Height of the table top, metres.
const TOP: f32 = 0.76;

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    b.within(Frame::at(0.0, 0.0, 0.15), |b| {
        b.paint(p.wood);
        // Boards, each a long skinny box.
        for k in 0..5 {
            let z = -0.45 + 0.18 * k as f32;
            b.cuboid(vec3(-1.1, TOP - 0.035, z + 0.001), vec3(1.1, TOP, z + 0.179));
        }
        b.cuboid(vec3(-0.98, TOP - 0.13, -0.38), vec3(0.98, TOP - 0.035, -0.35));
        b.cuboid(vec3(-0.98, TOP - 0.13, 0.35), vec3(0.98, TOP - 0.035, 0.38));
        let leg = [
            vec2(0.022, 0.0),
            vec2(0.030, 0.06),
            vec2(0.020, 0.12),
            vec2(0.042, 0.28),
            vec2(0.046, 0.45),
            vec2(0.026, 0.56),
            vec2(0.044, 0.60),
            vec2(0.044, TOP - 0.03),
        ];
        for (x, z) in [(-1.0, -0.37), (1.0, -0.37), (-1.0, 0.37), (1.0, 0.37)] {
            b.within(Frame::at(x, 0.0, z), |b| {
                let (n, m) = (b.segments(40.0, 4), b.segments(60.0, 1));
                b.lathe(&leg, n, m);
            });
        }
        for k in 0..4 {
            let (x, side) = (if k < 2 { -0.52 } else { 0.52 }, if k % 2 == 0 { 1.0 } else { -1.0 });
            place(b, p, x, 0.28 * side, side);
            let angle = if side > 0.0 { 0.5 * TURN } else { 0.0 };
            let turn = [0.12, -0.05, -0.2, 0.03][k];
            b.within(Frame::at(x, 0.0, 0.62 * side).turned(angle + turn), |b| chair(b, p));
        }
        b.within(Frame::at(0.0, TOP, 0.0), |b| fruit(b, p));
        b.within(Frame::at(-0.9, TOP, 0.02), |b| tableware::bottle(b, p.wine));
        b.within(Frame::at(0.88, TOP, -0.08), |b| tableware::carafe(b, p.glass));
    });
}

/// A plate on a plate, a glass and cutlery; `side` is +1 for who sits at +z.
fn place(b: &mut Builder, p: &Paints, x: f32, z: f32, side: f32) {
    b.within(Frame::at(x, TOP + 0.001, z).turned(if side > 0.0 { 0.0 } else { 0.5 * TURN }), |b| {
        tableware::plates(b, p.china, 1);
        if !b.has(0.03) {
            return;
        }
        b.within(Frame::at(0.0, 0.012, 0.0).scaled(0.72, 1.0, 0.72), |b| tableware::plates(b, p.blue, 1));
        if b.has(0.05) {
            b.within(Frame::at(0.19, 0.0, -0.12), |b| tableware::wine_glass(b, p.glass));
        }
        if b.has(0.12) {
            b.paint(p.chrome);
            tableware::knife(b, vec3(0.165, 0.004, 0.0));
            tableware::fork(b, vec3(-0.165, 0.004, 0.0));
        }
    });
}

/// A wooden chair that faces -z, its seat's centre at the origin: splayed turned legs, a rounded seat, spindles.
fn chair(b: &mut Builder, p: &Paints) {
    b.paint(p.wood_dark);
    let (n, m) = (b.segments(20.0, 3), b.segments(18.0, 2));
    let seat = b.segments(9.0, 0);
    b.pillow(vec3(0.0, 0.445, 0.0), vec3(0.21, 0.02, 0.20), 0.02, seat);
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let (top, foot) = (vec3(0.16 * x, 0.43, 0.15 * z), vec3(0.20 * x, 0.0, 0.20 * z));
        b.cone(foot, top, 0.013, 0.019, n, false);
    }
    for x in [-0.18, 0.18] {
        b.cone(vec3(x, 0.16, -0.18), vec3(x, 0.16, 0.18), 0.010, 0.010, n, false);
    }
    // The back: a bow and spindles that fan out, none of them parallel to an axis.
    let lean = |x: f32, y: f32| vec3(x, y, 0.165 + 0.24 * (y - 0.45));
    let mut bow = vec![lean(-0.17, 0.45)];
    bow.extend((0..=2 * m).map(|k| {
        let (s, c) = crate::procedural::math::sin_cos(0.5 * TURN * k as f32 / (2 * m) as f32);
        lean(-0.20 * c, 0.72 + 0.20 * s)
    }));
    bow.push(lean(0.17, 0.45));
    b.tube(&bow, 0.014, n);
    let spindles = if b.has(0.06) { 2 } else { 1 };
    for k in -spindles..=spindles {
        let x = k as f32;
        let top = 0.915 - 0.012 * x * x;
        b.cone(lean(0.055 * x, 0.45), lean(0.075 * x, top), 0.008, 0.006, n, false);
    }
}

fn fruit(b: &mut Builder, p: &Paints) {
    tableware::bowl(b, p.china, 0.17);
    let n = if b.has(0.08) { 3 } else { 0 };
    let apples = [(0.0, 0.07, 0.0), (0.085, 0.075, 0.02), (-0.05, 0.075, 0.075), (-0.03, 0.13, 0.0)];
    for (k, (x, y, z)) in apples.into_iter().enumerate() {
        let paint = [p.red, p.green, p.red, p.red][k];
        tableware::apple(b, paint, p.wood_dark, vec3(x, y, z));
    }
    for (k, center) in [vec3(-0.085, 0.08, -0.01), vec3(0.02, 0.075, -0.085), vec3(0.045, 0.13, -0.03)]
        .into_iter()
        .enumerate()
    {
        if k < n {
            let segments = b.segments(48.0, 6);
            b.paint(p.orange).ball(center, Vec3::splat(0.042), segments);
        }
    }
    if n > 0 {
        tableware::banana(b, p.yellow, vec3(0.03, 0.15, 0.06), 0.4);
        tableware::banana(b, p.yellow, vec3(0.05, 0.165, 0.045), 0.7);
    }
}
