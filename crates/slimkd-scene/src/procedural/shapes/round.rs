//! Surfaces of revolution and balls.

use crate::procedural::builder::{Builder, Closure};
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, around, sin_cos};
use glam::{Vec2, Vec3, vec2};

/// A Catmull-Rom curve through `points` at `t` of 0 to 1, and its derivative. A corner is a point given twice.
fn spline(points: &[Vec2], t: f32) -> (Vec2, Vec2) {
    let spans = points.len() - 1;
    let x = t * spans as f32;
    let k = (x as usize).min(spans - 1);
    let f = x - k as f32;
    let (p1, p2) = (points[k], points[k + 1]);
    // Beyond an end on the axis the curve goes on as its own mirror image, beyond any other one straight.
    let beyond = |end: Vec2, before: Vec2| {
        if end.x == 0.0 { vec2(-before.x, before.y) } else { end * 2.0 - before }
    };
    let p0 = if k > 0 { points[k - 1] } else { beyond(p1, p2) };
    let p3 = if k + 2 < points.len() { points[k + 2] } else { beyond(p2, p1) };
    let (a, b, c) = ((p2 - p0) * 0.5, p0 - p1 * 2.5 + p2 * 2.0 - p3 * 0.5, (p3 - p0) * 0.5 + (p1 - p2) * 1.5);
    (p1 + f * (a + f * (b + f * c)), a + f * (2.0 * b + f * 3.0 * c))
}

/// Least radius between the poles of a lathe, metres: a curve that swings over the axis leaves no collapsed rings.
const LEAST: f32 = 2e-4;

impl Builder {
    /// The smooth curve through `profile` (radius, height), turned about the y axis: `around_` by `along` cells.
    /// Outwards is to the right of the profile's way, so go upwards outside and downwards inside.
    pub(crate) fn lathe(&mut self, profile: &[Vec2], around_: u32, along: u32) {
        let closure = Closure {
            ring: true,
            first_pole: profile[0].x == 0.0,
            last_pole: profile[profile.len() - 1].x == 0.0,
        };
        let along = along.max(if closure.first_pole && closure.last_pole { 2 } else { 1 });
        let along = along.max(profile.len() as u32 - 1);
        self.patch(around_.max(3), along, closure, |u, v| {
            let (p, d) = spline(profile, v);
            let out = around(TURN * u);
            let d = if d == Vec2::ZERO { Vec2::Y } else { d };
            (out * p.x.max(LEAST) + Vec3::Y * p.y, (out * d.y - Vec3::Y * d.x).normalize_or(Vec3::Y))
        });
    }

    /// A cone or cylinder from radius `r0` at `a` to `r1` at `b`, one cell along: skinny quads; open or with caps.
    pub(crate) fn cone(&mut self, a: Vec3, b: Vec3, r0: f32, r1: f32, n: u32, caps: bool) {
        let length = (b - a).length();
        let n = n.max(3);
        self.within(Frame::upright(a, b - a), |b| {
            let slope = (r0 - r1) / length;
            b.patch(n, 1, Closure::RING, |u, v| {
                let out = around(TURN * u);
                (out * (r0 + (r1 - r0) * v) + Vec3::Y * (length * v), out + Vec3::Y * slope)
            });
            if caps {
                b.disc(0.0, r0, n, false);
                b.disc(length, r1, n, true);
            }
        });
    }

    /// A cylinder with caps.
    pub(crate) fn rod(&mut self, a: Vec3, b: Vec3, radius: f32, n: u32) {
        self.cone(a, b, radius, radius, n, true);
    }

    /// A flat disc about the y axis at height `y`: a fan of skinny triangles.
    pub(crate) fn disc(&mut self, y: f32, radius: f32, n: u32, upwards: bool) {
        let normal = if upwards { Vec3::Y } else { Vec3::NEG_Y };
        let closure = Closure { ring: true, first_pole: true, last_pole: false };
        self.patch(n.max(3), 1, closure, |u, v| (around(TURN * u) * (radius * v) + Vec3::Y * y, normal));
    }

    /// A flat ring about the y axis at height `y`, facing up.
    pub(crate) fn annulus(&mut self, y: f32, inner: f32, outer: f32, n: u32) {
        self.patch(n.max(3), 1, Closure::RING, |u, v| {
            (around(TURN * u) * (inner + (outer - inner) * v) + Vec3::Y * y, Vec3::Y)
        });
    }

    /// An ellipsoid with `n` cells around and half as many from pole to pole.
    pub(crate) fn ball(&mut self, center: Vec3, radii: Vec3, n: u32) {
        self.within(Frame::to(center).scaled(radii.x, radii.y, radii.z), |b| {
            b.patch(n.max(3), (n / 2).max(2), Closure::BALL, |u, v| {
                let (s, c) = sin_cos(0.5 * TURN * v);
                let p = around(TURN * u) * s - Vec3::Y * c;
                (p, p)
            });
        });
    }

    /// A torus about the y axis.
    pub(crate) fn torus(&mut self, y: f32, radius: f32, thickness: f32, around_: u32, across: u32) {
        let (nu, nv) = (around_.max(3), across.max(3));
        self.patch(nu, nv, Closure::RING, |u, v| {
            let out = around(TURN * u);
            let (s, c) = if v >= 1.0 { (0.0, 1.0) } else { sin_cos(TURN * v) };
            let normal = out * c + Vec3::Y * s;
            (out * radius + Vec3::Y * y + normal * thickness, normal)
        });
    }
}
