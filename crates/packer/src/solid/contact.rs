//! How two triangles meet.
//!
//! T. Möller, *A fast triangle-triangle intersection test* (1997): each triangle meets the plane of the other in
//! a segment of the planes' common line. On which side a corner lies is decided by an exact predicate (J. R.
//! Shewchuk, *Adaptive precision floating-point arithmetic and fast robust geometric predicates*, 1997), so that
//! the corners that neighbours share lie on each other's plane and not beside it.

use super::plane::{TrianglePlane, clip, is_within, runs_along};
use glam::{DVec2, DVec3};
use robust::{Coord3D, orient3d};

/// Segments in the coordinates of one triangle's plane.
pub(super) type Cuts = Vec<[DVec2; 2]>;

/// How two triangles meet.
#[derive(Clone, Debug, Default)]
pub(super) struct Contact {
    /// Where the second one runs through the inside of the first, in the first one's coordinates; and the reverse.
    pub(super) cuts: [Cuts; 2],
    pub(super) kind: Kind,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    /// They have no more than parts of their borders in common, or one ends at the other.
    #[default]
    Touch,
    /// They pass through each other; here is a point of both.
    Cross,
    /// They lie in one plane and cover each other, in part or wholly.
    Cover,
}

/// How triangles `a` and `b` meet, if they have a line or more in common: without cuts where that is a part of both borders. A corner that is nearer to a plane than `on_plane` (m)
/// lies on it.
pub(super) fn contact(a: &[DVec3; 3], b: &[DVec3; 3], on_plane: f64) -> Option<Contact> {
    let sides_of_b = sides(b, a, on_plane);
    if sides_of_b.iter().all(|side| *side > 0.0) || sides_of_b.iter().all(|side| *side < 0.0) {
        return None;
    }
    let sides_of_a = sides(a, b, on_plane);
    if sides_of_a.iter().all(|side| *side > 0.0) || sides_of_a.iter().all(|side| *side < 0.0) {
        return None;
    }
    let (plane_a, plane_b) = (TrianglePlane::new(a)?, TrianglePlane::new(b)?);
    let is_flush = |sides: &[f64; 3]| sides.iter().all(|side| *side == 0.0);
    if is_flush(&sides_of_a) || is_flush(&sides_of_b) {
        let cuts = [borders(b, &plane_a), borders(a, &plane_b)];
        let some_border_is_inside = !cuts[0].is_empty() || !cuts[1].is_empty();
        // Two that are the same but for rounding have all borders in common.
        let covers = some_border_is_inside || is_within(plane_a.project((b[0] + b[1] + b[2]) / 3.0));
        return covers.then_some(Contact { cuts, kind: Kind::Cover });
    }
    let line = |triangle, sides, plane: &TrianglePlane| {
        section(triangle, sides).map(|ends| ends.map(|end| plane.project(end)))
    };
    let lines = [line(b, &sides_of_b, &plane_a), line(a, &sides_of_a, &plane_b)];
    let cuts = lines.map(|line| -> Cuts { line.and_then(clip).into_iter().collect() });
    if cuts[0].is_empty() && cuts[1].is_empty() && !lines.into_iter().flatten().any(runs_along) {
        return None;
    }
    let straddles = |sides: &[f64; 3]| sides.iter().any(|s| *s > 0.0) && sides.iter().any(|s| *s < 0.0);
    let crosses = straddles(&sides_of_a) && straddles(&sides_of_b);
    Some(Contact { cuts, kind: if crosses { Kind::Cross } else { Kind::Touch } })
}

/// Signed distances of the corners of `triangle` from the plane of `of`, all multiplied by the same number; zero
/// for those on it.
fn sides(triangle: &[DVec3; 3], of: &[DVec3; 3], on_plane: f64) -> [f64; 3] {
    let [a, b, c] = of.map(coordinates);
    let doubled_area = (of[1] - of[0]).cross(of[2] - of[0]).length();
    triangle.map(|corner| {
        // Known, but what the predicate takes longest for.
        if of.contains(&corner) {
            return 0.0;
        }
        let side = orient3d(a, b, c, coordinates(corner));
        if side.abs() <= on_plane * doubled_area { 0.0 } else { side }
    })
}

fn coordinates(p: DVec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

/// Where `triangle` meets a plane on whose `sides` its corners lie.
fn section(triangle: &[DVec3; 3], sides: &[f64; 3]) -> Option<[DVec3; 2]> {
    let corners = (0..3).filter(|i| sides[*i] == 0.0).map(|i| triangle[i]);
    let crossed = (0..3).map(|i| (i, (i + 1) % 3)).filter(|(i, j)| sides[*i] * sides[*j] < 0.0);
    let mut points =
        corners.chain(crossed.map(|(i, j)| triangle[i].lerp(triangle[j], sides[i] / (sides[i] - sides[j]))));
    Some([points.next()?, points.next()?])
}

/// Borders of `triangle` where they run through the inside of another one in the same plane.
fn borders(triangle: &[DVec3; 3], plane: &TrianglePlane) -> Cuts {
    let at = triangle.map(|corner| plane.project(corner));
    (0..3).filter_map(|i| clip([at[i], at[(i + 1) % 3]])).collect()
}
