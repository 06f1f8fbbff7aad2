//! What a geometry says of its surfaces: their rings, and what they are made of.

use super::{
    city::Fault,
    json::{self, Geometry, Root},
};
use glam::Vec3;

/// How many lists enclose an index, for geometries of surfaces.
pub(super) fn depth(geometry: &Geometry<'_>) -> Option<usize> {
    match &*geometry.kind {
        "MultiSurface" | "CompositeSurface" => Some(3),
        "Solid" => Some(4),
        "MultiSolid" | "CompositeSolid" => Some(5),
        _ => None,
    }
}

/// The boundaries of a geometry as surfaces of rings.
pub(super) struct Lists<'a> {
    pub(super) nested: &'a json::Nested,
    pub(super) depth: usize,
    /// How many surfaces there are.
    pub(super) count: usize,
}

impl<'a> Lists<'a> {
    pub(super) fn of(geometry: &'a Geometry<'_>) -> Result<Self, Fault> {
        let (nested, depth) = (&geometry.boundaries, depth(geometry).unwrap_or(3));
        if nested.depth() == 0 {
            return Ok(Self { nested, depth, count: 0 });
        }
        if nested.depth() != depth {
            let what = format!("a {} has lists {} deep, not {depth}", geometry.kind, nested.depth());
            return Err(Fault::Wrong(what));
        }
        Ok(Self { nested, depth, count: nested.count(depth - 2) })
    }

    pub(super) fn rings(&self, surface: usize) -> std::ops::Range<usize> {
        self.nested.range(self.depth - 2, surface)
    }

    pub(super) fn ring(&self, ring: usize) -> &'a [u32] {
        &self.nested.values[self.nested.range(self.depth - 1, ring)]
    }
}

/// What the surfaces of a geometry are made of.
pub(super) struct Materials<'a> {
    pub(super) list: &'a [json::Material<'a>],
    /// One for all, or one for each surface.
    pub(super) all: Option<usize>,
    pub(super) each: &'a [u32],
    pub(super) classes: &'a [json::Surface<'a>],
    pub(super) class_of: &'a [u32],
}

impl<'a> Materials<'a> {
    pub(super) fn of(root: &'a Root<'a>, geometry: &'a Geometry<'a>, surfaces: usize) -> Self {
        let theme = geometry.material.as_ref().and_then(|themes| themes.0.as_ref());
        let semantics = geometry.semantics.as_ref();
        // Lists of another length do not say which surface they mean.
        let fitting = |values: &'a [u32]| if values.len() == surfaces { values } else { &[] };
        Self {
            list: root.appearance.as_ref().map_or(&[], |appearance| &appearance.materials),
            all: theme.and_then(|theme| theme.value),
            each: theme.map_or(&[], |theme| fitting(&theme.values.values)),
            classes: semantics.map_or(&[], |semantics| &semantics.surfaces),
            class_of: semantics.map_or(&[], |semantics| fitting(&semantics.values.values)),
        }
    }

    /// The material in the appearance.
    pub(super) fn painted(&self, surface: usize) -> Option<usize> {
        let index = self.all.or_else(|| self.each.get(surface).map(|&index| index as usize))?;
        (index < self.list.len()).then_some(index)
    }

    /// Which of the semantic surfaces it is.
    pub(super) fn class(&self, surface: usize) -> Option<u32> {
        let class = *self.class_of.get(surface)?;
        ((class as usize) < self.classes.len()).then_some(class)
    }
}

pub(super) fn share(value: f32) -> f32 {
    if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
}

/// What a kind of surface or object looks like, roughly.
pub(super) fn colour(class: &str) -> Vec3 {
    match class {
        "RoofSurface" => Vec3::new(0.5, 0.17, 0.12),
        "Window" | "Door" => Vec3::new(0.2, 0.25, 0.3),
        "WaterBody" | "WaterSurface" | "WaterGroundSurface" => Vec3::new(0.1, 0.25, 0.45),
        "PlantCover" | "SolitaryVegetationObject" => Vec3::new(0.1, 0.3, 0.08),
        "LandUse" | "TINRelief" | "GroundSurface" => Vec3::new(0.35, 0.32, 0.25),
        "Road" | "Railway" | "TransportSquare" | "TrafficArea" | "AuxiliaryTrafficArea" => Vec3::splat(0.25),
        _ => Vec3::splat(0.7),
    }
}
