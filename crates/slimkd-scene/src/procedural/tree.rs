//! Trees: limbs that fork, twigs, and leaf cards around the twigs' ends.

use super::builder::{Builder, Paint};
use super::math::{Rng, TURN, cos, sin};
use super::shapes::Leaf;
use glam::Vec3;

/// What one tree is like.
#[derive(Clone, Copy)]
pub(crate) struct Habit {
    /// Length of the trunk up to its first fork, metres.
    pub(crate) trunk: f32,
    /// Radius of the trunk, metres.
    pub(crate) girth: f32,
    /// Leaves at detail 1.
    pub(crate) leaves: f32,
    /// Length of a leaf, metres.
    pub(crate) leaf: f32,
}

/// Draws a tree that stands on the frame's origin.
pub(crate) fn draw(b: &mut Builder, bark: Paint, leaves: [Paint; 2], habit: Habit) {
    let mut rng = b.rng.fork();
    let levels = match () {
        () if b.has(0.4) => 5,
        () if b.has(0.12) => 4,
        () if b.has(0.05) => 3,
        () if b.has(0.035) => 2,
        () => 1,
    };
    let mut tips = Vec::new();
    b.paint(bark);
    let lean = (Vec3::Y + rng.direction() * 0.10).normalize();
    limb(
        b,
        &mut rng,
        Limb { root: Vec3::ZERO, way: lean, length: habit.trunk, radius: habit.girth, level: levels },
        &mut tips,
    );
    let count = b.count(habit.leaves, 30, 4_000_000) as usize;
    // Fewer leaves are larger ones, so that the crown stays closed.
    let size = habit.leaf * (habit.leaves / count as f32).sqrt().sqrt().clamp(0.55, 3.2);
    for (k, paint) in [leaves[0], leaves[1], leaves[0]].into_iter().enumerate() {
        let share = count / 3 + usize::from(k == 0) * (count % 3);
        let spread = 0.30 + 1.5 / (tips.len() as f32).sqrt();
        b.paint(paint).leaves(share, |rng| {
            let tip = tips[rng.below(tips.len() as u32) as usize];
            let base = tip + rng.direction() * (spread * rng.unit());
            Leaf::scattered(rng, base, size, 0.75)
        });
    }
}

struct Limb {
    root: Vec3,
    way: Vec3,
    length: f32,
    radius: f32,
    level: u32,
}

/// A bent, tapering limb and what forks from its end.
fn limb(b: &mut Builder, rng: &mut Rng, limb: Limb, tips: &mut Vec<Vec3>) {
    let thick = (limb.radius * 40.0).clamp(0.35, 2.5);
    let (n, m) = (b.segments(14.0 * thick, 3), b.segments(7.0 * thick, 1));
    let bend = rng.direction() * (0.16 * limb.length);
    let at = |t: f32| limb.root + limb.way * (limb.length * t) + bend * (t * t * (1.5 - t));
    let path: Vec<Vec3> = (0..=m + 1).map(|k| at(k as f32 / (m + 1) as f32)).collect();
    let flare = if limb.root == Vec3::ZERO { 0.45 } else { 0.0 };
    b.tube_by(&path, n, |k| {
        let t = k as f32 / (m + 1) as f32;
        limb.radius * (1.0 - 0.38 * t + flare * (1.0 - t) * (1.0 - t) * (1.0 - t))
    });
    let end = at(1.0);
    if limb.level == 0 {
        tips.push(end);
        return;
    }
    if limb.level == 1 {
        tips.push(at(0.6));
    }
    let forks = 3;
    let start = rng.range(0.0, TURN);
    let side = limb.way.any_orthonormal_vector();
    let other = limb.way.cross(side);
    for k in 0..forks {
        let angle = start + TURN * (k as f32 + 0.35 * rng.signed()) / forks as f32;
        let open = rng.range(0.55, 1.0);
        let out = side * cos(angle) + other * sin(angle);
        let way = (limb.way + out * open + Vec3::Y * 0.12).normalize_or(Vec3::Y);
        let child = Limb {
            root: end - limb.way * (0.05 * limb.length),
            way,
            length: limb.length * rng.range(0.60, 0.82),
            radius: limb.radius * 0.58,
            level: limb.level - 1,
        };
        self::limb(b, rng, child, tips);
    }
}
