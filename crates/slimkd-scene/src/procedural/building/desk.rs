//! A work place: desk, chair and what lies about. Who sits there looks towards -z.

use super::Paints;
use crate::procedural::builder::{Builder, Paint};
use crate::procedural::frame::Frame;
use crate::procedural::math::{Rng, TURN, around};
use glam::{Vec3, vec2, vec3};

/// Height of the desk top, metres.
const TOP: f32 = 0.74;

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    let mut rng = b.rng.fork();
    let n = b.segments(4.0, 0);
    b.paint(p.wood).pillow(vec3(0.0, TOP - 0.014, 0.0), vec3(0.8, 0.014, 0.39), 0.006, n);
    b.paint(p.dark_steel);
    let legs = if b.has(0.035) { 2 } else { 0 };
    for x in [-0.72, 0.72].into_iter().take(legs) {
        // An A-shaped trestle.
        b.beam(vec3(x, 0.0, -0.36), vec3(x, TOP - 0.03, -0.08), 0.035, 0.035);
        b.beam(vec3(x, 0.0, 0.36), vec3(x, TOP - 0.03, 0.08), 0.035, 0.035);
    }
    monitor(b, p, 0.25 * rng.signed());
    if b.has(0.05) {
        drawers(b, p);
        let place = Frame::at(0.15 * rng.signed(), 0.0, 0.72 + 0.2 * rng.unit()).turned(0.7 * rng.signed());
        let fabric = p.fabric[rng.below(3) as usize];
        b.within(place, |b| chair(b, p, fabric));
    }
    if !b.has(0.10) {
        return;
    }
    keyboard(b, p);
    if rng.below(2) == 0 {
        b.within(Frame::at(-0.62, TOP, -0.16).turned(rng.signed()), |b| lamp(b, p));
    }
    let paint = [p.white, p.fabric[1], p.fabric[0]][rng.below(3) as usize];
    b.within(Frame::at(0.42 + 0.1 * rng.signed(), TOP, 0.05), |b| mug(b, paint));
    papers(b, p, &mut rng);
    // The screen's cord hangs down behind the desk.
    let (n, m) = (b.segments(6.0, 3), b.segments(14.0, 2));
    b.paint(p.black).cable(vec3(0.1, 0.9, -0.24), vec3(0.5 * rng.signed(), 0.05, -0.37), -0.1, 0.005, n, m);
}

fn monitor(b: &mut Builder, p: &Paints, turn: f32) {
    b.within(Frame::at(0.0, TOP, -0.2).turned(turn), |b| {
        let n = b.segments(5.0, 0);
        b.paint(p.black).pillow(vec3(0.0, 0.33, 0.0), vec3(0.29, 0.175, 0.014), 0.01, n);
        b.paint(p.display).quad(vec3(-0.278, 0.167, 0.0145), Vec3::X * 0.556, Vec3::Y * 0.325);
        if b.has(0.06) {
            let m = b.segments(40.0, 4);
            b.paint(p.steel).rod(vec3(0.0, 0.0, -0.03), vec3(0.0, 0.012, -0.03), 0.11, m);
            b.beam(vec3(0.0, 0.01, -0.06), vec3(0.0, 0.25, -0.02), 0.06, 0.012);
            lines(b, p);
        }
    });
}

/// Text on the screen.
fn lines(b: &mut Builder, p: &Paints) {
    if !b.has(0.3) {
        return;
    }
    let count = b.count(60.0, 0, 2_000) as usize;
    let rows = (count as f32).sqrt() as usize + 1;
    b.paint(p.paper).pieces(count, [[0, 1, 2], [0, 2, 3]], |rng, k| {
        let (row, column) = (k % rows, k / rows);
        let tall = 0.29 / rows as f32;
        let y = 0.47 - tall * row as f32;
        let x = -0.26 + 0.5 * column as f32 / rows as f32;
        let wide = rng.range(0.3, 0.9) * 0.5 / rows as f32;
        let corner = |dx: f32, dy: f32| (vec3(x + dx * wide, y + dy * 0.5 * tall, 0.0155), Vec3::Z);
        [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)]
    });
}

fn keyboard(b: &mut Builder, p: &Paints) {
    let n = b.segments(4.0, 0);
    b.paint(p.white).pillow(vec3(0.0, TOP + 0.008, 0.14), vec3(0.22, 0.008, 0.065), 0.005, n);
    b.pillow(vec3(0.32, TOP + 0.014, 0.14), vec3(0.03, 0.014, 0.05), 0.014, 2 * n);
    if b.has(0.5) {
        b.paint(p.black);
        let key = b.segments(1.2, 0);
        for row in 0..5 {
            for column in 0..15 {
                let at = vec3(-0.2 + 0.0286 * column as f32, TOP + 0.018, 0.09 + 0.025 * row as f32);
                b.pillow(at, vec3(0.012, 0.003, 0.010), 0.002, key);
            }
        }
    }
}

