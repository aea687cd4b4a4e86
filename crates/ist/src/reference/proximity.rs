//! Distance by brute force.

use crate::{BallKind, InnerSphereTree};
use alloc::vec::Vec;
use glam::{DVec3, Vec3};
use glamx::Pose3;

/// Balls of a tree in the order of its packing: centre and radius (m).
#[must_use]
pub fn balls(tree: &InnerSphereTree, kind: BallKind) -> Vec<(Vec3, f32)> {
    let mut balls = alloc::vec![(Vec3::ZERO, 0.0); tree.len()];
    for (i, ball) in tree.volume_balls().enumerate() {
        balls[tree.packing_index(i)] = ball;
    }
    if kind == BallKind::Inner {
        for (i, (center, radius, _)) in tree.inner_balls().enumerate() {
            balls[tree.packing_index(i)] = (center, radius);
        }
    }
    balls
}

/// The nearest pair of balls.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ReferenceDistance {
    /// Distance of the balls (m), negative where they meet.
    pub gap: f64,
    /// Index of A's sphere in its packing.
    pub sphere_a: usize,
    /// Index of B's sphere in its packing.
    pub sphere_b: usize,
}

/// The pair of balls with the smallest gap of `a` and `b`, whose frame stands at `pose` in `a`'s frame: the nearest
/// or, where some meet, the deepest.
#[must_use]
pub fn distance(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3, kind: BallKind) -> ReferenceDistance {
    let (rotation, translation) = (pose.rotation.as_dquat().normalize(), pose.translation.as_dvec3());
    let mut nearest = ReferenceDistance { gap: f64::INFINITY, sphere_a: 0, sphere_b: 0 };
    for j in 0..b.len() {
        let (center_b, radius_b) = ball(b, kind, j);
        let center_b = rotation * center_b + translation;
        for i in 0..a.len() {
            let (center_a, radius_a) = ball(a, kind, i);
            let gap = center_a.distance(center_b) - radius_a - radius_b;
            if gap < nearest.gap {
                nearest =
                    ReferenceDistance { gap, sphere_a: a.packing_index(i), sphere_b: b.packing_index(j) };
            }
        }
    }
    nearest
}

fn ball(tree: &InnerSphereTree, kind: BallKind, i: usize) -> (DVec3, f64) {
    let (data, scale) = (tree.data(), f64::from(tree.unit()));
    let ((center, radius), skin) = match kind {
        BallKind::Inner => ((data.inner_center[i], data.inner_radius[i]), 0.0),
        BallKind::Volume => (data.levels[0].get(i), f64::from(tree.skin())),
    };
    (center.as_dvec3() * scale, f64::from(radius) * scale + skin)
}
