//! Railings, stairs, ladders, gratings, flanges and valves: the parts that repeat all over the plant.

use super::Paints;
use crate::procedural::builder::Builder;
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, around, sin_cos};
use glam::{Vec3, vec2, vec3};

/// A railing along a polyline: posts, hand rail, knee rail.
pub(super) fn railing(b: &mut Builder, p: &Paints, points: &[Vec3]) {
    if !b.has(0.045) {
        return;
    }
    let n = b.segments(10.0, 3);
    b.paint(p.yellow);
    for ends in points.windows(2) {
        let (from, to) = (ends[0], ends[1]);
        for height in [1.05, 0.55] {
            b.cone(from + Vec3::Y * height, to + Vec3::Y * height, 0.024, 0.024, n, false);
        }
        b.beam(from + Vec3::Y * 0.06, to + Vec3::Y * 0.06, 0.008, 0.12);
        let posts = ((to - from).length() / if b.has(0.12) { 1.3 } else { 4.0 }) as u32 + 1;
        for k in 0..=posts {
            let foot = from.lerp(to, k as f32 / posts as f32);
            b.cone(foot, foot + Vec3::Y * 1.05, 0.022, 0.022, n, false);
        }
    }
}

/// The floor of a platform between two corners: bearing bars and cross rods where there is detail for them.
pub(super) fn grating(b: &mut Builder, p: &Paints, min: Vec3, max: Vec3) {
    let size = max - min;
    b.paint(p.grating);
    if !b.has(0.16) {
        b.cuboid(min - Vec3::Y * 0.04, max);
        return;
    }
    let pitch = (0.16 / b.detail.sqrt()).clamp(0.05, 0.30);
    let bars = (size.x / pitch) as u32;
    for k in 0..=bars {
        let x = min.x + size.x * k as f32 / bars as f32;
        b.cuboid(vec3(x - 0.005, min.y - 0.04, min.z), vec3(x + 0.005, max.y, max.z));
    }
    let rods = (size.z / (3.0 * pitch)) as u32 + 1;
    for k in 0..=rods {
        let z = min.z + size.z * k as f32 / rods as f32;
        b.cuboid(vec3(min.x, min.y - 0.012, z - 0.004), vec3(max.x, max.y - 0.002, z + 0.004));
    }
    b.paint(p.steel);
    for (a, c) in [
        (vec3(0.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0)),
        (vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 1.0)),
        (vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 1.0)),
        (vec3(1.0, 0.0, 0.0), vec3(1.0, 0.0, 1.0)),
    ] {
        let down = Vec3::Y * -0.1;
        b.beam(min + size * a + down, min + size * c + down, 0.08, 0.16);
    }
}

/// A flight of grating treads between two slanting stringers, with railings.
pub(super) fn stairs(b: &mut Builder, p: &Paints, from: Vec3, to: Vec3, width: f32) {
    let run = (to - from).with_y(0.0);
    let across = Vec3::Y.cross(run).normalize_or(Vec3::X) * (0.5 * width);
    b.paint(p.steel);
    for side in [-1.0, 1.0] {
        b.beam(from + across * side, to + across * side, 0.03, 0.26);
    }
    let rise = match () {
        () if b.has(0.05) => 0.2,
        () if b.has(0.03) => 1.0,
        () => 100.0,
    };
    let steps = ((to.y - from.y) / rise) as u32 + 1;
    b.paint(p.grating);
    for k in 0..steps {
        let at = from.lerp(to, (k as f32 + 0.5) / steps as f32);
        b.beam(at - across, at + across, 0.26, 0.03);
    }
    for side in [-1.0, 1.0] {
        railing(b, p, &[from + across * side, to + across * side]);
    }
}

