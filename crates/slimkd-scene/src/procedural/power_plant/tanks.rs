//! The tank farm: domed tanks with ladders, railings and winding stairs, horizontal bullets, spheres.

use super::{Paints, steelwork};
use crate::procedural::builder::Builder;
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, around};
use glam::{Vec3, vec2, vec3};

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    let count = if b.has(0.04) { 4 } else { 2 };
    for k in 0..count {
        let x = 9.0 + 10.5 * k as f32;
        b.within(Frame::at(x, 0.0, 25.5), |b| tank(b, p, 4.2, 7.5 + 0.8 * (k % 2) as f32));
    }
    sphere(b, p);
    if b.has(0.05) {
        // A bund wall around the tanks.
        b.paint(p.concrete);
        for (min, max) in [
            (vec3(3.0, 0.0, 19.6), vec3(46.5, 0.8, 19.8)),
            (vec3(3.0, 0.0, 31.2), vec3(46.5, 0.8, 31.4)),
            (vec3(3.0, 0.0, 19.8), vec3(3.2, 0.8, 31.2)),
        ] {
            b.cuboid(min, max);
        }
    }
}

fn tank(b: &mut Builder, p: &Paints, radius: f32, height: f32) {
    let (n, m) = (b.segments(160.0, 6), b.segments(24.0, 1));
    b.paint(p.white).cone(Vec3::ZERO, vec3(0.0, height, 0.0), radius, radius, n, false);
    b.lathe(&[vec2(radius, height), vec2(0.55 * radius, height + 0.75), vec2(0.0, height + 1.0)], n, m);
    if !b.has(0.05) {
        return;
    }
    b.paint(p.galvanised);
    for k in 0..5 {
        b.torus(height * k as f32 / 4.0, radius + 0.02, 0.05, n, m / 4);
    }
    // Winding stairs: treads around half of the shell, a hand rail in short slanting pieces.
    let treads = if b.has(0.1) { 44 } else { 12 };
    let at = |k: f32, out: f32| {
        let t = k / treads as f32;
        around(0.9 + 0.5 * TURN * t) * (radius + out) + Vec3::Y * (height * t)
    };
    for k in 0..treads {
        let t = k as f32 + 0.5;
        b.paint(p.grating).beam(at(t, 0.05), at(t, 0.95), 0.03, 0.27);
    }
    let rail: Vec<Vec3> = (0..=treads).map(|k| at(k as f32, 0.95)).collect();
    let sides = b.segments(8.0, 3);
    b.paint(p.yellow);
    for lift in [0.1, 0.55, 1.05] {
        let path: Vec<Vec3> = rail.iter().map(|&q| q + Vec3::Y * lift).collect();
        b.tube(&path, 0.024, sides);
    }
    for foot in rail.iter().step_by(3) {
        b.cone(*foot, *foot + Vec3::Y * 1.05, 0.02, 0.02, sides, false);
    }
    let ring: Vec<Vec3> =
        (0..=24).map(|k| around(TURN * k as f32 / 24.0) * (radius - 0.1) + Vec3::Y * height).collect();
    steelwork::railing(b, p, &ring);
    steelwork::ladder(b, p, around(4.4) * (radius + 0.2), height, around(4.4 + 0.25 * TURN));
    // A nozzle with a valve towards the rack.
    let bend = b.segments(10.0, 1);
    let nozzle = [
        vec3(0.0, 0.7, -radius),
        vec3(0.0, 0.7, -radius - 3.2),
        vec3(0.0, 3.45, -radius - 3.2),
        vec3(0.0, 3.45, -10.6),
    ];
    b.paint(p.blue).pipe(&nozzle, 0.18, 0.5, n / 5, bend);
    steelwork::valve(b, p, vec3(0.0, 0.7, -radius - 1.2), Vec3::NEG_Z, 0.18);
    steelwork::flange(b, p, vec3(0.0, 0.7, -radius - 2.2), Vec3::NEG_Z, 0.18);
}

/// A gas sphere on splayed legs with cross bracing.
fn sphere(b: &mut Builder, p: &Paints) {
    let n = b.segments(150.0, 8);
    let (x, z, radius, up) = (52.0, 3.0, 5.0, 7.0);
    b.within(Frame::at(x, 0.0, z), |b| {
        b.paint(p.white).ball(vec3(0.0, up, 0.0), Vec3::splat(radius), n);
        let legs = if b.has(0.04) { 10 } else { 4 };
        let foot = |k: u32| around(TURN * k as f32 / legs as f32) * (radius + 0.4);
        let head = |k: u32| around(TURN * k as f32 / legs as f32) * (radius - 0.1) + Vec3::Y * (up - 0.8);
        let sides = b.segments(20.0, 3);
        for k in 0..legs {
            b.paint(p.steel).cone(foot(k), head(k), 0.22, 0.22, sides, false);
            b.paint(p.galvanised);
            b.cone(foot(k), head(k + 1), 0.035, 0.035, sides / 2, false);
            b.cone(foot(k + 1), head(k), 0.035, 0.035, sides / 2, false);
        }
        if !b.has(0.03) {
            return;
        }
        b.paint(p.red).torus(up, radius + 0.02, 0.06, n, sides / 2);
    });
}
