//! Tubes along paths: pipes with elbows, cables, branches.

use crate::procedural::builder::{Builder, Closure};
use crate::procedural::math::{TURN, sin_cos};
use glam::Vec3;

/// The quarter-turn-like arc that rounds the corner `b` of a → b → c at `radius`, as `n` + 1 points.
fn elbow(a: Vec3, b: Vec3, c: Vec3, radius: f32, n: u32, out: &mut Vec<Vec3>) {
    let (u, v) = ((a - b).normalize_or(Vec3::X), (c - b).normalize_or(Vec3::Y));
    // tan of half the angle between the legs, from its cosine: no arcus functions needed.
    let cosine = u.dot(v).clamp(-0.999, 0.999);
    let half_tan = ((1.0 - cosine) / (1.0 + cosine)).sqrt();
    let leg = (radius / half_tan).min(0.49 * (a - b).length()).min(0.49 * (c - b).length());
    let (p, q) = (b + u * leg, b + v * leg);
    let center = b + (u + v).normalize_or(u) * (leg * (1.0 + half_tan * half_tan).sqrt());
    let r = (p - center).length();
    for k in 0..=n {
        // Points of the chord pushed out to the circle: even enough for a quarter turn.
        let chord = p.lerp(q, k as f32 / n as f32);
        out.push(center + (chord - center).normalize_or(u) * r);
    }
}

impl Builder {
    /// A tube of `n` sides along `path`; `radius` at each point.
    pub(crate) fn tube_by(&mut self, path: &[Vec3], n: u32, radius: impl Fn(usize) -> f32) {
        if path.len() < 2 {
            return;
        }
        let mut frames = Vec::with_capacity(path.len());
        let mut side = (path[1] - path[0]).normalize_or(Vec3::Y).any_orthonormal_vector();
        for k in 0..path.len() {
            let way = path[(k + 1).min(path.len() - 1)] - path[k.saturating_sub(1)];
            let way = way.normalize_or(Vec3::Y);
            side = (side - way * side.dot(way)).normalize_or(way.any_orthonormal_vector());
            frames.push((side, way.cross(side)));
        }
        let rows = path.len() as u32 - 1;
        self.patch(n.max(3), rows, Closure::RING, |u, v| {
            let k = (v * rows as f32).round() as usize;
            let (s, c) = sin_cos(TURN * u);
            let normal = frames[k].0 * c + frames[k].1 * s;
            (path[k] + normal * radius(k), normal)
        });
    }

    /// A tube of one radius.
    pub(crate) fn tube(&mut self, path: &[Vec3], radius: f32, n: u32) {
        self.tube_by(path, n, |_| radius);
    }

    /// A pipe through `corners`: straight runs of long skinny quads, elbows of `bend` radius with `m` cells along.
    pub(crate) fn pipe(&mut self, corners: &[Vec3], radius: f32, bend: f32, n: u32, m: u32) {
        let mut path = vec![corners[0]];
        for legs in corners.windows(3) {
            elbow(legs[0], legs[1], legs[2], bend, m.max(1), &mut path);
        }
        path.push(corners[corners.len() - 1]);
        self.tube(&path, radius, n);
    }

    /// A cable that sags by `sag` between its ends: long skinny triangles, seldom parallel to an axis.
    pub(crate) fn cable(&mut self, a: Vec3, b: Vec3, sag: f32, radius: f32, n: u32, m: u32) {
        let m = m.max(2);
        let path: Vec<Vec3> = (0..=m)
            .map(|k| {
                let t = k as f32 / m as f32;
                a.lerp(b, t) - Vec3::Y * (4.0 * sag * t * (1.0 - t))
            })
            .collect();
        self.tube(&path, radius, n);
    }
}
