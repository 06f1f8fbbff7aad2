//! `conference`: a conference room with many chairs, after the Conference of Choi et al. (2013).

mod chair;
mod shell;
mod things;

use super::builder::{Builder, Paint};
use super::frame::Frame;
use super::math::TURN;
use super::stage::{Filler, Stage, lamp, sun, view};
use glam::vec3;

/// Room: x from -W to W, y from 0 to H, z from -D to D; metres.
const W: f32 = 5.0;
const H: f32 = 2.9;
const D: f32 = 3.4;
/// Half length and half width of the table top, and its height; metres.
const TABLE: (f32, f32, f32) = (2.9, 0.85, 0.74);

/// The materials of the room.
struct Paints {
    wall: Paint,
    ceiling: Paint,
    carpet: Paint,
    carpet_dark: Paint,
    walnut: Paint,
    maple: Paint,
    steel: Paint,
    chrome: Paint,
    black: Paint,
    cushion: Paint,
    mesh: Paint,
    blind: Paint,
    pane: Paint,
    glass: Paint,
    lamp: Paint,
    screen: Paint,
    screen_dark: Paint,
    paper: Paint,
    leaf: Paint,
    pot: Paint,
    red: Paint,
    blue: Paint,
    gold: Paint,
}

impl Paints {
    fn new(b: &mut Builder) -> Self {
        Self {
            wall: b.matte("wall", [0.74, 0.72, 0.68]),
            ceiling: b.matte("ceiling tile", [0.82, 0.82, 0.80]),
            carpet: b.matte("carpet", [0.17, 0.19, 0.23]),
            carpet_dark: b.matte("dark carpet", [0.11, 0.13, 0.17]),
            walnut: b.glossy("walnut", [0.20, 0.10, 0.05], 0.16),
            maple: b.glossy("maple", [0.50, 0.33, 0.18], 0.03),
            steel: b.metal("steel", [0.55, 0.55, 0.57], 0.30),
            chrome: b.metal("chrome", [0.80, 0.80, 0.82], 0.70),
            black: b.glossy("black plastic", [0.03, 0.03, 0.032], 0.04),
            cushion: b.matte("upholstery", [0.36, 0.07, 0.05]),
            mesh: b.matte("mesh", [0.07, 0.07, 0.08]),
            blind: b.glossy("blind", [0.78, 0.77, 0.72], 0.0),
            pane: b.pane("window pane", 0.06),
            glass: b.glass("glass", 1.5),
            lamp: b.glow("lamp", [1.15, 1.12, 1.05]),
            screen: b.glow("screen", [0.10, 0.16, 0.26]),
            screen_dark: b.glow("slide", [0.0, 0.02, 0.10]),
            paper: b.matte("paper", [0.85, 0.85, 0.83]),
            leaf: b.glossy("leaf", [0.08, 0.28, 0.05], 0.02),
            pot: b.glossy("pot", [0.60, 0.58, 0.54], 0.04),
            red: b.glossy("red", [0.60, 0.07, 0.04], 0.03),
            blue: b.glossy("blue", [0.05, 0.14, 0.45], 0.03),
            gold: b.glow("chart", [0.85, 0.45, 0.05]),
        }
    }
}

pub(super) fn draw(b: &mut Builder) -> Stage {
    let p = Paints::new(b);
    shell::draw(b, &p);
    things::table(b, &p);
    chairs(b, &p);
    things::draw(b, &p);
    let mut lights =
        vec![sun([0.25, -0.62, 0.75], [0.9, 0.82, 0.66]), lamp([-4.2, 2.3, 0.0], 1.3, [0.25, 0.28, 0.34])];
    for x in [-3.0, 0.0, 3.0] {
        lights.push(lamp([x, H - 0.55, 0.0], 2.1, [0.30, 0.29, 0.27]));
    }
    Stage {
        cameras: vec![
            view([4.45, 1.85, 2.75], [-1.4, 0.75, -0.5], 56.0),
            view([-4.3, 1.60, 2.6], [1.2, 0.85, -0.7], 58.0),
            view([4.55, 1.55, 0.75], [-3.0, 1.0, -0.25], 50.0),
        ],
        lights,
        filler: Filler {
            paint: p.carpet,
            areas: vec![(vec3(-W, 0.0, -D), vec3(W, 0.0, D))],
            length: 0.012,
            width: 0.004,
        },
    }
}

/// Two rows along the table and one chair at its far end, none of them quite straight.
fn chairs(b: &mut Builder, p: &Paints) {
    let (length, width, _) = TABLE;
    let mut rng = b.rng.fork();
    for k in 0..7 {
        let x = length * (-0.84 + 0.28 * k as f32);
        for side in [-1.0, 1.0] {
            let away = width + 0.22 + 0.14 * rng.unit();
            let turn = if side > 0.0 { 0.0 } else { 0.5 * TURN };
            let place =
                Frame::at(x + 0.05 * rng.signed(), 0.0, side * away).turned(turn + 0.22 * rng.signed());
            b.within(place, |b| chair::draw(b, p));
        }
    }
    b.within(Frame::at(length + 0.35, 0.0, 0.25).turned(0.25 * TURN + 0.35), |b| chair::draw(b, p));
}
