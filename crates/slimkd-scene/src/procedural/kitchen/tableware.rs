//! Pots, plates, cups, bottles, cutlery and fruit; each stands on the origin of the frame.

use crate::procedural::builder::{Builder, Paint};
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, around, sin_cos};
use crate::procedural::shapes::Leaf;
use glam::{Vec2, Vec3, vec2, vec3};

/// A pot of `radius` and `height` with a lid, a knob and two ears.
pub(super) fn pot(b: &mut Builder, paint: Paint, trim: Paint, radius: f32, height: f32) {
    let (n, m) = (b.segments(72.0, 6), b.segments(16.0, 1));
    let (r, h) = (radius, height);
    b.paint(paint).lathe(&[vec2(0.0, 0.0), vec2(0.9 * r, 0.0), vec2(r, 0.1 * h), vec2(r, h)], n, m);
    let lid = [vec2(1.03 * r, h), vec2(0.8 * r, 1.1 * h), vec2(0.0, 1.18 * h)];
    b.lathe(&lid, n, m);
    let small = b.segments(24.0, 4);
    b.paint(trim).ball(vec3(0.0, 1.26 * h, 0.0), Vec3::splat(0.14 * r), small);
    for side in [-1.0, 1.0] {
        let (x, y) = (side * r, 0.75 * h);
        let out = side * 0.35 * r;
        let corners = [
            vec3(x, y, -0.3 * r),
            vec3(x + out, y, -0.3 * r),
            vec3(x + out, y, 0.3 * r),
            vec3(x, y, 0.3 * r),
        ];
        b.pipe(&corners, 0.05 * r, 0.2 * r, small / 2, small / 3);
    }
}

/// A frying pan with a long handle.
pub(super) fn pan(b: &mut Builder, paint: Paint, grip: Paint) {
    let (n, m) = (b.segments(72.0, 6), b.segments(16.0, 1));
    let profile = [
        vec2(0.0, 0.036),
        vec2(0.10, 0.036),
        vec2(0.125, 0.085),
        vec2(0.13, 0.085),
        vec2(0.108, 0.033),
        vec2(0.0, 0.033),
    ];
    b.paint(paint).lathe(&profile, n, m);
    b.paint(grip).cone(vec3(0.08, 0.07, 0.08), vec3(0.24, 0.10, 0.20), 0.009, 0.013, n / 4, true);
}

/// A kettle with a spout and a bow.
pub(super) fn kettle(b: &mut Builder, paint: Paint, grip: Paint) {
    let (n, m) = (b.segments(80.0, 6), b.segments(36.0, 3));
    let body = [
        vec2(0.0, 0.035),
        vec2(0.085, 0.035),
        vec2(0.105, 0.07),
        vec2(0.095, 0.13),
        vec2(0.045, 0.17),
        vec2(0.0, 0.175),
    ];
    b.paint(paint).lathe(&body, n, m);
    b.ball(vec3(0.0, 0.19, 0.0), Vec3::splat(0.016), n / 3);
    let spout = [vec3(0.08, 0.09, 0.0), vec3(0.13, 0.11, 0.0), vec3(0.15, 0.16, 0.0), vec3(0.17, 0.17, 0.0)];
    b.tube_by(&spout, n / 3, |k| 0.024 - 0.004 * k as f32);
    let bow: Vec<Vec3> = (0..=m)
        .map(|k| {
            let (s, c) = sin_cos(0.5 * TURN * k as f32 / m as f32);
            vec3(0.085 * c, 0.13 + 0.13 * s, 0.0)
        })
        .collect();
    b.paint(grip).tube(&bow, 0.007, n / 5);
}

/// A stack of `count` plates.
pub(super) fn plates(b: &mut Builder, paint: Paint, count: u32) {
    let (n, m) = (b.segments(72.0, 6), b.segments(12.0, 1));
    let profile = [
        vec2(0.0, 0.006),
        vec2(0.08, 0.006),
        vec2(0.10, 0.013),
        vec2(0.135, 0.022),
        vec2(0.135, 0.018),
        vec2(0.09, 0.004),
        vec2(0.075, 0.0),
    ];
    // The upper side runs outwards; both faces come from one curve around the rim.
    let reversed: Vec<Vec2> = profile.iter().rev().copied().collect();
    b.paint(paint);
    for k in 0..if b.has(0.1) { count } else { 1 } {
        b.within(Frame::at(0.0, 0.007 * k as f32, 0.0), |b| b.lathe(&reversed, n, m));
    }
}

