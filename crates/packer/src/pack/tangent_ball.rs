//! The largest ball in a solid that touches the surface at a given point: a point of the medial axis.
//!
//! The ball shrinks about the point of contact until nothing of the surface is in it (J. Ma, S. W. Bae and S. Choi, *3D
//! medial axis point approximation using nearest neighbors and the normal field*, 2012). Unlike Voronoi vertices it
//! needs no dense samples: in a plate whose samples are farther apart than its walls, those lie anywhere.

use super::samples::Sample;
use crate::Solid;
use glam::DVec3;

/// Three or four rounds are the rule; slivers can take many.
const ROUNDS: usize = 32;
/// A ball that shrinks by less than this share has arrived.
const ARRIVED: f64 = 1e-6;

/// Centre of the largest ball that touches the surface of `solid` at `sample`.
pub(super) fn center(solid: &Solid, sample: &Sample) -> Option<DVec3> {
    let mut radius = solid.size();
    for _ in 0..ROUNDS {
        let center = sample.point - radius * sample.normal;
        let nearest = solid.closest_point_within(center, radius * (1.0 - ARRIVED));
        let Some(nearest) = nearest else { return Some(center) };
        // |q − p + r·n| = r, with q on the surface and p the sample.
        let chord = nearest.point - sample.point;
        let next = chord.length_squared() / (-2.0 * chord.dot(sample.normal));
        // Not so for a sample on a fold, where the surface passes through the sample's ball at any radius.
        if !(next > 0.0 && next < radius) {
            return None;
        }
        radius = next;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TriangleMesh;

    #[test]
    fn the_ball_in_a_plate_touches_both_walls() {
        for thickness in [0.3, 1e-2, 1e-5] {
            let corner =
                |i: usize| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64 * thickness);
            let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            let mesh = TriangleMesh {
                vertices: (0..8).map(corner).collect(),
                triangles: quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect(),
            };
            let solid = Solid::new(&mesh).unwrap();
            let sample = Sample { point: DVec3::new(0.4, 0.6, 0.0), normal: DVec3::NEG_Z };
            let center = center(&solid, &sample).unwrap();
            assert!(center.distance(DVec3::new(0.4, 0.6, 0.5 * thickness)) < 1e-5 * thickness, "{center}");
        }
    }
}
