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
