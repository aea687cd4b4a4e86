//! Torus knots.

use super::grid::closed_grid;
use glam::DVec3;
use packer::TriangleMesh;
use std::f64::consts::TAU;

/// A tube along the (`p`, `q`) torus knot: `p` turns about the y axis, `q` about the tube of the torus.
///
/// `p` and `q` without common factor make one closed knot; (2, 3) is the trefoil. `radii` are those of the torus
/// that carries the knot, major and minor, and of the tube around it (m); the tube must be thin enough to leave
/// the strands apart. `segments` counts the facets along the knot (≥ 3) and around the tube (≥ 3).
#[must_use]
pub fn torus_knot(p: u32, q: u32, radii: [f64; 3], segments: [u32; 2]) -> TriangleMesh {
    let [along, around] = segments.map(|n| n.max(3));
    let [.., tube] = radii;
    closed_grid(along, around, |i, j| {
        let Frame { center, normal, binormal } = frame(p, q, radii, f64::from(i) / f64::from(along));
        let (sin, cos) = libm::sincos(TAU * f64::from(j) / f64::from(around));
        center + (normal * cos + binormal * sin) * tube
    })
}

/// A cross-section of the tube.
struct Frame {
    center: DVec3,
    normal: DVec3,
    binormal: DVec3,
}

/// The cross-section at `turn` (0 to 1) of the way around the knot.
///
/// The frame leans on the normal of the carrying torus, which is perpendicular to every curve on it and comes
/// back to itself: no twist has to be spread over the tube to close it, as with rotation-minimising frames.
fn frame(p: u32, q: u32, [major, minor, _]: [f64; 3], turn: f64) -> Frame {
    let (p, q) = (f64::from(p), f64::from(q));
    let (sin_u, cos_u) = libm::sincos(TAU * p * turn);
    let (sin_v, cos_v) = libm::sincos(TAU * q * turn);
    let outwards = DVec3::new(cos_u, 0.0, -sin_u);
    let onwards = DVec3::new(-sin_u, 0.0, -cos_u);
    let radius = major + minor * cos_v;
    let normal = outwards * cos_v + DVec3::Y * sin_v;
    let tangent = onwards * (p * radius) + (DVec3::Y * cos_v - outwards * sin_v) * (q * minor);
    Frame {
        center: outwards * radius + DVec3::Y * (minor * sin_v),
        normal,
        binormal: normal.cross(tangent.normalize_or(onwards)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::check::{Expected, assert_solid};
    use std::f64::consts::PI;

    /// A tube's volume is its section times the length of its centre line (Pappus), however it winds.
    fn closed_form(p: u32, q: u32, radii: [f64; 3]) -> f64 {
        let steps = 100_000;
        let point = |i: u32| frame(p, q, radii, f64::from(i) / f64::from(steps)).center;
        let length: f64 = (0..steps).map(|i| point(i).distance(point(i + 1))).sum();
        PI * radii[2] * radii[2] * length
    }

    #[test]
    fn knots_are_closed_tubes() {
        for (p, q) in [(2, 3), (3, 2), (1, 1), (2, 5)] {
            let radii = [0.4, 0.15, 0.05];
            let mesh = torus_knot(p, q, radii, [512, 32]);
            let volume = closed_form(p, q, radii);
            assert_solid(&mesh, &Expected { volume, tolerance: 1e-2, euler: 0 });
        }
    }
}