fn drawers(b: &mut Builder, p: &Paints) {
    let n = b.segments(3.0, 0);
    for k in 0..3 {
        let y = 0.14 + 0.2 * k as f32;
        b.paint(p.white).pillow(vec3(-0.52, y, 0.02), vec3(0.19, 0.096, 0.28), 0.006, n);
        if b.has(0.12) {
            b.paint(p.chrome).beam(vec3(-0.6, y + 0.05, 0.31), vec3(-0.44, y + 0.05, 0.31), 0.012, 0.012);
        }
    }
}

fn chair(b: &mut Builder, p: &Paints, fabric: Paint) {
    let (n, m) = (b.segments(10.0, 0), b.segments(20.0, 3));
    b.paint(fabric).pillow(vec3(0.0, 0.46, 0.0), vec3(0.24, 0.045, 0.23), 0.045, n);
    b.within(Frame::at(0.0, 0.54, 0.23).tilted(0.14), |b| {
        b.pillow(vec3(0.0, 0.26, 0.0), vec3(0.22, 0.25, 0.035), 0.035, n);
    });
    b.paint(p.chrome).cone(vec3(0.0, 0.06, 0.0), vec3(0.0, 0.42, 0.0), 0.028, 0.022, m, false);
    b.paint(p.black);
    b.pipe(&[vec3(0.0, 0.41, 0.05), vec3(0.0, 0.41, 0.27), vec3(0.0, 0.75, 0.29)], 0.02, 0.08, m / 2, m / 3);
    for k in 0..5 {
        let out = around(TURN * k as f32 / 5.0);
        b.beam(out * 0.02 + Vec3::Y * 0.10, out * 0.30 + Vec3::Y * 0.065, 0.04, 0.03);
        if b.has(0.15) {
            b.ball(out * 0.30 + Vec3::Y * 0.03, Vec3::splat(0.03), m);
        }
    }
}

/// A jointed desk lamp: none of its bars is parallel to an axis.
fn lamp(b: &mut Builder, p: &Paints) {
    let (n, m) = (b.segments(36.0, 4), b.segments(12.0, 1));
    let (elbow, head) = (vec3(-0.16, 0.34, -0.05), vec3(0.12, 0.52, 0.06));
    b.paint(p.black).rod(Vec3::ZERO, Vec3::Y * 0.02, 0.08, n);
    for off in [-0.012, 0.012] {
        let side = vec3(0.0, 0.0, off);
        b.cone(vec3(0.0, 0.02, 0.0) + side, elbow + side, 0.006, 0.006, n / 5, false);
        b.cone(elbow + side, head + side, 0.006, 0.006, n / 5, false);
    }
    b.within(Frame::upright(head, vec3(-0.4, 1.0, -0.2)), |b| {
        b.lathe(&[vec2(0.085, -0.10), vec2(0.06, -0.04), vec2(0.025, 0.0), vec2(0.0, 0.02)], n, m);
    });
}

/// A mug with an ear.
pub(super) fn mug(b: &mut Builder, paint: Paint) {
    let (n, m) = (b.segments(40.0, 4), b.segments(14.0, 2));
    let profile = [
        vec2(0.036, 0.0),
        vec2(0.04, 0.01),
        vec2(0.04, 0.095),
        vec2(0.036, 0.095),
        vec2(0.035, 0.012),
        vec2(0.0, 0.01),
    ];
    b.paint(paint).lathe(&profile, n, m);
    let ear =
        [vec3(0.036, 0.08, 0.0), vec3(0.075, 0.08, 0.0), vec3(0.075, 0.02, 0.0), vec3(0.036, 0.02, 0.0)];
    b.pipe(&ear, 0.006, 0.025, n / 5, m / 2);
}

/// Stacks of paper and a few books, each sheet of a stack turned a little.
fn papers(b: &mut Builder, p: &Paints, rng: &mut Rng) {
    let sheets = b.count(12.0, 2, 120);
    b.within(Frame::at(0.58, TOP, -0.12).turned(0.3 * rng.signed()), |b| {
        for k in 0..sheets {
            let y = 0.002 + 0.05 * k as f32 / sheets as f32;
            b.paint(p.paper).within(Frame::at(0.0, y, 0.0).turned(0.10 * rng.signed()), |b| {
                b.quad(vec3(-0.105, 0.0, -0.148), Vec3::Z * 0.297, Vec3::X * 0.21);
            });
        }
    });
    let count = rng.below(4);
    b.within(Frame::at(-0.30, TOP, 0.08).turned(0.5 * rng.signed()), |b| {
        for k in 0..count {
            let size = vec3(0.16, 0.03, 0.23) * rng.range(0.8, 1.1);
            b.paint(p.books[rng.below(6) as usize]);
            b.within(Frame::at(0.0, 0.001 + 0.034 * k as f32, 0.0).turned(0.3 * rng.signed()), |b| {
                b.block(0.0, 0.0, 0.0, size);
            });
        }
    });
}
