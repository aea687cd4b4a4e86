//! A hexagonal nut.

use super::grid::closed_grid;
use glam::DVec3;
use packer::TriangleMesh;
use std::f64::consts::{FRAC_PI_3, FRAC_PI_6, TAU};

/// A hexagonal prism with a round through-hole along y, centred at the origin.
///
/// - `across_flats`: distance between opposite side faces (m).
/// - `hole_radius`: radius of the hole (m), less than half of `across_flats`.
/// - `height`: height along y (m).
/// - `chamfer`: width of the 45° cuts on all four rims (m), 0 for sharp rims; less than half the height and half
///   the wall.
/// - `segments`: facets of the hole, rounded up to a multiple of six (≥ 6).
#[must_use]
pub fn hexagonal_nut(
    across_flats: f64,
    hole_radius: f64,
    height: f64,
    chamfer: f64,
    segments: u32,
) -> TriangleMesh {
    let segments = segments.clamp(6, 1 << 20).next_multiple_of(6);
    let section = section(height / 2.0, chamfer.max(0.0));
    closed_grid(segments, section.len() as u32, |i, j| {
        let corner = &section[j as usize];
        let angle = TAU * f64::from(i) / f64::from(segments);
        let radius = match corner.side {
            Side::Hole => hole_radius + corner.inset,
            Side::Flats => hexagon_radius(across_flats / 2.0 - corner.inset, angle),
        };
        let (sin, cos) = libm::sincos(angle);
        DVec3::new(radius * cos, corner.y, -radius * sin)
    })
}

/// Corner of the wall's cross-section.
struct Corner {
    side: Side,
    /// How far it is drawn back into the wall (m).
    inset: f64,
    y: f64,
}

#[derive(Clone, Copy)]
enum Side {
    Hole,
    Flats,
}

/// The wall's cross-section, counter-clockwise with the hole on the left.
fn section(top: f64, chamfer: f64) -> Vec<Corner> {
    let corner = |side, inset, y| Corner { side, inset, y };
    if chamfer == 0.0 {
        let corners = [(Side::Hole, -top), (Side::Flats, -top), (Side::Flats, top), (Side::Hole, top)];
        return corners.map(|(side, y)| corner(side, 0.0, y)).into();
    }
    let edge = top - chamfer;
    vec![
        corner(Side::Hole, chamfer, -top),
        corner(Side::Flats, chamfer, -top),
        corner(Side::Flats, 0.0, -edge),
        corner(Side::Flats, 0.0, edge),
        corner(Side::Flats, chamfer, top),
        corner(Side::Hole, chamfer, top),
        corner(Side::Hole, 0.0, edge),
        corner(Side::Hole, 0.0, -edge),
    ]
}

/// Distance from the centre to the outline of a hexagon with a corner at angle 0.
pub(super) fn hexagon_radius(apothem: f64, angle: f64) -> f64 {
    apothem / libm::cos(angle.rem_euclid(FRAC_PI_3) - FRAC_PI_6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::check::{Expected, assert_solid};

    const SEGMENTS: u32 = 48;

    /// Area of the hexagon of apothem `a`, and of the polygon that stands for the hole of radius `r`.
    fn areas(a: f64, r: f64) -> (f64, f64) {
        let n = f64::from(SEGMENTS);
        (2.0 * 3.0_f64.sqrt() * a * a, n / 2.0 * (TAU / n).sin() * r * r)
    }

    #[test]
    fn a_sharp_nut_has_its_prism_volume() {
        let (hexagon, hole) = areas(0.5, 0.3);
        let expected = Expected { volume: 0.4 * (hexagon - hole), tolerance: 1e-12, euler: 0 };
        assert_solid(&hexagonal_nut(1.0, 0.3, 0.4, 0.0, SEGMENTS), &expected);
    }

    #[test]
    fn a_chamfered_nut_has_its_frustum_volume() {
        let (hexagon, hole) = areas(0.5, 0.3);
        let (small_hexagon, wide_hole) = areas(0.45, 0.35);
        let frustum = |a: f64, b: f64| 0.05 / 3.0 * (a + b + (a * b).sqrt());
        let middle = 0.3 * (hexagon - hole);
        let rims = 2.0 * (frustum(hexagon, small_hexagon) - frustum(hole, wide_hole));
        let expected = Expected { volume: middle + rims, tolerance: 1e-12, euler: 0 };
        assert_solid(&hexagonal_nut(1.0, 0.3, 0.4, 0.05, SEGMENTS), &expected);
    }

    #[test]
    fn any_segment_count_hits_the_corners() {
        let mesh = hexagonal_nut(1.0, 0.2, 0.3, 0.0, 7);
        let reach = mesh.vertices.iter().map(|v| v.x.hypot(v.z)).fold(0.0, f64::max);
        assert!((reach - 0.5 / FRAC_PI_6.cos()).abs() < 1e-12);
    }
}
