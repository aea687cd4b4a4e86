//! Solids of revolution about the y axis.

use super::grid::push_quad;
use glam::{DVec2, DVec3};
use packer::TriangleMesh;
use std::f64::consts::TAU;

/// The solid swept by a profile that starts on the axis, ends on the axis and stays off it in between.
///
/// Profile points are (distance from the axis, height). The solid lies to the left of the profile as drawn with
/// the distance to the right and the height upwards.
pub(super) fn revolve(profile: &[DVec2], segments: u32) -> TriangleMesh {
    let [first, between @ .., last] = profile else { return TriangleMesh::default() };
    let segments = segments.max(3);
    sweep([segments, between.len() as u32], [first.y, last.y], |s, row| {
        let (sin, cos) = libm::sincos(TAU * f64::from(s) / f64::from(segments));
        let p = between[row as usize];
        // From x towards −z: the sweep step × the profile step then points to the profile's right, outwards.
        DVec3::new(p.x * cos, p.y, -p.x * sin)
    })
}

/// The closed surface through `point(column, row)`, periodic in the columns, and two points on the axis, at the heights
/// `ends`, before the first row and after the last. Outside is as in [`closed_grid`](super::grid::closed_grid); without rows
/// there is no surface.
pub(super) fn sweep(
    [columns, rows]: [u32; 2],
    ends: [f64; 2],
    mut point: impl FnMut(u32, u32) -> DVec3,
) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    if rows == 0 {
        return mesh;
    }
    for s in 0..columns {
        mesh.vertices.extend((0..rows).map(|row| point(s, row)));
    }
    let (start, end) = (columns * rows, columns * rows + 1);
    mesh.vertices.extend(ends.map(|y| DVec3::Y * y));
    let index = |s: u32, row: u32| (s % columns) * rows + row;
    for s in 0..columns {
        mesh.triangles.push([start, index(s + 1, 0), index(s, 0)]);
        for row in 0..rows - 1 {
            push_quad(
                &mut mesh,
                [index(s, row), index(s + 1, row), index(s + 1, row + 1), index(s, row + 1)],
            );
        }
        mesh.triangles.push([end, index(s, rows - 1), index(s + 1, rows - 1)]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::check::{Expected, assert_solid};

    #[test]
    fn a_square_profile_is_a_prism() {
        let profile = [(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)].map(DVec2::from);
        let hexagon = 1.5 * 3.0_f64.sqrt();
        let expected = Expected { volume: 2.0 * hexagon, tolerance: 1e-12, euler: 2 };
        assert_solid(&revolve(&profile, 6), &expected);
    }

    #[test]
    fn a_profile_without_a_middle_is_nothing() {
        assert!(revolve(&[DVec2::ZERO, DVec2::Y], 8).triangles.is_empty());
        assert!(revolve(&[], 8).triangles.is_empty());
    }
}
