//! Mass properties of balls against those of the solid.

use super::Ball;
use crate::Solid;
use glam::{DMat3, DVec3};
use ist::InnerSphere;

/// How far a solid made of balls is off in its mass properties.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde-serialize", derive(serde::Serialize))]
#[non_exhaustive]
pub struct MassError {
    /// Distance between the centres of mass (m).
    pub centroid: f64,
    /// Relative error of the inertia tensor about the centre of mass, in the Frobenius norm.
    pub inertia: f64,
}

/// Errors of `spheres` as uniform balls of the masses and places `body`, for unit density of the solid.
///
/// A ball of mass `m` and radius `a` has `2/5·m·a²` about each axis through its centre, and `m(d²·1 − ddᵀ)` more
/// at `d` from the common centre of mass (the parallel axis theorem).
pub(super) fn error(
    solid: &Solid,
    spheres: &[InnerSphere],
    body: impl Fn(&InnerSphere) -> (f64, Ball),
) -> MassError {
    let exact = solid.properties();
    // Relative to the solid's own centroid, so that distant solids lose no digits.
    let bodies = || {
        spheres.iter().map(|sphere| {
            let (mass, ball) = body(sphere);
            (mass, ball.radius, ball.center - exact.centroid)
        })
    };
    let total: f64 = bodies().map(|(m, ..)| m).sum();
    let centroid = bodies().map(|(m, _, place)| place * m).sum::<DVec3>() / total;
    let inertia = bodies().fold(DMat3::ZERO, |sum, (m, a, place)| {
        let d = place - centroid;
        let isotropic = DMat3::from_diagonal(DVec3::splat(m * (0.4 * a * a + d.length_squared())));
        sum + isotropic - DMat3::from_cols(d * d.x, d * d.y, d * d.z) * m
    });
    let norm = |m: DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
    let inertia = norm(inertia - exact.unit_inertia) / norm(exact.unit_inertia);
    MassError { centroid: centroid.length(), inertia }
}
