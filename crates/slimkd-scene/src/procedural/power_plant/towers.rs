//! Chimneys, the cooling tower, lattice pylons with their lines, and the conveyor.

use super::{Paints, steelwork};
use crate::procedural::builder::{Builder, Closure};
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, around};
use glam::{Vec3, vec2, vec3};

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    let all = if b.has(0.03) { 2 } else { 1 };
    for x in [-33.0, -41.0].into_iter().take(all) {
        b.within(Frame::at(x, 0.0, -14.0), |b| chimney(b, p));
    }
    b.within(Frame::at(14.0, 0.0, -62.0), |b| cooling_tower(b, p));
    if b.has(0.03) {
        b.within(Frame::at(-42.0, 0.0, -78.0), |b| cooling_tower(b, p));
    }
    flue(b, p);
    conveyor(b, p);
    lines(b, p);
}

/// A tapering chimney in red and white bands with platforms and a ladder.
fn chimney(b: &mut Builder, p: &Paints) {
    let (height, bands) = (62.0f32, if b.has(0.04) { 9 } else { 3 });
    let n = b.segments(90.0, 5);
    let radius = |t: f32| 2.6 - 1.1 * t;
    for k in 0..bands {
        let (t0, t1) = (k as f32 / bands as f32, (k + 1) as f32 / bands as f32);
        b.paint(if k < bands / 2 || k % 2 == 0 { p.concrete } else { p.red });
        b.cone(vec3(0.0, height * t0, 0.0), vec3(0.0, height * t1, 0.0), radius(t0), radius(t1), n, false);
    }
    b.paint(p.dark).within(Frame::at(0.0, height - 0.3, 0.0), |b| b.disc(0.0, radius(1.0), n, true));
    if !b.has(0.06) {
        return;
    }
    for t in [0.4, 0.7, 0.97] {
        let (y, r) = (height * t, radius(t));
        b.within(Frame::at(0.0, y, 0.0), |b| {
            b.paint(p.grating).annulus(0.0, r, r + 1.0, n);
            let ring: Vec<Vec3> = (0..=16).map(|k| around(TURN * k as f32 / 16.0) * (r + 0.95)).collect();
            steelwork::railing(b, p, &ring);
        });
    }
    steelwork::ladder(b, p, vec3(2.75, 0.0, 0.0), 0.4 * height, Vec3::NEG_Z);
}

/// A hyperboloid shell on a ring of slanting struts.
fn cooling_tower(b: &mut Builder, p: &Paints) {
    let (n, m) = (b.segments(200.0, 8), b.segments(90.0, 3));
    let (base, height) = (3.4, 46.0);
    // r² = a² + c (y - throat)²: a ruled surface of one sheet.
    let radius = |v: f32| {
        let y = v - 0.72;
        (11.5f32 * 11.5 + 520.0 * y * y).sqrt()
    };
    b.paint(p.concrete);
    let skins = if b.has(0.03) { 2 } else { 1 };
    for (inset, sign) in [(0.0, 1.0), (0.35, -1.0)].into_iter().take(skins) {
        b.patch(n, m, Closure::RING, |u, v| {
            let out = around(TURN * u);
            let slope = (radius(v + 0.01) - radius(v - 0.01)) / (0.02 * height);
            (out * (radius(v) - inset) + Vec3::Y * (base + height * v), (out - Vec3::Y * slope) * sign)
        });
    }
    b.within(Frame::at(0.0, base + height, 0.0), |b| b.annulus(0.0, radius(1.0) - 0.35, radius(1.0), n));
    let struts = if b.has(0.05) { 40 } else { 6 };
    let (sides, r) = (b.segments(14.0, 3), radius(0.0) - 0.15);
    for k in 0..struts {
        let at = |k: f32, out: f32, y: f32| around(TURN * k / struts as f32) * (r + out) + Vec3::Y * y;
        let foot = at(k as f32, 1.2, 0.0);
        for side in [-0.5, 0.5] {
            b.cone(foot, at(k as f32 + side, 0.0, base + 0.1), 0.28, 0.28, sides, false);
        }
    }
}

/// The flue from the boiler to the chimneys: a box duct with stiffeners.
fn flue(b: &mut Builder, p: &Paints) {
    b.paint(p.boiler);
    b.beam(vec3(-17.6, 24.0, 0.0), vec3(-28.0, 14.0, -12.0), 3.0, 3.0);
    b.beam(vec3(-27.0, 14.5, -12.0), vec3(-40.0, 12.0, -14.0), 3.0, 3.0);
    b.paint(p.steel);
    let ribs = if b.has(0.06) { 12 } else { 0 };
    for k in 0..ribs {
        let (from, to) = (vec3(-18.4, 23.2, -1.0), vec3(-27.0, 15.0, -10.8));
        let at = from.lerp(to, k as f32 / ribs as f32);
        let way = (to - from).normalize() * 0.1;
        b.beam(at - way, at + way, 3.25, 3.25);
    }
    for (x, z) in [(-28.0, -10.6), (-28.0, -13.6), (-35.0, -11.8), (-35.0, -15.0)] {
        b.beam(vec3(x, 0.0, z), vec3(x, 12.4, z), 0.35, 0.35);
    }
}

