//! Forces and torques: equal and opposite, about any point, at any scale.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use glam::{Quat, Vec3};
use glamx::Pose3;
use ist::{
    ForceLaw, InnerSphere, InnerSphereTree, Overlap, OverlapQuery, OverlapWorkspace, SolidProperties,
    SpherePacking,
};
use proptest::prelude::*;

const LAWS: [ForceLaw; 3] = [ForceLaw::VolumeGradient, ForceLaw::OutwardNormals, ForceLaw::Blended];

fn random_tree() -> impl Strategy<Value = InnerSphereTree> {
    let sphere =
        (prop::array::uniform3(-1.0_f32..1.0), 0.01_f32..0.3, 1.0_f32..1.3).prop_map(|(c, r, grow)| {
            let center = Vec3::from(c);
            let ball = InnerSphere::solid_ball(center, r, center.try_normalize().unwrap_or(Vec3::X));
            InnerSphere { cell_volume: ball.cell_volume * grow, ..ball }
        });
    prop::collection::vec(sphere, 1..100).prop_map(|spheres| {
        InnerSphereTree::new(&SpherePacking::new(spheres, SolidProperties::ball(1.0)).unwrap())
    })
}

fn random_pose() -> impl Strategy<Value = Pose3> {
    (prop::array::uniform3(-0.8_f32..0.8), prop::array::uniform3(-3.0_f32..3.0))
        .prop_map(|(t, r)| Pose3::from_parts(t.into(), Quat::from_scaled_axis(r.into())))
}

fn overlap(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3, law: ForceLaw) -> Overlap {
    let query = OverlapQuery { law, ..OverlapQuery::default() };
    a.overlap_with(b, pose, query, &mut OverlapWorkspace::default())
}

