//! Voronoi vertices of points, as circumcentres of their Delaunay tetrahedra.

use super::noise::Noise;
use glam::DVec3;
use simple_delaunay_lib::delaunay_3d::delaunay_struct_3d::DelaunayStructure3D;
use simple_delaunay_lib::delaunay_3d::simplicial_struct_3d::Node;

/// A point that is equally far from four of the given points and no nearer to any other.
#[derive(Clone, Copy, Debug)]
pub(super) struct VoronoiVertex {
    pub(super) position: DVec3,
    /// Indices of the four points.
    pub(super) of: [usize; 4],
}

/// Points are displaced by up to this share of their extent, so that no five lie on a common sphere and no four
/// in a common plane, as they do on modelled parts. Far under the spacing of the points, far above rounding.
const JITTER: f64 = 1e-7;
/// Points of the first batch; each further one doubles their number.
const FIRST_BATCH: usize = 64;
/// Points on a surface have 6 to 8 tetrahedra each; points on two skew lines have a number that grows with the
/// number of points, and are given up.
const MOST_TETRAHEDRA: usize = 40;

/// All Voronoi vertices of `points`, or none if there are fewer than four points or they have far too many
/// tetrahedra.
pub(super) fn vertices(points: &[DVec3]) -> Vec<VoronoiVertex> {
    tetrahedra(points)
        .into_iter()
        .filter_map(|of| {
            let position = circumcentre(of.map(|index| points[index]))?;
            Some(VoronoiVertex { position, of })
        })
        .collect()
}

/// The Delaunay tetrahedra, as indices of points.
///
/// Points go in in random batches that double in size, each along a space-filling curve: the biased randomised
/// insertion order of N. Amenta, S. Choi and G. Rote (2003), which keeps both the number of intermediate
/// tetrahedra and the walks to the next point short. The library's own order does not end where two points
/// differ by rounding only.
fn tetrahedra(points: &[DVec3]) -> Vec<[usize; 4]> {
    let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (lower, upper) = points.iter().fold(empty, |(l, u), p| (l.min(*p), u.max(*p)));
    let extent = (upper - lower).max_element();
    if points.len() < 4 || !(extent > 0.0 && extent.is_finite()) {
        return Vec::new();
    }
    let in_unit_cube = |index: usize| {
        let jitter = 2.0 * Noise::new(index as u64).point() - 1.0;
        (points[index] - lower) / extent + JITTER * jitter
    };
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_cached_key(|index| Noise::new(!(*index as u64)).bits());
    let mut structure = DelaunayStructure3D::new();
    let (mut from, mut to) = (0, FIRST_BATCH.min(points.len()));
    while from < to {
        let batch = &mut order[from..to];
        batch.sort_by_cached_key(|index| morton(in_unit_cube(*index)));
        let coordinates = batch.iter().map(|index| in_unit_cube(*index).to_array()).collect();
        let inserted = structure.insert_vertices(&coordinates, false).is_ok();
        if !inserted || structure.get_simplicial().get_nb_tetrahedra() > MOST_TETRAHEDRA * (to + FIRST_BATCH)
        {
            return Vec::new();
        }
        (from, to) = (to, (2 * to).min(points.len()));
    }
    let simplices = structure.get_simplicial();
    (0..simplices.get_nb_tetrahedra())
        .filter_map(|index| {
            let mut corners = [0; 4];
            for (corner, node) in corners.iter_mut().zip(simplices.get_tetrahedron(index).ok()?.nodes()) {
                let Node::Value(rank) = node else { return None };
                *corner = order[rank];
            }
            Some(corners)
        })
        .collect()
}

/// Place along the Morton curve of a point of the unit cube, ten bits a coordinate.
fn morton(p: DVec3) -> u32 {
    let spread = |x: f64| {
        // Out of range saturates.
        let mut bits = ((x * 1024.0) as u32).min(1023);
        bits = (bits | bits << 16) & 0x0300_00FF;
        bits = (bits | bits << 8) & 0x0300_F00F;
        bits = (bits | bits << 4) & 0x030C_30C3;
        (bits | bits << 2) & 0x0924_9249
    };
    spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2
}

/// Centre of the sphere through four points: `2·(pᵢ − a)·x = |pᵢ − a|²` solved by Cramer's rule.
fn circumcentre([a, b, c, d]: [DVec3; 4]) -> Option<DVec3> {
    let (b, c, d) = (b - a, c - a, d - a);
    let (bc, cd, db) = (b.cross(c), c.cross(d), d.cross(b));
    let offset =
        (cd * b.length_squared() + db * c.length_squared() + bc * d.length_squared()) / (2.0 * b.dot(cd));
    offset.is_finite().then_some(a + offset)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No point may lie inside the sphere about a vertex, and the four must lie on it.
    fn assert_empty_spheres(points: &[DVec3], size: f64) {
        let vertices = vertices(points);
        assert!(vertices.len() > points.len() / 2, "{} vertices", vertices.len());
        for vertex in vertices {
            let radius = vertex.position.distance(points[vertex.of[0]]);
            // Flat tetrahedra have far centres, which the jitter moves far.
            if radius < 2.0 * size {
                let nearest =
                    points.iter().map(|p| p.distance(vertex.position)).fold(f64::INFINITY, f64::min);
                assert!(nearest > radius - 1e-3 * size, "{nearest} < {radius}");
            }
        }
    }

    fn grid(n: usize) -> impl Iterator<Item = DVec3> {
        (0..n * n * n).map(move |i| DVec3::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64))
    }

    #[test]
    fn spheres_about_voronoi_vertices_are_empty() {
        let random: Vec<DVec3> = (0..500).map(|i| 3.0 * Noise::new(i).point()).collect();
        assert_empty_spheres(&random, 3.0);
    }

    #[test]
    fn gridded_and_cospherical_points_are_no_hindrance() {
        assert_empty_spheres(&grid(7).collect::<Vec<_>>(), 7.0);
        let surface: Vec<DVec3> =
            grid(9).filter(|p| p.min_element() == 0.0 || p.max_element() == 8.0).collect();
        assert_empty_spheres(&surface, 8.0);
        let sphere: Vec<DVec3> = (0..2_000)
            .map(|i| (2.0 * Noise::new(i).point() - 1.0).normalize() * 1e-3 + DVec3::splat(500.0))
            .collect();
        assert!(!vertices(&sphere).is_empty());
    }

    #[test]
    fn degenerate_points_end_in_some_answer() {
        for points in [
            vec![],
            vec![DVec3::ONE; 3],
            vec![DVec3::ONE; 1_000],
            vec![DVec3::NAN; 10],
            (0..1_000).map(|i| DVec3::X * f64::from(i)).collect(),
            grid(30).filter(|p| p.z == 0.0).collect(),
            grid(10).chain(grid(10)).collect(),
            // Two skew lines: every pair of segments makes a tetrahedron.
            (0..2_000)
                .map(|i| if i % 2 == 0 { DVec3::X * f64::from(i) } else { DVec3::new(0., f64::from(i), 9e3) })
                .collect(),
        ] {
            let _ = vertices(&points);
        }
    }

    #[test]
    fn the_circumcentre_is_equally_far_from_all_four() {
        let points = [DVec3::ZERO, DVec3::X, 2.0 * DVec3::Y, 3.0 * DVec3::Z];
        let centre = circumcentre(points).unwrap_or(DVec3::NAN);
        assert!(centre.distance(DVec3::new(0.5, 1.0, 1.5)) < 1e-12);
    }
}
