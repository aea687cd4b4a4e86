//! Points spread over the surface, an equal share of its area to each.

use super::noise::Noise;
use crate::Solid;
use glam::DVec3;

/// A point of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) point: DVec3,
    /// Unit normal of its triangle, out of the material.
    pub(super) normal: DVec3,
}

/// `count` samples: the area, in the order of the triangles, is cut into equal strata with one sample in each.
pub(super) fn on_surface(solid: &Solid, count: usize) -> Vec<Sample> {
    let triangles = solid.surface().triangles.len();
    let doubled = |triangle: usize| {
        let [a, b, c] = solid.surface().corners(triangle);
        (b - a).cross(c - a)
    };
    let mut area = 0.0;
    // Area up to and with each triangle.
    let sums: Vec<f64> = (0..triangles)
        .map(|triangle| {
            area += doubled(triangle).length();
            area
        })
        .collect();
    (0..count)
        .map(|stratum| {
            let mut noise = Noise::new(stratum as u64);
            let at = (stratum as f64 + noise.uniform()) / count as f64 * area;
            let triangle = sums.partition_point(|sum| *sum <= at).min(triangles - 1);
            let [a, b, c] = solid.surface().corners(triangle);
            // Uniform in a triangle (R. Osada et al., Shape distributions, 2002).
            let (u, v) = (noise.uniform().sqrt(), noise.uniform());
            let point = a * (1.0 - u) + b * (u * (1.0 - v)) + c * (u * v);
            Sample { point, normal: doubled(triangle).normalize_or_zero() }
        })
        .collect()
}
