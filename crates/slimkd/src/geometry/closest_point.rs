//! The point of a triangle that is nearest to a point.
//!
//! Source: Ericson, *Real-Time Collision Detection*, 2005, §5.1.5.
//!
//! Deviations
//! 1. In f64, and by candidates instead of regions: the nearest point of each edge, and the foot of the perpendicular
//!    where it lies inside. Each is a convex combination of corners, so each lies on the triangle up to 2⁻⁵⁰ of the
//!    distance to its corners, however thin it is; a region misjudged by rounding costs no more than that.
//! 2. Edges run from their lexicographically smaller end: neighbours find the same point of a shared edge.

/// A candidate: its place as seen from the point, and the weights of corners 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    /// Squared distance.
    pub(crate) square: f64,
    /// From the point to the triangle's nearest point.
    pub(crate) offset: [f64; 3],
    pub(crate) u: f64,
    pub(crate) v: f64,
}

type Vector = [f64; 3];

fn sub(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

/// Finite corners, finite point.
pub(crate) fn nearest_on_triangle(point: [f32; 3], corners: &[[f32; 3]; 3]) -> Nearest {
    let from = point.map(f64::from);
    let seen = corners.map(|corner| sub(corner.map(f64::from), from));
    let mut best = Nearest { square: f64::INFINITY, offset: [0.0; 3], u: 0.0, v: 0.0 };
    let mut try_weights = |[a, b, c]: [f64; 3]| {
        let offset = std::array::from_fn(|k| a * seen[0][k] + b * seen[1][k] + c * seen[2][k]);
        let square = dot(offset, offset);
        if square < best.square {
            best = Nearest { square, offset, u: b, v: c };
        }
    };
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let (i, j) = if corners[i] <= corners[j] { (i, j) } else { (j, i) };
        let along = sub(seen[j], seen[i]);
        // Of an edge without a length any point will do.
        let part = (-dot(seen[i], along) / dot(along, along)).clamp(0.0, 1.0);
        let part = if part.is_nan() { 0.0 } else { part };
        let mut weights = [0.0; 3];
        (weights[i], weights[j]) = (1.0 - part, part);
        try_weights(weights);
    }
    let [a, b, c] = seen;
    let normal = cross(sub(b, a), sub(c, a));
    let weights = [cross(b, c), cross(c, a), cross(a, b)].map(|inner| dot(normal, inner));
    let sum = weights[0] + weights[1] + weights[2];
    if weights.iter().all(|&weight| weight > 0.0) && sum.is_finite() {
        try_weights(weights.map(|weight| weight / sum));
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    #[test]
    fn faces_edges_and_corners() {
        for (point, square, u, v) in [
            ([0.25, 0.25, 2.0], 4.0, 0.25, 0.25),
            ([0.25, 0.25, 0.0], 0.0, 0.25, 0.25),
            ([0.5, -3.0, 0.0], 9.0, 0.5, 0.0),
            ([-1.0, 0.75, 0.0], 1.0, 0.0, 0.75),
            ([1.0, 1.0, 0.0], 0.5, 0.5, 0.5),
            ([-1.0, -1.0, 1.0], 3.0, 0.0, 0.0),
            ([3.0, -1.0, 0.0], 5.0, 1.0, 0.0),
        ] {
            let found = nearest_on_triangle(point, &UNIT);
            assert_eq!((found.square, found.u, found.v), (square, u, v), "{point:?}");
        }
    }

    #[test]
    fn neighbours_agree_on_a_shared_edge() {
        let (a, b) = ([0.1, 0.2, 0.3], [0.7, -0.4, 0.9]);
        let left = nearest_on_triangle([0.3, 0.4, 5.0], &[a, b, [0.0, 0.0, -9.0]]);
        let right = nearest_on_triangle([0.3, 0.4, 5.0], &[b, a, [1.0, 1.0, -9.0]]);
        assert_eq!(left.square, right.square);
    }

    #[test]
    fn needles_keep_their_length() {
        let needle = [[0.0, 0.0, 0.0], [1e6, 0.0, 0.0], [1e6, 1e-6, 0.0]];
        let found = nearest_on_triangle([5e5, 1.0, 0.0], &needle);
        // Half-way along, the upper edge is half as high as at its end.
        assert!((found.square.sqrt() - (1.0 - 0.5e-6)).abs() < 1e-9, "{found:?}");
    }
}
