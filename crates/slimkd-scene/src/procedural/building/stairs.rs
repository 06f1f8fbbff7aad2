//! The stairs of one storey: two flights and a landing, steel, with railings.

use super::shell::WELL;
use super::{Paints, STOREY, Z};
use crate::procedural::builder::Builder;
use glam::{Vec3, vec3};

/// Steps of a flight.
const STEPS: u32 = 10;

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    let (near, far) = (WELL.1 - 0.9, -Z + 1.5);
    let half = 0.5 * STOREY;
    flight(b, p, -0.75, vec3(0.0, 0.0, near), vec3(0.0, half, far));
    flight(b, p, 0.75, vec3(0.0, half, far), vec3(0.0, STOREY, near));
    b.paint(p.concrete).cuboid(vec3(-WELL.0, half - 0.12, -Z + 0.1), vec3(WELL.0, half, far));
    b.cuboid(vec3(0.02, STOREY - 0.12, near), vec3(WELL.0, STOREY - 0.001, WELL.1));
    // The railing around the well on the upper floor.
    if b.has(0.05) {
        let (a, c) = (vec3(-WELL.0, STOREY, WELL.1), vec3(0.0, STOREY, WELL.1));
        railing(b, p, a, c);
        railing(b, p, vec3(-WELL.0, STOREY, WELL.1 - 1.4), a);
    }
}

/// A flight of the given middle line at `x`: treads on two slanting stringers.
fn flight(b: &mut Builder, p: &Paints, x: f32, from: Vec3, to: Vec3) {
    let steps = if b.has(0.04) { STEPS } else { 1 };
    let (from, to) = (from + Vec3::X * x, to + Vec3::X * x);
    b.paint(p.wood);
    for k in 0..steps {
        let at = from.lerp(to, (k as f32 + 0.5) / steps as f32);
        let deep = (to.z - from.z).abs() / steps as f32;
        b.block(x, at.y - 0.04, at.z, vec3(1.25, 0.05, deep * 1.1));
    }
    b.paint(p.dark_steel);
    for side in [-0.65, 0.65] {
        let off = vec3(side, -0.10, 0.0);
        b.beam(from + off, to + off, 0.03, 0.24);
        if b.has(0.04) {
            railing(b, p, from + off + Vec3::Y * 0.1, to + off + Vec3::Y * 0.1);
        }
    }
}

/// Posts, a hand rail and wires between two points, level or slanting.
fn railing(b: &mut Builder, p: &Paints, from: Vec3, to: Vec3) {
    let n = b.segments(16.0, 3);
    b.paint(p.chrome).cone(from + Vec3::Y * 0.95, to + Vec3::Y * 0.95, 0.022, 0.022, n, true);
    b.paint(p.steel);
    for k in 1..5 {
        let lift = Vec3::Y * (0.18 * k as f32);
        b.cone(from + lift, to + lift, 0.005, 0.005, n / 2, false);
    }
    let posts = if b.has(0.1) { 6 } else { 2 };
    for k in 0..posts {
        let foot = from.lerp(to, k as f32 / (posts - 1) as f32);
        b.cone(foot, foot + Vec3::Y * 0.95, 0.012, 0.012, n, false);
    }
}