/// A bowl of `radius`.
pub(super) fn bowl(b: &mut Builder, paint: Paint, radius: f32) {
    let (n, m) = (b.segments(80.0, 8), b.segments(28.0, 2));
    let r = radius;
    let profile = [
        vec2(0.4 * r, 0.0),
        vec2(0.42 * r, 0.06 * r),
        vec2(0.8 * r, 0.28 * r),
        vec2(r, 0.62 * r),
        vec2(0.97 * r, 0.62 * r),
        vec2(0.75 * r, 0.30 * r),
        vec2(0.38 * r, 0.12 * r),
        vec2(0.0, 0.10 * r),
    ];
    b.paint(paint).lathe(&profile, n, m);
}

/// A cup with an ear.
pub(super) fn cup(b: &mut Builder, paint: Paint) {
    let (n, m) = (b.segments(56.0, 6), b.segments(24.0, 2));
    let profile = [
        vec2(0.028, 0.0),
        vec2(0.040, 0.02),
        vec2(0.042, 0.085),
        vec2(0.039, 0.085),
        vec2(0.036, 0.02),
        vec2(0.0, 0.008),
    ];
    b.paint(paint).lathe(&profile, n, m);
    let ear: Vec<Vec3> = (0..=m)
        .map(|k| {
            let (s, c) = sin_cos(0.5 * TURN * k as f32 / m as f32);
            vec3(0.038 + 0.03 * s, 0.045 + 0.025 * c, 0.0)
        })
        .collect();
    b.tube(&ear, 0.005, n / 6);
}

/// A wine bottle.
pub(super) fn bottle(b: &mut Builder, paint: Paint) {
    let (n, m) = (b.segments(56.0, 5), b.segments(40.0, 3));
    let profile = [
        vec2(0.0, 0.0),
        vec2(0.035, 0.0),
        vec2(0.038, 0.02),
        vec2(0.038, 0.17),
        vec2(0.030, 0.205),
        vec2(0.014, 0.235),
        vec2(0.0135, 0.30),
        vec2(0.0, 0.301),
    ];
    b.paint(paint).lathe(&profile, n, m);
}

/// A glass jar with a wooden lid and something in it.
pub(super) fn jar(b: &mut Builder, glass: Paint, lid: Paint, filling: Paint) {
    let (n, m) = (b.segments(56.0, 5), b.segments(24.0, 1));
    let outside = [vec2(0.0, 0.0), vec2(0.055, 0.0), vec2(0.06, 0.015), vec2(0.06, 0.13), vec2(0.045, 0.155)];
    b.paint(glass).lathe(&outside, n, m);
    b.paint(lid).rod(vec3(0.0, 0.155, 0.0), vec3(0.0, 0.178, 0.0), 0.048, n);
    if !b.has(0.2) {
        return;
    }
    let grain = b.segments(7.0, 3);
    let mut rng = b.rng.fork();
    b.paint(filling);
    for k in 0..36 {
        let out = around(rng.range(0.0, TURN)) * (0.042 * rng.unit().sqrt());
        let center = out + Vec3::Y * (0.016 + 0.0026 * k as f32);
        b.ball(center, Vec3::splat(0.011), grain);
    }
}

/// A stemmed glass: outside and inside of the bowl, so that light refracts twice.
pub(super) fn wine_glass(b: &mut Builder, paint: Paint) {
    let (n, m) = (b.segments(64.0, 6), b.segments(44.0, 7));
    let profile = [
        vec2(0.0, 0.0),
        vec2(0.034, 0.001),
        vec2(0.008, 0.010),
        vec2(0.0045, 0.05),
        vec2(0.006, 0.085),
        vec2(0.030, 0.105),
        vec2(0.038, 0.145),
        vec2(0.032, 0.19),
        vec2(0.0305, 0.19),
        vec2(0.0365, 0.145),
        vec2(0.0285, 0.107),
        vec2(0.0, 0.092),
    ];
    b.paint(paint).lathe(&profile, n, m);
}

/// A water carafe.
pub(super) fn carafe(b: &mut Builder, paint: Paint) {
    let (n, m) = (b.segments(64.0, 6), b.segments(44.0, 4));
    let profile = [
        vec2(0.0, 0.0),
        vec2(0.05, 0.0),
        vec2(0.068, 0.04),
        vec2(0.055, 0.11),
        vec2(0.026, 0.17),
        vec2(0.036, 0.23),
        vec2(0.034, 0.23),
        vec2(0.024, 0.17),
        vec2(0.053, 0.11),
        vec2(0.065, 0.04),
        vec2(0.0, 0.006),
    ];
    b.paint(paint).lathe(&profile, n, m);
}

