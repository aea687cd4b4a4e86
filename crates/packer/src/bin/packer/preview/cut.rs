//! Where the solid is cut.

use super::scene::Scene;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Directions that are tried besides the axes.
const DIRECTIONS: usize = 96;
/// How much larger the section of an inclined plane must be than that of a plane along two axes: a choice. Meshes are
/// modelled along their axes, and a section along them is easier to read.
const AXIS_PREFERENCE: f32 = 1.5;

/// A plane through the origin; what lies on the side of its normal is taken away.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutPlane {
    pub(super) normal: Vec3,
}

impl CutPlane {
    /// The plane through the centroid that cuts the largest area out of the balls.
    pub(super) fn largest_section(scene: &Scene) -> Self {
        let axes = [Vec3::Z, Vec3::X, Vec3::Y];
        let mut best = (f32::NEG_INFINITY, Vec3::Z);
        let candidates =
            axes.map(|axis| (AXIS_PREFERENCE, axis)).into_iter().chain(hemisphere().map(|axis| (1.0, axis)));
        for (preference, normal) in candidates {
            let area = preference * section(scene, normal);
            if area > best.0 {
                best = (area, normal);
            }
        }
        Self { normal: best.1 }
    }

    /// Height of `p` over the plane, negative in the half that is shown.
    pub(super) fn height(&self, p: Vec3) -> f32 {
        self.normal.dot(p)
    }
}

/// Area of the discs that a plane through the origin cuts out of the balls.
fn section(scene: &Scene, normal: Vec3) -> f32 {
    let disc = |center: Vec3, radius: f32| PI * (radius * radius - normal.dot(center).powi(2)).max(0.0);
    scene.balls.iter().map(|ball| disc(ball.center, ball.radius)).sum()
}

/// Directions spread evenly over half a sphere, by the golden angle.
fn hemisphere() -> impl Iterator<Item = Vec3> {
    let golden = TAU * 0.618_034;
    (0..DIRECTIONS).map(move |index| {
        let z = (index as f32 + 0.5) / DIRECTIONS as f32;
        let (sin, cos) = (golden * index as f32).sin_cos();
        let around = (1.0 - z * z).sqrt();
        Vec3::new(around * cos, around * sin, z)
    })
}
