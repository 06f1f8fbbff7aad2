//! The coordinates of split planes.

/// The coordinates that a layout gives its split planes in: `(x − low) · scale + shift` on each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Planes {
    pub(crate) low: [f32; 3],
    /// Powers of two.
    pub(crate) scale: [f32; 3],
    /// Their reciprocals.
    pub(crate) unscale: [f32; 3],
    pub(crate) shift: f32,
    /// How far a plane may stand from where it was chosen, in these coordinates.
    pub(crate) cell: f32,
}

impl Planes {
    /// Exact planes in scene units.
    pub(crate) const WORLD: Self =
        Self { low: [0.0; 3], scale: [1.0; 3], unscale: [1.0; 3], shift: 0.0, cell: 0.0 };

    /// A plane in scene units, and how far it may stand from where it was chosen.
    pub(crate) fn exact(&self, axis: usize, split: f32) -> (f64, f64) {
        let unscale = f64::from(self.unscale[axis]);
        let place = (f64::from(split) - f64::from(self.shift)) * unscale;
        (place + f64::from(self.low[axis]), f64::from(self.cell) * unscale)
    }

    /// A plane in scene units.
    pub(crate) fn world(&self, axis: usize, split: f32) -> f32 {
        (split - self.shift) * self.unscale[axis] + self.low[axis]
    }
}