/// A table knife along z.
pub(super) fn knife(b: &mut Builder, at: Vec3) {
    let n = b.segments(4.0, 0);
    b.pillow(at + Vec3::Z * 0.06, vec3(0.007, 0.004, 0.05), 0.004, n);
    b.pillow(at - Vec3::Z * 0.05, vec3(0.009, 0.0012, 0.06), 0.001, n);
}

/// A fork along z.
pub(super) fn fork(b: &mut Builder, at: Vec3) {
    let n = b.segments(4.0, 0);
    b.pillow(at + Vec3::Z * 0.05, vec3(0.006, 0.003, 0.06), 0.003, n);
    b.pillow(at - Vec3::Z * 0.025, vec3(0.011, 0.0015, 0.016), 0.0015, n);
    for k in -1..=1 {
        let tine = at + vec3(0.0085 * k as f32, 0.0, -0.04);
        b.beam(tine, tine + vec3(0.0, 0.003, -0.045), 0.003, 0.002);
    }
}

/// An apple with a stalk.
pub(super) fn apple(b: &mut Builder, paint: Paint, stalk: Paint, at: Vec3) {
    let (n, m) = (b.segments(56.0, 6), b.segments(32.0, 3));
    let profile = [
        vec2(0.0, -0.030),
        vec2(0.018, -0.036),
        vec2(0.038, -0.010),
        vec2(0.040, 0.012),
        vec2(0.022, 0.034),
        vec2(0.0, 0.022),
    ];
    b.within(Frame::to(at).tilted(0.3), |b| {
        b.paint(paint).lathe(&profile, n, m);
        b.paint(stalk).cone(vec3(0.0, 0.02, 0.0), vec3(0.006, 0.05, 0.0), 0.0015, 0.002, n / 8, true);
    });
}

/// A lemon that lies on its side.
pub(super) fn lemon(b: &mut Builder, paint: Paint, at: Vec3) {
    let (n, m) = (b.segments(44.0, 5), b.segments(26.0, 3));
    let profile = [
        vec2(0.0, -0.046),
        vec2(0.010, -0.040),
        vec2(0.031, -0.012),
        vec2(0.031, 0.012),
        vec2(0.010, 0.040),
        vec2(0.0, 0.046),
    ];
    b.within(Frame::to(at).tilted(0.25 * TURN).turned(at.x * 9.0), |b| {
        b.paint(paint).lathe(&profile, n, m);
    });
}

/// A banana, bent in a vertical plane.
pub(super) fn banana(b: &mut Builder, paint: Paint, at: Vec3, turn: f32) {
    let (n, m) = (b.segments(24.0, 5), b.segments(28.0, 4));
    b.within(Frame::to(at).turned(turn), |b| {
        let path: Vec<Vec3> = (0..=m)
            .map(|k| {
                let (s, c) = sin_cos(1.9 * (k as f32 / m as f32 - 0.5));
                vec3(0.09 * s, 0.07 * (c - 1.0), 0.0)
            })
            .collect();
        b.paint(paint).tube_by(&path, n, |k| {
            let t = 2.0 * k as f32 / m as f32 - 1.0;
            0.017 * (1.0 - t * t * t * t).max(0.0).sqrt() + 0.002
        });
    });
}

/// A potted herb.
pub(super) fn herb(b: &mut Builder, pot: Paint, leaf: Paint) {
    let (n, m) = (b.segments(48.0, 5), b.segments(12.0, 1));
    let profile = [
        vec2(0.0, 0.0),
        vec2(0.045, 0.0),
        vec2(0.06, 0.10),
        vec2(0.066, 0.10),
        vec2(0.066, 0.125),
        vec2(0.055, 0.125),
        vec2(0.0, 0.10),
    ];
    b.paint(pot).lathe(&profile, n, m);
    let count = b.count(900.0, 12, 60_000) as usize;
    b.paint(leaf).leaves(count, |rng| {
        let way = (rng.direction() + Vec3::Y * 0.7).normalize_or(Vec3::Y);
        let base = vec3(0.0, 0.12, 0.0) + way * (0.17 * rng.unit().sqrt());
        let way = (way + rng.direction() * 0.7).normalize_or(Vec3::Y);
        Leaf { base, way: way * rng.range(0.025, 0.05), width: rng.range(0.012, 0.022), droop: 0.25 }
    });
}