/// A ladder up from `foot`, with a safety cage; its rungs run along `across`.
pub(super) fn ladder(b: &mut Builder, p: &Paints, foot: Vec3, height: f32, across: Vec3) {
    if !b.has(0.06) {
        return;
    }
    let (n, m) = (b.segments(8.0, 3), b.segments(14.0, 3));
    let half = across * 0.22;
    b.paint(p.yellow);
    for side in [-1.0, 1.0] {
        b.cone(foot + half * side, foot + half * side + Vec3::Y * height, 0.02, 0.02, n, false);
    }
    let rungs = (height / 0.3) as u32;
    for k in 1..rungs {
        let at = foot + Vec3::Y * (0.3 * k as f32);
        b.cone(at - half, at + half, 0.011, 0.011, n, false);
    }
    let out = across.cross(Vec3::Y);
    let hoops = (height / 1.2) as u32;
    let bow = |angle: f32| {
        let (s, c) = sin_cos(angle);
        across * (0.36 * c) + out * (0.62 * s)
    };
    for k in 2..=hoops {
        let at = foot + Vec3::Y * (height * k as f32 / hoops as f32);
        let hoop: Vec<Vec3> = (0..=m).map(|i| at + bow(0.5 * TURN * i as f32 / m as f32)).collect();
        b.tube(&hoop, 0.010, n);
    }
    for k in 0..5 {
        let off = bow(0.5 * TURN * (k as f32 + 0.5) / 5.0);
        b.cone(foot + off + Vec3::Y * 2.2, foot + off + Vec3::Y * height, 0.010, 0.010, n, false);
    }
}

/// A pair of flanges around a pipe at `at` along `way`, with a ring of bolts.
pub(super) fn flange(b: &mut Builder, p: &Paints, at: Vec3, way: Vec3, radius: f32) {
    if !b.has(0.10) {
        return;
    }
    let n = b.segments(40.0, 5);
    let (r, bolts) = (1.45 * radius, if b.has(0.35) { 12 } else { 6 });
    let nut = b.segments(9.0, 3);
    b.within(Frame::upright(at, way), |b| {
        b.paint(p.galvanised);
        for side in [-1.0f32, 1.0] {
            let y = side * 0.03;
            let (low, high) = (y - 0.02, y + 0.02);
            b.cone(vec3(0.0, low, 0.0), vec3(0.0, high, 0.0), r, r, n, true);
        }
        b.paint(p.dark);
        for k in 0..bolts {
            let out = around(TURN * k as f32 / bolts as f32) * (0.5 * (r + radius));
            b.rod(out - Vec3::Y * 0.075, out + Vec3::Y * 0.075, 0.06 * r, nut.min(12));
            if b.has(0.8) {
                b.ball(out + Vec3::Y * 0.075, Vec3::splat(0.085 * r), nut);
            }
        }
    });
}

/// A gate valve on a pipe at `at` along `way`: body, bonnet, stem and hand wheel upwards.
pub(super) fn valve(b: &mut Builder, p: &Paints, at: Vec3, way: Vec3, radius: f32) {
    if !b.has(0.08) {
        return;
    }
    let (n, m) = (b.segments(44.0, 4), b.segments(28.0, 2));
    let r = radius;
    b.within(Frame::upright(at, way), |b| {
        let body = [
            vec2(r, -2.4 * r),
            vec2(1.1 * r, -1.6 * r),
            vec2(1.7 * r, -0.7 * r),
            vec2(1.7 * r, 0.7 * r),
            vec2(1.1 * r, 1.6 * r),
            vec2(r, 2.4 * r),
        ];
        b.paint(p.green).lathe(&body, n, m);
    });
    b.within(Frame::to(at), |b| {
        b.paint(p.green).cone(vec3(0.0, r, 0.0), vec3(0.0, 3.2 * r, 0.0), r, 0.6 * r, n, true);
        b.paint(p.chrome).cone(
            vec3(0.0, 3.2 * r, 0.0),
            vec3(0.0, 5.0 * r, 0.0),
            0.16 * r,
            0.16 * r,
            n / 4,
            true,
        );
        b.paint(p.red).torus(4.6 * r, 1.8 * r, 0.17 * r, n, m / 2);
        for k in 0..3 {
            let out = around(0.5 * TURN * k as f32 / 3.0) * (1.8 * r);
            let lift = Vec3::Y * (4.6 * r);
            b.cone(lift - out, lift + out, 0.10 * r, 0.10 * r, n / 5, false);
        }
    });
    for side in [-1.0, 1.0] {
        flange(b, p, at + way * (side * 2.4 * r), way, radius);
    }
}
