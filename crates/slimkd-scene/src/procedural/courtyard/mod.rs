//! `courtyard`: arcades, tiled roofs, trees and a fountain, after San Miguel in Choi et al. (2013).

mod arcade;
mod garden;
mod roof;

use super::builder::{Builder, Paint};
use super::frame::Frame;
use super::math::TURN;
use super::stage::{Filler, Stage, sun, view};
use glam::vec3;

/// Half the side of the open court, metres; columns stand on this square.
const COURT: f32 = 9.0;
/// Half the side of the building, metres.
const OUTER: f32 = 12.4;
/// Height of the springing of the arches, of the upper floor and of the eaves, metres.
const LEVELS: [f32; 3] = [2.5, 4.5, 7.6];
/// Arches a side.
const BAYS: u32 = 6;
/// Inner and outer edge of the four garden beds, metres from the axes.
const BED: (f32, f32) = (2.5, 7.3);

/// The materials of the court.
struct Paints {
    plaster: Paint,
    upper: Paint,
    stone: Paint,
    stone_dark: Paint,
    cobble: Paint,
    cobble_light: Paint,
    tile: Paint,
    tile_dark: Paint,
    wood: Paint,
    green_wood: Paint,
    iron: Paint,
    pane: Paint,
    dark: Paint,
    water: Paint,
    spray: Paint,
    soil: Paint,
    grass: Paint,
    bark: Paint,
    leaf: Paint,
    leaf_light: Paint,
    hedge: Paint,
    flower: Paint,
    flower_white: Paint,
    clay: Paint,
    bulb: Paint,
}

impl Paints {
    fn new(b: &mut Builder) -> Self {
        Self {
            plaster: b.matte("plaster", [0.70, 0.52, 0.32]),
            upper: b.matte("upper plaster", [0.74, 0.36, 0.20]),
            stone: b.matte("stone", [0.62, 0.57, 0.48]),
            stone_dark: b.matte("dark stone", [0.40, 0.36, 0.30]),
            cobble: b.matte("cobble", [0.34, 0.30, 0.26]),
            cobble_light: b.matte("light cobble", [0.47, 0.42, 0.35]),
            tile: b.matte("roof tile", [0.56, 0.22, 0.11]),
            tile_dark: b.matte("weathered tile", [0.42, 0.17, 0.10]),
            wood: b.matte("beam", [0.20, 0.12, 0.07]),
            green_wood: b.matte("shutter", [0.08, 0.26, 0.22]),
            iron: b.metal("iron", [0.09, 0.09, 0.10], 0.05),
            pane: b.glossy("window pane", [0.05, 0.07, 0.09], 0.35),
            dark: b.matte("room", [0.06, 0.05, 0.045]),
            water: b.glass("water", 1.33),
            spray: b.glossy("spray", [0.75, 0.82, 0.86], 0.10),
            soil: b.matte("soil", [0.11, 0.15, 0.05]),
            grass: b.matte("grass", [0.16, 0.34, 0.06]),
            bark: b.matte("bark", [0.22, 0.16, 0.11]),
            leaf: b.glossy("leaf", [0.17, 0.44, 0.07], 0.0),
            leaf_light: b.glossy("young leaf", [0.34, 0.56, 0.10], 0.0),
            hedge: b.matte("hedge", [0.10, 0.28, 0.05]),
            flower: b.matte("flower", [0.75, 0.08, 0.22]),
            flower_white: b.matte("white flower", [0.85, 0.82, 0.76]),
            clay: b.matte("terracotta", [0.58, 0.26, 0.14]),
            bulb: b.glow("bulb", [1.5, 1.2, 0.7]),
        }
    }
}

pub(super) fn draw(b: &mut Builder) -> Stage {
    let p = Paints::new(b);
    for side in 0..4 {
        b.within(Frame::IDENTITY.turned(0.25 * TURN * side as f32), |b| {
            arcade::draw(b, &p);
            roof::draw(b, &p);
        });
    }
    garden::draw(b, &p);
    let (near, far) = (BED.0 + 0.4, BED.1 - 0.4);
    let areas = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, z): (f32, f32)| {
        let (a, c) = (vec3(x * near, 0.06, z * near), vec3(x * far, 0.06, z * far));
        (a.min(c), a.max(c))
    });
    Stage {
        cameras: vec![
            view([1.75, 1.75, 8.6], [-1.5, 2.35, -2.6], 62.0),
            view([-0.6, 6.7, 7.9], [0.9, 1.4, -1.8], 62.0),
            view([-10.4, 1.65, 9.6], [-9.5, 1.9, -4.0], 60.0),
        ],
        lights: vec![
            sun([-0.50, -0.80, -0.33], [1.15, 1.05, 0.88]),
            sun([0.5, -0.5, 0.6], [0.10, 0.12, 0.16]),
        ],
        filler: Filler { paint: p.grass, areas: areas.to_vec(), length: 0.12, width: 0.008 },
    }
}