/// A slanting lattice bridge that brings coal up to the boiler house.
fn conveyor(b: &mut Builder, p: &Paints) {
    let (from, to) = (vec3(-12.0, 1.5, 62.0), vec3(-12.0, 27.0, 12.5));
    let across = Vec3::X * 1.3;
    let up = vec3(0.0, 1.4, 0.72) * 1.5;
    b.paint(p.yellow);
    for side in [-1.0, 1.0] {
        for lift in [0.0, 1.0] {
            b.beam(from + across * side + up * lift, to + across * side + up * lift, 0.2, 0.2);
        }
    }
    let fields = if b.has(0.05) { 22 } else { 3 };
    for k in 0..fields {
        let (a, c) = (from.lerp(to, k as f32 / fields as f32), from.lerp(to, (k + 1) as f32 / fields as f32));
        for side in [-1.0, 1.0] {
            let (a, c) = (a + across * side, c + across * side);
            if k % 2 == 0 { b.beam(a, c + up, 0.1, 0.1) } else { b.beam(a + up, c, 0.1, 0.1) }
        }
        if b.has(0.05) {
            b.beam(a - across + up, c + across + up, 0.08, 0.08);
        }
    }
    let way = to - from;
    b.paint(p.dark).beam(from + Vec3::Y * 0.5, to + Vec3::Y * 0.5, 1.5, 0.06);
    b.paint(p.galvanised).beam(from + up * 1.05, to + up * 1.05, 2.9, 0.06);
    if b.has(0.1) {
        let (rollers, n) = (70, b.segments(18.0, 3));
        b.paint(p.galvanised);
        for k in 0..rollers {
            let at = from + way * ((k as f32 + 0.5) / rollers as f32) + Vec3::Y * 0.38;
            b.rod(at - across * 0.6, at + across * 0.6, 0.09, n);
        }
        let heap = [vec2(9.0, 0.0), vec2(5.0, 2.6), vec2(1.2, 5.2), vec2(0.0, 5.4)];
        let (n, m) = (b.segments(80.0, 8), b.segments(24.0, 2));
        b.paint(p.dark).within(Frame::at(-14.0, 0.0, 66.0), |b| b.lathe(&heap, n, m));
    }
    b.paint(p.steel);
    for t in [0.25, 0.5, 0.75] {
        let head = from + way * t;
        for side in [-1.0, 1.0] {
            b.beam(head.with_y(0.0) + across * (2.4 * side), head + across * side, 0.25, 0.25);
        }
    }
}

/// Two pylons and the lines between them and the plant.
fn lines(b: &mut Builder, p: &Paints) {
    if !b.has(0.035) {
        return;
    }
    let places = [vec3(58.0, 0.0, -14.0), vec3(72.0, 0.0, -62.0)];
    for place in places {
        b.within(Frame::to(place).turned(0.3), |b| pylon(b, p));
    }
    let arms = [(-4.2, 17.0), (4.2, 17.0), (-3.2, 21.0), (3.2, 21.0), (-2.2, 25.0), (2.2, 25.0)];
    let (n, m) = (b.segments(7.0, 3), b.segments(50.0, 4));
    for (x, y) in arms {
        let tie = |place: Vec3| place + vec3(0.955 * x, y - 1.3, -0.295 * x);
        b.paint(p.cable).cable(tie(places[0]), tie(places[1]), 2.6, 0.03, n, m);
        b.cable(vec3(31.5, 9.0 + 0.12 * y, -9.0 + 0.5 * x), tie(places[0]), 1.2, 0.03, n, m);
        if b.has(0.08) {
            let (k, rows) = (b.segments(20.0, 4), b.segments(8.0, 2));
            b.paint(p.insulator);
            for place in places {
                for disc in 0..7 {
                    b.within(Frame::to(tie(place) + Vec3::Y * (0.2 + 0.14 * disc as f32)), |b| {
                        b.lathe(
                            &[
                                vec2(0.0, -0.03),
                                vec2(0.14, -0.02),
                                vec2(0.15, 0.0),
                                vec2(0.05, 0.05),
                                vec2(0.0, 0.06),
                            ],
                            k,
                            rows,
                        );
                    });
                }
            }
        }
    }
}

/// A lattice mast: four legs, crossed bars on each face, three pairs of arms.
fn pylon(b: &mut Builder, p: &Paints) {
    let (height, fields) = (28.0, if b.has(0.05) { 11 } else { 4 });
    let leg = |k: u32, t: f32| {
        let half = 2.6 * (1.0 - t) * (1.0 - 0.4 * t) + 0.22;
        let (x, z) = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)][(k % 4) as usize];
        vec3(x * half, height * t, z * half)
    };
    b.paint(p.galvanised);
    for field in 0..fields {
        let (t0, t1) = (field as f32 / fields as f32, (field + 1) as f32 / fields as f32);
        for k in 0..4 {
            b.beam(leg(k, t0), leg(k, t1), 0.14, 0.14);
            b.beam(leg(k, t0), leg(k + 1, t1), 0.07, 0.07);
            b.beam(leg(k + 1, t0), leg(k, t1), 0.07, 0.07);
        }
    }
    for (reach, y) in [(4.2, 17.0), (3.2, 21.0), (2.2, 25.0)] {
        for side in [-1.0, 1.0] {
            let tip = vec3(side * reach, y, 0.0);
            for z in [-0.5, 0.5] {
                b.beam(vec3(0.0, y, z), tip, 0.08, 0.08);
                b.beam(vec3(0.0, y + 1.3, z), tip, 0.08, 0.08);
            }
        }
    }
}