/// Contact area: the sum of the lengths whose vector sum is the gradient.
fn area(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> f32 {
    let mut samples = Vec::new();
    a.contact_samples(b, pose, &mut OverlapWorkspace::default(), &mut samples);
    samples.iter().map(|sample| sample.vector_area.length()).sum()
}

/// What B feels when it is A, and A is B: the opposite, in the other frame. Torques are about the same centroid.
fn opposite(overlap: &Overlap, pose: &Pose3) -> (Vec3, Vec3) {
    (-(pose.rotation * overlap.force), -(pose.rotation * overlap.torque))
}

/// How much force and torque of the blended law change where B is moved by 1e-6 along the axes; coordinates are below 3, and
/// are rounded to 1e-7 of that a few times.
fn within_rounding([a, b]: [&InnerSphereTree; 2], pose: &Pose3, at: &Overlap) -> (f32, f32) {
    let mut change = (0.0, 0.0);
    for axis in Vec3::AXES {
        for step in [1e-6, -1e-6] {
            let moved = Pose3::from_parts(pose.translation + step * axis, pose.rotation);
            let near = overlap(a, b, &moved, ForceLaw::Blended);
            change.0 += (near.force - at.force).length();
            change.1 += (near.torque - at.torque).length();
        }
    }
    change
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn both_solids_feel_the_opposite(a in random_tree(), b in random_tree(), pose in random_pose()) {
        let area = area(&a, &b, &pose);
        let back = pose.inverse();
        for law in LAWS {
            let (ab, ba) = (overlap(&a, &b, &pose, law), overlap(&b, &a, &back, law));
            // Rounding of the distances moves areas by a share of the radii: 1e-5 of what is summed, and of the pairs.
            let size = match law {
                ForceLaw::VolumeGradient => area + ab.pairs as f32 * 0.1,
                _ => ab.volume + area,
            };
            // Where one ball nearly contains the other, or normals nearly cancel, the blend changes within the rounding of the
            // centres: what moving B by about that much does to it is allowed for.
            let (force_slack, torque_slack) = match law {
                ForceLaw::Blended => within_rounding([&a, &b], &pose, &ab),
                _ => (0.0, 0.0),
            };
            let (force, torque) = opposite(&ba, &pose);
            let (off, turned) = ((ab.force - force).length(), (ab.torque - torque).length());
            prop_assert!(off <= 1e-5 * size + force_slack, "{law:?}: {} {force}", ab.force);
            prop_assert!(turned <= 2e-5 * size + torque_slack, "{law:?}: {} {torque}", ab.torque);
            let shift = ab.centroid - pose.transform_point(ba.centroid);
            prop_assert!(ab.volume <= 1e-4 || shift.length() < 1e-4, "{shift}");
        }
    }

    /// The wrench of the gradient is the sum of the samples' forces: about the centroid, and about any other point, to which
    /// torques shift by r × f.
    #[test]
    fn torques_are_those_of_the_samples(
        a in random_tree(), b in random_tree(), pose in random_pose(), point in prop::array::uniform3(-3.0_f32..3.0),
        scale in 0.1_f32..10.0,
    ) {
        let (a, b) = (a.scaled(scale).unwrap(), b.scaled(scale).unwrap());
        let pose = Pose3::from_parts(pose.translation * scale, pose.rotation);
        let point = Vec3::from(point) * scale;
        let result = overlap(&a, &b, &pose, ForceLaw::VolumeGradient);
        let mut samples = Vec::new();
        a.contact_samples(&b, &pose, &mut OverlapWorkspace::default(), &mut samples);
        let about = |pivot: Vec3| -> Vec3 {
            samples.iter().map(|s| (s.point - pivot).cross(s.vector_area)).sum()
        };
        let arms: f32 = samples.iter().map(|s| (s.point - point).length() * s.vector_area.length()).sum();
        let slack = 3e-5 * (arms + (result.centroid - point).length() * area(&a, &b, &pose));
        prop_assert!((about(result.centroid) - result.torque).length() <= slack);
        let shifted = result.torque + (result.centroid - point).cross(result.force);
        prop_assert!((about(point) - shifted).length() <= slack);
    }

    /// Forces along the gradient grow as areas, others as volumes.
    #[test]
    fn forces_grow_with_the_bodies(
        a in random_tree(), b in random_tree(), pose in random_pose(), scale in prop::sample::select(vec![1e-4_f32, 0.3, 7.0, 1e4]),
    ) {
        let pose_scaled = Pose3::from_parts(pose.translation * scale, pose.rotation);
        let [large_a, large_b] = [&a, &b].map(|tree| tree.scaled(scale).unwrap());
        let area = area(&a, &b, &pose);
        for law in LAWS {
            let (one, many) = (overlap(&a, &b, &pose, law), overlap(&large_a, &large_b, &pose_scaled, law));
            let growth = scale.powi(if law == ForceLaw::VolumeGradient { 2 } else { 3 });
            let size = one.force.length() + 1e-2 * (one.volume + area);
            prop_assert!((many.force / growth - one.force).length() <= 1e-3 * size, "{law:?}");
            prop_assert!((many.torque / (growth * scale) - one.torque).length() <= 2e-3 * size, "{law:?}");
        }
    }
}

/// The force along the gradient grew with the third power of a tree's scale, as forces of the other laws do, where an area grows
/// with the second.
#[test]
fn issue_gradient_force_of_scaled_trees() {
    let ball = InnerSphere::solid_ball(Vec3::ZERO, 1.0, Vec3::X);
    let tree = InnerSphereTree::new(&SpherePacking::new(vec![ball], SolidProperties::ball(1.0)).unwrap());
    for scale in [0.01, 0.5, 2.0, 100.0] {
        let tree = tree.scaled(scale).unwrap();
        let pose = Pose3::translation(1.5 * scale, 0.0, 0.0);
        let result = overlap(&tree, &tree, &pose, ForceLaw::VolumeGradient);
        assert_eq!(result.force, -result.gradient, "{scale}");
        assert_eq!(result.torque, -result.rotation_gradient, "{scale}");
    }
}
