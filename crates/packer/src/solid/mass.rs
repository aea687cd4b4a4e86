//! Exact mass properties of the solid that a closed mesh encloses.
//!
//! The divergence theorem turns volume integrals into sums over the signed tetrahedra of each triangle and
//! one common point. For the tetrahedron `0abc` with `d = a·(b×c)`: volume `d/6`, first moment `d/24·s`
//! and second moment `∫xxᵀ = d/120·(ssᵀ + aaᵀ + bbᵀ + ccᵀ)`, where `s = a + b + c`.

use glam::{DMat3, DVec3};
use ist::SolidProperties;

/// Properties of the solid of the triangles `corners`, which must be closed and oriented. `origin` is the
/// common point: the centre of the mesh, so that distant meshes lose no digits to cancellation.
pub(super) fn properties(corners: impl Iterator<Item = [DVec3; 3]>, origin: DVec3) -> SolidProperties {
    let outer = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
    let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
    for [a, b, c] in corners.map(|t| t.map(|p| p - origin)) {
        let d = a.dot(b.cross(c));
        let s = a + b + c;
        volume += d / 6.0;
        first += s * (d / 24.0);
        second += (outer(s) + outer(a) + outer(b) + outer(c)) * (d / 120.0);
    }
    let centroid = first / volume;
    let covariance = second - outer(centroid) * volume;
    let trace = covariance.x_axis.x + covariance.y_axis.y + covariance.z_axis.z;
    let unit_inertia = DMat3::from_diagonal(DVec3::splat(trace)) - covariance;
    SolidProperties { volume, centroid: centroid + origin, unit_inertia }
}

/// How far `triangles` are from a closed surface: 0 for one, up to about 1.
///
/// The area vectors of a closed surface add up to zero, and the fluxes of x, y and z along their axes are its volume each. The second
/// tells of holes that face each other, of which the first knows nothing.
pub(super) fn openness(triangles: &[[DVec3; 3]], origin: DVec3) -> f64 {
    let (mut area, mut sum, mut volumes, mut reach) = (0.0, DVec3::ZERO, DVec3::ZERO, f64::MIN_POSITIVE);
    for [a, b, c] in triangles {
        let normal = 0.5 * (*b - *a).cross(*c - *a);
        let middle = (*a + *b + *c) / 3.0 - origin;
        area += normal.length();
        sum += normal;
        volumes += middle * normal;
        reach = middle.abs().max_element().max(reach);
    }
    let spread = volumes.max_element() - volumes.min_element();
    if area > 0.0 { (sum.length() + spread / reach) / area } else { 0.0 }
}
