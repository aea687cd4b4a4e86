//! What a packing promises, checked without the library's own searches.

use crate::common::surface::{distance, winding_number};
use glam::DVec3;
use ist::SpherePacking;
use packer::{Solid, TriangleMesh};
use std::f64::consts::TAU;

/// Certifies `packing` of `solid` against `mesh`, the triangles that it was made from, consistently oriented.
pub(crate) fn certify(name: &str, mesh: &TriangleMesh, solid: &Solid, packing: &SpherePacking) {
    let size = solid.size();
    let d = solid.diagnosis();
    let overlaps =
        d.self_intersections.count + d.covering_faces.count + d.hidden_faces + d.cut_faces + d.paired_faces
            > 0;
    for (i, sphere) in packing.spheres().iter().enumerate() {
        let (center, radius) = (sphere.center.as_dvec3(), f64::from(sphere.radius));
        let winding = winding_number(mesh, center);
        assert!(winding.abs() > 0.5, "{name}: ball {i} stands outside, winding number {winding}");
        if overlaps {
            // Sheets inside do not count: all points just under the ball's surface must be inside.
            for k in 0..60 {
                let (z, turn) = ((2.0 * f64::from(k) + 1.0) / 60.0 - 1.0, f64::from(k) * 0.618_034 * TAU);
                let ring = (1.0 - z * z).sqrt();
                let p = center + DVec3::new(ring * turn.cos(), ring * turn.sin(), z) * (radius - 1e-7 * size);
                let winding = winding_number(mesh, p);
                assert!(winding.abs() > 0.5, "{name}: ball {i} of radius {radius} sticks out at {p}");
            }
        } else {
            let nearest = distance(mesh, center);
            assert!(nearest >= radius - 1e-9 * size, "{name}: ball {i} of {radius} is {nearest} deep");
        }
        for (j, other) in packing.spheres()[..i].iter().enumerate() {
            let gap = center.distance(other.center.as_dvec3()) - radius - f64::from(other.radius);
            assert!(gap >= -1e-9 * size, "{name}: balls {i} and {j} overlap by {}", -gap);
        }
    }
    let sum: f64 = packing.spheres().iter().map(|s| f64::from(s.cell_volume)).sum();
    let volume = solid.properties().volume;
    assert!((sum / volume - 1.0).abs() < 1e-6, "{name}: cells sum to {sum}, not {volume}");
}
