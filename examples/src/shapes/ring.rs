//! The torus.

use super::grid::closed_grid;
use glam::DVec3;
use packer::TriangleMesh;
use std::f64::consts::TAU;

/// A torus about the y axis: centre line of radius `major`, tube of radius `minor < major` (m).
///
/// `segments` counts the facets around the axis (≥ 3) and around the tube (≥ 3).
#[must_use]
pub fn ring(major: f64, minor: f64, segments: [u32; 2]) -> TriangleMesh {
    let [around, tube] = segments.map(|n| n.max(3));
    closed_grid(around, tube, |i, j| {
        let (sin_u, cos_u) = libm::sincos(TAU * f64::from(i) / f64::from(around));
        let (sin_v, cos_v) = libm::sincos(TAU * f64::from(j) / f64::from(tube));
        let radius = major + minor * cos_v;
        // The axis angle runs from x towards −z, so that axis step × tube step points outwards.
        DVec3::new(radius * cos_u, minor * sin_v, -radius * sin_u)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::check::{Expected, assert_solid};
    use std::f64::consts::PI;

    #[test]
    fn is_a_closed_torus() {
        let mesh = ring(0.5, 0.15, [96, 48]);
        let volume = 2.0 * PI * PI * 0.5 * 0.15 * 0.15;
        assert_solid(&mesh, &Expected { volume, tolerance: 5e-3, euler: 0 });
    }

    #[test]
    fn the_coarsest_one_is_closed_too() {
        let mesh = ring(0.5, 0.1, [0, 1]);
        assert_eq!(mesh.triangles.len(), 18);
        // A regular n-gon swept along an n-gon: section area × n sin(2π/n) × distance of its centre.
        let section = 0.75 * 3.0_f64.sqrt() * 0.1 * 0.1;
        let volume = section * 3.0 * (TAU / 3.0).sin() * 0.5;
        assert_solid(&mesh, &Expected { volume, tolerance: 1e-12, euler: 0 });
    }
}
