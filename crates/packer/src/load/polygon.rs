//! Faces of more than three corners, as triangles.
//!
//! Convex faces become fans. Others are cut by ears: a corner whose triangle holds no other corner is cut off until
//! three are left (G. H. Meisters, *Polygons have ears*, 1975). Every corner is used, also those on a straight
//! border, as the neighbouring face may have an edge that ends there.

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// Corners above which a face that is not convex becomes a fan all the same: looking for ears takes a time that
/// grows with the square of their number. A choice.
const MOST_CORNERS: usize = 4_096;

/// Adds the triangles of the polygon `corners`, indices of `vertices`, to `triangles`.
pub(super) fn add(triangles: &mut Vec<[u32; 3]>, vertices: &[DVec3], corners: &[u32]) {
    let positions: Option<Vec<DVec3>> = corners.iter().map(|v| vertices.get(*v as usize).copied()).collect();
    match positions {
        // A vertex that does not exist is reported later, with its triangle.
        Some(positions) if corners.len() > 3 && corners.len() <= MOST_CORNERS => {
            triangles.extend(cut(&flatten(&positions)).into_iter().map(|t| t.map(|i| corners[i])));
        }
        _ => add_fan(triangles, corners),
    }
}

/// Adds the polygon `corners` to `triangles` as a fan around its first corner.
pub(super) fn add_fan(triangles: &mut Vec<[u32; 3]>, corners: &[u32]) {
    if let Some((first, rest)) = corners.split_first() {
        triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
    }
}

/// The polygon seen along its main axis, so that it runs counter-clockwise.
fn flatten(positions: &[DVec3]) -> Vec<DVec2> {
    let next = positions.iter().cycle().skip(1);
    // Newell's normal: twice the areas of the projections.
    let normal: DVec3 =
        positions.iter().zip(next).map(|(p, q)| (*p - positions[0]).cross(*q - positions[0])).sum();
    let size = normal.abs();
    let project = |p: &DVec3| match () {
        () if size.z >= size.x.max(size.y) => DVec2::new(p.x * normal.z.signum(), p.y),
        () if size.y >= size.x => DVec2::new(p.z * normal.y.signum(), p.x),
        () => DVec2::new(p.y * normal.x.signum(), p.z),
    };
    positions.iter().map(project).collect()
}

/// Triangles of a polygon that runs counter-clockwise, as indices of its corners.
fn cut(points: &[DVec2]) -> Vec<[usize; 3]> {
    let mut ring: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::with_capacity(points.len());
    let mut at = 0;
    let corner = |ring: &[usize], at: usize| {
        let n = ring.len();
        [ring[(at + n - 1) % n], ring[at % n], ring[(at + 1) % n]]
    };
    if (0..points.len()).all(|at| turn(corner(&ring, at).map(|i| points[i])) > 0.0) {
        return (1..points.len() - 1).map(|i| [0, i, i + 1]).collect();
    }
    while ring.len() > 3 {
        let n = ring.len();
        let is_ear = |candidate: &usize| {
            let ear = corner(&ring, *candidate);
            let triangle = ear.map(|i| points[i]);
            turn(triangle) > 0.0
                && ring.iter().all(|i| triangle.contains(&points[*i]) || !is_in(&triangle, points[*i]))
        };
        // A polygon that crosses itself may have no ear: any corner does then.
        let ear = (at..at + n).map(|i| i % n).find(is_ear).unwrap_or(at % n);
        triangles.push(corner(&ring, ear));
        ring.remove(ear);
        // Going on behind the ear spreads the cuts; a fan of slivers would come of staying.
        at = ear + 1;
    }
    triangles.push([ring[0], ring[1], ring[2]]);
    triangles
}

fn turn([a, b, c]: [DVec2; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: p.x, y: p.y });
    orient2d(a, b, c)
}

/// Whether `p` lies in the triangle or on its border.
fn is_in([a, b, c]: &[DVec2; 3], p: DVec2) -> bool {
    turn([*a, *b, p]) >= 0.0 && turn([*b, *c, p]) >= 0.0 && turn([*c, *a, p]) >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3Swizzles as _;

    fn check(polygon: &[DVec3], area: f64) {
        let corners: Vec<u32> = (0..polygon.len() as u32).collect();
        let mut triangles = Vec::new();
        add(&mut triangles, polygon, &corners);
        assert_eq!(triangles.len(), polygon.len() - 2);
        let normals = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| polygon[i as usize]);
            0.5 * (b - a).cross(c - a)
        });
        let normals: Vec<DVec3> = normals.collect();
        let total: DVec3 = normals.iter().sum();
        // Triangles that face the other way would make the sum of their areas larger than the area of the sum.
        let sum: f64 = normals.iter().map(|n| n.length()).sum();
        assert!((sum - area).abs() < 1e-12 && (total.length() - area).abs() < 1e-12, "{sum} {total}");
        assert!(normals.iter().all(|n| n.length() > 0.0), "a triangle without area");
    }

    #[test]
    fn faces_that_are_not_convex_are_filled_and_not_more() {
        let comb = [
            [0., 0.],
            [5., 0.],
            [5., 3.],
            [4., 3.],
            [4., 1.],
            [3., 1.],
            [3., 3.],
            [2., 3.],
            [2., 1.],
            [1., 1.],
            [1., 3.],
            [0., 3.],
        ];
        let turned = |axis: usize, flip: f64| -> Vec<DVec3> {
            comb.iter()
                .map(|[x, y]| {
                    let mut p = DVec3::new(*x, y * flip, 0.25 * x);
                    p = if axis == 0 {
                        p
                    } else if axis == 1 {
                        p.zxy()
                    } else {
                        p.yzx()
                    };
                    p
                })
                .collect()
        };
        let area = 11.0 * (1.0 + 0.25 * 0.25_f64).sqrt();
        for axis in 0..3 {
            check(&turned(axis, 1.0), area);
            check(&turned(axis, -1.0), area);
        }
        let dart = [[0., 0.], [2., 1.], [0., 2.], [0.5, 1.]].map(|[x, y]| DVec3::new(x, y, 0.0));
        for start in 0..4 {
            let mut dart = dart;
            dart.rotate_left(start);
            check(&dart, 1.5);
        }
    }

    #[test]
    fn corners_on_a_straight_border_are_kept() {
        let square: Vec<DVec3> =
            [[0., 0.], [1., 0.], [2., 0.], [2., 1.], [2., 2.], [1., 2.], [0., 2.], [0., 1.]]
                .map(|[x, y]| DVec3::new(x, y, 1.0))
                .to_vec();
        check(&square, 4.0);
    }

    #[test]
    fn what_is_no_polygon_ends_in_some_triangles() {
        for points in [
            vec![DVec3::ZERO; 5],
            (0..7).map(|i| DVec3::X * f64::from(i)).collect(),
            vec![DVec3::NAN; 6],
            vec![DVec3::ZERO, DVec3::X + DVec3::Y, DVec3::X, DVec3::Y],
        ] {
            let mut triangles = Vec::new();
            let corners: Vec<u32> = (0..points.len() as u32).collect();
            add(&mut triangles, &points, &corners);
            assert_eq!(triangles.len(), points.len() - 2);
        }
    }
}
