//! A swivel chair that faces -z.

use super::Paints;
use crate::procedural::builder::{Builder, Closure};
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, around};
use glam::{Vec3, vec2, vec3};

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    if !b.has(0.03) {
        b.paint(p.black).cone(Vec3::ZERO, Vec3::Y * 0.43, 0.28, 0.03, 3, false);
        b.paint(p.cushion).cuboid(vec3(-0.25, 0.43, -0.24), vec3(0.25, 0.52, 0.24));
        return b.quad(vec3(-0.23, 0.56, 0.22), Vec3::X * 0.46, vec3(0.0, 0.54, 0.1));
    }
    base(b, p);
    // The seat: a cushion on a shell.
    let n = b.segments(14.0, 0);
    b.paint(p.cushion).pillow(vec3(0.0, 0.475, 0.0), vec3(0.25, 0.045, 0.24), 0.045, n);
    b.paint(p.black).pillow(vec3(0.0, 0.425, 0.0), vec3(0.22, 0.012, 0.21), 0.012, n / 2);
    back(b, p);
    arms(b, p);
}

fn base(b: &mut Builder, p: &Paints) {
    let n = b.segments(28.0, 3);
    b.paint(p.chrome).cone(vec3(0.0, 0.08, 0.0), vec3(0.0, 0.42, 0.0), 0.026, 0.020, n, false);
    let spokes = if b.has(0.03) { 5 } else { 3 };
    for k in 0..spokes {
        let out = around(TURN * (k as f32 + 0.3) / spokes as f32);
        b.paint(p.chrome).beam(out * 0.02 + Vec3::Y * 0.115, out * 0.31 + Vec3::Y * 0.078, 0.042, 0.03);
        if !b.has(0.07) {
            continue;
        }
        // Twin wheels on a fork.
        b.paint(p.black);
        let across = out.cross(Vec3::Y);
        let hub = out * 0.30 + Vec3::Y * 0.031;
        let m = b.segments(26.0, 4);
        for side in [-1.0, 1.0] {
            b.within(Frame::upright(hub + across * (0.014 * side), across), |b| {
                let r = 0.031;
                let wheel = [
                    vec2(0.0, -0.009),
                    vec2(0.8 * r, -0.009),
                    vec2(r, 0.0),
                    vec2(0.8 * r, 0.009),
                    vec2(0.0, 0.009),
                ];
                b.lathe(&wheel, m, m / 4);
            });
        }
        b.rod(hub, hub + Vec3::Y * 0.04, 0.008, m / 3);
    }
}

/// A woven back in a bent frame: a curved sheet of strands at high detail, a plain one otherwise.
fn back(b: &mut Builder, p: &Paints) {
    let sheet = |u: f32, v: f32, off: f32| {
        let x = 0.46 * (u - 0.5);
        let bow = 0.28 * x * x;
        let y = 0.56 + 0.54 * v;
        let lean = 0.22 + 0.09 * v + 0.06 * (v - 0.35) * (v - 0.35);
        vec3(x * (1.0 - 0.18 * v * v), y, lean - bow * 1.6 + off)
    };
    let m = b.segments(20.0, 2);
    // The frame runs around the sheet's edge.
    let mut rim = Vec::new();
    for k in 0..=m {
        rim.push(sheet(0.0, k as f32 / m as f32, 0.0));
    }
    for k in 1..=m {
        rim.push(sheet(k as f32 / m as f32, 1.0, 0.0));
    }
    for k in 1..=m {
        rim.push(sheet(1.0, 1.0 - k as f32 / m as f32, 0.0));
    }
    let n = b.segments(12.0, 3);
    b.paint(p.black).tube(&rim, 0.013, n);
    let stem = [vec3(0.0, 0.41, 0.05), vec3(0.0, 0.41, 0.27), vec3(0.0, 0.56, 0.28), vec3(0.0, 0.80, 0.275)];
    let bend = b.segments(8.0, 1);
    b.pipe(&stem, 0.018, 0.06, n, bend);
    let (nu, nv) = (b.segments(36.0, 2), b.segments(44.0, 2));
    b.paint(p.cushion);
    for (off, flip) in [(-0.012, -1.0), (0.006, 1.0)] {
        b.patch(nu, nv, Closure::OPEN, |u, v| {
            let e = 0.01;
            let at = sheet(u, v, off);
            let normal = (sheet(u + e, v, off) - at).cross(sheet(u, v + e, off) - at);
            (at, normal.normalize() * flip)
        });
    }
    // Piping across the upholstery.
    if b.has(0.12) {
        b.paint(p.mesh);
        for row in 1..6 {
            let v = row as f32 / 6.0;
            let seam: Vec<Vec3> = (0..=m).map(|k| sheet(k as f32 / m as f32, v, -0.013)).collect();
            b.tube(&seam, 0.004, n / 2);
        }
    }
}

fn arms(b: &mut Builder, p: &Paints) {
    if !b.has(0.04) {
        return;
    }
    let (n, m) = (b.segments(14.0, 3), b.segments(8.0, 1));
    let pad = b.segments(6.0, 0);
    for x in [-0.27, 0.27] {
        let inner = 0.6 * x;
        b.paint(p.black);
        b.pipe(&[vec3(inner, 0.42, 0.02), vec3(x, 0.42, 0.02), vec3(x, 0.66, 0.02)], 0.013, 0.05, n, m);
        b.pillow(vec3(x, 0.675, -0.01), vec3(0.038, 0.014, 0.13), 0.014, pad);
    }
}
