//! A thick-walled bowl with a round rim.

use super::revolution::revolve;
use glam::DVec2;
use packer::TriangleMesh;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A spherical bowl open towards +y, centred on the sphere's centre.
///
/// - `inner_radius`: radius of the hollow (m).
/// - `wall`: wall thickness (m); the rim is a half-round of that width.
/// - `height`: height of the rim's centre above the deepest point of the hollow (m), between 0 and
///   `2 inner_radius`; `inner_radius` gives a hemisphere, more closes the bowl in above its equator.
/// - `segments`: facets around the axis (≥ 3); the other directions get facets of about the same size.
///
/// The outer bottom lies at y = −(`inner_radius` + `wall`).
#[must_use]
pub fn bowl(inner_radius: f64, wall: f64, height: f64, segments: u32) -> TriangleMesh {
    let segments = segments.max(3);
    let outer_radius = inner_radius + wall;
    let opening = rim_angle(inner_radius, height);
    let arc = |angle: f64, radius: f64| {
        let (sin, cos) = libm::sincos(angle);
        DVec2::new(sin, -cos) * radius
    };
    let facet = TAU / f64::from(segments);
    let steps = ((opening / facet).ceil() as u32).max(2);
    let rim_steps = ((PI * wall / 2.0 / (facet * outer_radius)).ceil() as u32).max(6);

    let mut profile = Vec::new();
    profile.extend((0..steps).map(|i| arc(opening * f64::from(i) / f64::from(steps), outer_radius)));
    // The half-round leads from the outer to the inner sphere, by way of the direction of growing angle.
    let rim_center = arc(opening, inner_radius + wall / 2.0);
    let (outwards, along) = (arc(opening, 1.0), arc(opening + FRAC_PI_2, 1.0));
    profile.extend((0..=rim_steps).map(|i| {
        let (sin, cos) = libm::sincos(PI * f64::from(i) / f64::from(rim_steps));
        rim_center + (outwards * cos + along * sin) * (wall / 2.0)
    }));
    profile.extend((0..steps).rev().map(|i| arc(opening * f64::from(i) / f64::from(steps), inner_radius)));
    revolve(&profile, segments)
}

/// Polar angle of the rim from the downward axis (rad), kept clear of both poles.
fn rim_angle(inner_radius: f64, height: f64) -> f64 {
    libm::acos((1.0 - height / inner_radius).clamp(-0.999, 0.999))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::check::{Expected, assert_solid};

    /// Shell sector and, after Pappus, the half-disc of the rim on the path of its centroid.
    fn closed_form(inner_radius: f64, wall: f64, height: f64) -> f64 {
        let angle = rim_angle(inner_radius, height);
        let outer_radius = inner_radius + wall;
        let shell = TAU / 3.0 * (outer_radius.powi(3) - inner_radius.powi(3)) * (1.0 - angle.cos());
        let centroid = (inner_radius + wall / 2.0) * angle.sin() + 2.0 * wall / (3.0 * PI) * angle.cos();
        shell + PI * wall * wall / 8.0 * TAU * centroid
    }

    #[test]
    fn is_a_closed_shell_at_every_height() {
        for height in [0.4, 1.0, 1.4] {
            let mesh = bowl(1.0, 0.1, height, 128);
            let volume = closed_form(1.0, 0.1, height);
            assert_solid(&mesh, &Expected { volume, tolerance: 5e-3, euler: 2 });
        }
    }

    #[test]
    fn is_open_upwards() {
        let mesh = bowl(1.0, 0.1, 1.0, 64);
        let (low, high) =
            mesh.vertices.iter().fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v.y), high.max(v.y)));
        assert!((low + 1.1).abs() < 1e-12 && (high - 0.05).abs() < 1e-12, "{low} to {high}");
    }
}
