//! Properties of proximity queries, against [`crate::reference`], closed forms and plain loops.

mod edge_cases;
mod impact;
mod pairs;
mod penetration;
mod single;
mod surface_impact;

use super::*;
use crate::{InnerSphere, InnerSphereTree, SolidProperties, SpherePacking};
use alloc::vec::Vec;
use glam::{DVec3, Quat, Vec3};
use glamx::Pose3;
use proptest::prelude::*;

/// Smallest radius of random spheres.
const SMALLEST: f32 = 1.0 / 1024.0;

const KINDS: [BallKind; 2] = [BallKind::Inner, BallKind::Volume];

/// A tree of up to `max` spheres in a cube of edge 2, with cells off centre, at a random scale and under a skin.
fn random_tree(max: usize) -> impl Strategy<Value = InnerSphereTree> {
    let vector = || prop::array::uniform3(-1.0_f32..1.0).prop_map(Vec3::from_array);
    let sphere =
        (vector(), vector(), SMALLEST..0.2_f32, 1.0_f32..1.5).prop_map(|(center, shift, radius, grow)| {
            let normal = shift.try_normalize().unwrap_or(Vec3::X);
            let mut sphere = InnerSphere::solid_ball(center, radius, normal);
            sphere.cell_volume *= grow;
            sphere.cell_centroid += 0.3 * radius * shift;
            sphere
        });
    let tree = prop::collection::vec(sphere, 1..max).prop_map(|spheres| tree_of(&spheres));
    (tree, 0.25_f32..5.0, prop_oneof![Just(0.0_f32), 0.0_f32..0.1])
        .prop_map(|(tree, scale, skin)| tree.scaled(scale).unwrap().with_skin(skin).unwrap())
}

fn random_pose(reach: f32) -> impl Strategy<Value = Pose3> {
    (prop::array::uniform3(-reach..reach), prop::array::uniform3(-3.0_f32..3.0))
        .prop_map(|(t, r)| Pose3::from_parts(t.into(), Quat::from_scaled_axis(r.into())))
}

fn random_kind() -> impl Strategy<Value = BallKind> {
    prop_oneof![Just(BallKind::Inner), Just(BallKind::Volume)]
}

fn tree_of(spheres: &[InnerSphere]) -> InnerSphereTree {
    InnerSphereTree::new(&SpherePacking::new(spheres.to_vec(), SolidProperties::ball(1.0)).unwrap())
}

/// One ball about the origin.
fn ball(radius: f32) -> InnerSphereTree {
    balls(&[(Vec3::ZERO, radius)])
}

fn balls(list: &[(Vec3, f32)]) -> InnerSphereTree {
    let spheres: Vec<_> =
        list.iter().map(|&(center, radius)| InnerSphere::solid_ball(center, radius, Vec3::Y)).collect();
    tree_of(&spheres)
}

/// Largest coordinate of the balls of two trees (m): what rounding is relative to.
fn extent(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> f32 {
    let reach = |tree: &InnerSphereTree| {
        let (center, radius) = tree.bounding_ball();
        center.abs().max_element() + radius
    };
    reach(a) + reach(b) + pose.translation.abs().max_element()
}
