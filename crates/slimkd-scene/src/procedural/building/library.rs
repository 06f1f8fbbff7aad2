//! A wing full of book shelves, with reading tables.

use super::{Paints, desk};
use crate::procedural::builder::Builder;
use crate::procedural::frame::Frame;
use crate::procedural::math::TURN;
use glam::{Vec3, vec3};

/// Length, height and depth of a double-sided shelf, metres.
const LENGTH: f32 = 3.6;
const HEIGHT: f32 = 2.1;
const DEPTH: f32 = 0.5;
/// Boards of a shelf.
const BOARDS: u32 = 6;

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    let rows = if b.has(0.05) { 6 } else { 2 };
    for k in 0..rows {
        let x = 5.6 + 10.8 * k as f32 / (rows - 1) as f32;
        b.within(Frame::at(x, 0.0, -3.9).turned(0.25 * TURN), |b| shelf(b, p));
    }
    let tables = if b.has(0.05) { 3 } else { 1 };
    for k in 0..tables {
        let x = 6.0 + 4.4 * k as f32;
        for side in [1.0, -1.0] {
            let turn = if side > 0.0 { 0.0 } else { 0.5 * TURN };
            b.within(Frame::at(x, 0.0, 3.0 + 0.4 * side).turned(turn), |b| desk::draw(b, p));
        }
    }
    if !b.has(0.03) {
        return;
    }
    // A glazed wall towards the core.
    b.paint(p.inner_pane).quad(vec3(4.2, 0.0, -6.0), Vec3::Z * 5.0, Vec3::Y * 2.4);
    b.paint(p.dark_steel);
    for k in 0..6 {
        b.block(4.2, 0.0, -6.0 + k as f32, vec3(0.04, 2.4, 0.04));
    }
}

fn shelf(b: &mut Builder, p: &Paints) {
    b.paint(p.wood);
    if !b.has(0.03) {
        return b.block(0.0, 0.0, 0.0, vec3(LENGTH, HEIGHT, DEPTH));
    }
    for x in [-0.5 * LENGTH, 0.0, 0.5 * LENGTH] {
        b.block(x, 0.0, 0.0, vec3(0.03, HEIGHT, DEPTH));
    }
    for k in 0..=BOARDS {
        let y = 0.08 + (HEIGHT - 0.11) * k as f32 / BOARDS as f32;
        b.block(0.0, y, 0.0, vec3(LENGTH, 0.025, DEPTH));
    }
    b.cuboid(vec3(-0.5 * LENGTH, 0.08, -0.006), vec3(0.5 * LENGTH, HEIGHT, 0.006));
    if !b.has(0.07) {
        return;
    }
    for side in [1.0, -1.0] {
        let frame = Frame::IDENTITY.turned(if side > 0.0 { 0.0 } else { 0.5 * TURN });
        b.within(frame, |b| {
            for k in 0..BOARDS {
                let y = 0.08 + (HEIGHT - 0.11) * k as f32 / BOARDS as f32 + 0.026;
                for half in [-1.0, 1.0] {
                    let left = if half < 0.0 { -0.5 * LENGTH } else { 0.0 };
                    row(b, p, vec3(left + 0.03, y, 0.03), 0.5 * LENGTH - 0.05);
                }
            }
        });
    }
}

/// A row of books from `start` on: upright, some leaning, with gaps.
fn row(b: &mut Builder, p: &Paints, start: Vec3, length: f32) {
    let mut rng = b.rng.fork();
    let n = b.segments(0.9, 0);
    let wide = if b.has(0.25) { 1.0 } else { 3.0 };
    let mut x = 0.0;
    while x < length - 0.08 * wide {
        let thick = wide * rng.range(0.018, 0.05);
        let size = vec3(thick, rng.range(0.20, 0.29), rng.range(0.14, 0.20));
        b.paint(p.books[rng.below(6) as usize]);
        let lean = if rng.below(9) == 0 { 0.18 } else { 0.0 };
        if lean > 0.0 {
            b.within(Frame::to(start + vec3(x + 0.03, 0.012, 0.10)), |b| {
                let top = vec3(lean * size.y, size.y, 0.0);
                b.beam(Vec3::ZERO, top, size.z, thick);
            });
            x += 0.06;
        } else {
            b.within(Frame::to(start + vec3(x + 0.5 * thick, 0.001, 0.10)), |b| {
                b.pillow(vec3(0.0, 0.5 * size.y, 0.0), 0.5 * size, 0.004, n);
            });
        }
        x += thick + 0.002;
        if rng.below(14) == 0 {
            x += rng.range(0.05, 0.25);
        }
    }
}
