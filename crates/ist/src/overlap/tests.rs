//! Properties of overlap queries, against [`crate::reference`].

use super::force_law::gradient_weight;
use super::*;
use crate::reference;
use crate::tree::tests::random_packing;
use crate::{InnerSphere, ProximityWorkspace, SolidProperties, SpherePacking};
use alloc::vec::Vec;
use glam::{DQuat, DVec3, Quat};
use proptest::prelude::*;

pub(crate) fn random_pose(reach: f32) -> impl Strategy<Value = Pose3> {
    (prop::array::uniform3(-reach..reach), prop::array::uniform3(-3.0_f32..3.0))
        .prop_map(|(t, r)| Pose3::from_parts(t.into(), Quat::from_scaled_axis(r.into())))
}

pub(super) fn tree(packing: &SpherePacking) -> InnerSphereTree {
    InnerSphereTree::new(packing)
}

fn with_law(law: ForceLaw) -> OverlapQuery {
    OverlapQuery { law, ..OverlapQuery::default() }
}

fn ball(radius: f32) -> InnerSphereTree {
    let sphere = InnerSphere::solid_ball(Vec3::ZERO, radius, Vec3::X);
    tree(&SpherePacking::new(alloc::vec![sphere], SolidProperties::ball(f64::from(radius))).unwrap())
}

/// By how much two queries of the same overlap may differ.
struct Rounding {
    exact: reference::ReferenceOverlap,
    /// m³
    volume: f64,
    /// m²
    gradient: f64,
    outward_force: f64,
}

impl Rounding {
    /// Of two [`random_packing`]s, whose radii are at most 0.33.
    fn of_unit_solids(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> Self {
        let exact = reference::overlap(a, b, pose);
        // 1e-5 of the result, and what rounding the centres to f32 moves, in both queries. Moving a pair changes its
        // volume by its area, and its area by at most 2π times the smaller radius.
        let shift = 2.0 * 3e-7 * 2.0;
        let pairs = f64::from(exact.pairs.max(1));
        let area = shift * pairs * 2.1;
        let volume = 1e-5 * exact.volume + shift * (exact.area + area);
        let query = OverlapQuery { law: ForceLaw::OutwardNormals, ..OverlapQuery::default() };
        let outward_force = a.overlap_with(b, pose, query, &mut OverlapWorkspace::default()).force.length();
        Self { volume, gradient: 1e-5 * exact.area + area, outward_force: f64::from(outward_force), exact }
    }

    fn volume_share(&self) -> f64 {
        (self.volume / self.exact.volume).min(2.0)
    }

    fn force(&self, law: ForceLaw) -> f64 {
        let turn = |error: f64, length: f64| (2.0 * error / length).min(2.0);
        let length = self.exact.gradient.length();
        let weight = |gradient: f64| gradient_weight(gradient.max(0.0), self.exact.volume);
        let (least, most) = (weight(length - self.gradient), weight(length + self.gradient));
        match law {
            ForceLaw::VolumeGradient => self.gradient,
            ForceLaw::OutwardNormals => 2.0 * self.volume,
            ForceLaw::Blended => {
                let along_gradient = most * turn(self.gradient, length);
                let along_normals = (1.0 - least) * turn(2.0 * self.volume, self.outward_force);
                self.volume + self.exact.volume * (2.0 * (most - least) + along_gradient + along_normals)
            }
        }
    }
}

proptest! {
    #[test]
    fn equals_brute_force(
        a in random_packing(300), b in random_packing(300), pose in random_pose(1.5),
        scale in prop::array::uniform2(0.2_f32..5.0), skin in prop::array::uniform2(0.0_f32..0.1),
    ) {
        let solid = |packing, i: usize| tree(packing).scaled(scale[i]).unwrap().with_skin(skin[i]).unwrap();
        let (a, b) = (solid(&a, 0), solid(&b, 1));
        let overlap = a.overlap(&b, &pose, &mut OverlapWorkspace::default());
        let exact = reference::overlap(&a, &b, &pose);
        // Grazing pairs, thinner than the rounding of their centres, may be found by one side only.
        prop_assert!(overlap.pairs.abs_diff(exact.pairs) <= 1 + exact.pairs / 1000);
        let reach = f64::from(scale[0] + scale[1] + skin[0] + skin[1]) * 2.0;
        // 1e-5 of the result, and what rounding the centres to f32 moves.
        let shift = 3e-7 * reach;
        let volume = 1e-5 * exact.volume + shift * exact.area;
        prop_assert!((f64::from(overlap.volume) - exact.volume).abs() <= volume);
        let moments = f64::from(overlap.volume) * overlap.centroid.as_dvec3() - exact.volume * exact.centroid;
        prop_assert!(moments.length() <= volume * reach);
        // The area of a disc changes with the distance by at most 2π times the smaller radius.
        let area = 1e-5 * exact.area + shift * f64::from(exact.pairs) * 4.0 * f64::from((scale[0] + skin[0]).min(scale[1] + skin[1]));
        prop_assert!((overlap.gradient.as_dvec3() - exact.gradient).length() <= area);
        let turned = overlap.rotation_gradient.as_dvec3() - exact.rotation_gradient;
        prop_assert!(turned.length() <= (area + shift / reach * exact.area) * reach);
    }

    #[test]
    fn is_symmetric_in_the_two_solids(a in random_packing(100), b in random_packing(100), pose in random_pose(1.0)) {
        let (a, b) = (tree(&a), tree(&b));
        let mut workspace = OverlapWorkspace::default();
        let rounding = Rounding::of_unit_solids(&a, &b, &pose);
        for law in [ForceLaw::VolumeGradient, ForceLaw::OutwardNormals, ForceLaw::Blended] {
            let ab = a.overlap_with(&b, &pose, with_law(law), &mut workspace);
            let ba = b.overlap_with(&a, &pose.inverse(), with_law(law), &mut workspace);
            prop_assert!(f64::from((ab.volume - ba.volume).abs()) <= rounding.volume);
            let force = rounding.force(law);
            prop_assert!(f64::from((ab.force + pose.rotation * ba.force).length()) <= force);
            // Torques are about the centroid, which moves too.
            let torque = 2.0 * force + 2.0 * rounding.volume_share() * f64::from(ab.force.length());
            prop_assert!(f64::from((ab.torque + pose.rotation * ba.torque).length()) <= torque);
            prop_assert!(ab.intersects == ba.intersects || f64::from(ab.volume.max(ba.volume)) <= rounding.volume);
        }
    }

    #[test]
    fn blended_force_is_as_large_as_the_volume_or_smaller(
        a in random_packing(100), b in random_packing(100), pose in random_pose(1.0),
    ) {
        let overlap = tree(&a).overlap(&tree(&b), &pose, &mut OverlapWorkspace::default());
        prop_assert!(overlap.force.length() <= overlap.volume * 1.001);
    }

    /// Bit for bit, also where one solid is inside the other and its force comes from outward normals.
    #[test]
    fn what_a_workspace_remembers_does_not_matter(
        a in random_packing(200), b in random_packing(100), pose in random_pose(0.7), scale in 0.1_f32..1.0,
        law in prop::sample::select(alloc::vec![ForceLaw::VolumeGradient, ForceLaw::OutwardNormals, ForceLaw::Blended]),
        stiffness in prop::bool::ANY,
    ) {
        let (a, b) = (tree(&a).with_grid(), tree(&b).scaled(scale).unwrap().with_grid());
        let results = [false, true].map(|outward| {
            [Engine::Tree, Engine::Grid].map(|engine| {
                let mut workspace = OverlapWorkspace { outward, ..OverlapWorkspace::default() };
                let query = OverlapQuery { law, stiffness, engine };
                // As text, which tells any two numbers apart.
                alloc::format!("{:?}", a.overlap_with(&b, &pose, query, &mut workspace))
            })
        });
        prop_assert_eq!(&results[0], &results[1]);
    }

    /// Bit for bit, whatever pairs its lenses and patches were of.
    #[test]
    fn samples_do_not_depend_on_what_a_workspace_did_before(
        packings in prop::collection::vec(random_packing(150), 2..4), pose in random_pose(0.7),
        before in prop::collection::vec((0..4_usize, 0..4_usize, prop::bool::ANY), 0..6),
    ) {
        let trees: Vec<_> = packings.iter().map(tree).collect();
        let samples = |workspace: &mut OverlapWorkspace, [a, b]: [usize; 2]| {
            let mut samples = Vec::new();
            trees[a % trees.len()].contact_samples(&trees[b % trees.len()], &pose, workspace, &mut samples);
            samples
        };
        let mut used = OverlapWorkspace::default();
        for (a, b, patches) in before {
            if patches {
                let (a, b) = (&trees[a % trees.len()], &trees[b % trees.len()]);
                a.contact_patches(b, &pose, &mut used, &mut Vec::new());
            } else {
                samples(&mut used, [a, b]);
            }
        }
        prop_assert_eq!(samples(&mut used, [0, 1]), samples(&mut OverlapWorkspace::default(), [0, 1]));
    }

    #[test]
    fn samples_add_up_to_the_overlap(a in random_packing(100), b in random_packing(100), pose in random_pose(1.0)) {
        let (a, b) = (tree(&a).scaled(0.5).unwrap(), tree(&b));
        let mut samples = Vec::new();
        let mut workspace = OverlapWorkspace::default();
        a.contact_samples(&b, &pose, &mut workspace, &mut samples);
        let overlap = a.overlap(&b, &pose, &mut workspace);
        let volume: f32 = samples.iter().map(|s| s.volume).sum();
        prop_assert!((volume - overlap.volume).abs() <= 1e-4 * overlap.volume);
        prop_assert!(samples.iter().all(|s| (s.normal.length() - 1.0).abs() < 1e-5));
        let area: Vec3 = samples.iter().map(|s| s.vector_area).sum();
        let total: f32 = samples.iter().map(|s| s.vector_area.length()).sum();
        prop_assert!((area + overlap.gradient).length() <= 1e-4 * total);
        let moment: Vec3 = samples.iter().map(|s| s.volume * s.point).sum();
        prop_assert!((moment - overlap.volume * overlap.centroid).length() <= 1e-4 * overlap.volume);
    }

    /// Of no more volume than all of them, and none where inner balls are apart by more than the offsets.
    #[test]
    fn flush_samples_are_some_of_all(a in random_packing(100), b in random_packing(100), pose in random_pose(1.0)) {
        let (a, b) = (tree(&a).scaled(0.5).unwrap(), tree(&b));
        let mut workspace = OverlapWorkspace::default();
        let (mut all, mut flush) = (Vec::new(), Vec::new());
        a.contact_samples(&b, &pose, &mut workspace, &mut all);
        a.flush_contact_samples(&b, &pose, &mut workspace, &mut flush);
        prop_assert!(flush.len() <= all.len());
        let mut rest = all.iter();
        for sample in &flush {
            let whole = rest.find(|whole| whole.point == sample.point && whole.normal == sample.normal);
            prop_assert!(sample.volume >= 0.0 && whole.is_some_and(|whole| sample.volume <= whole.volume * (1.0 + 1e-4)));
        }
        let distance = a.distance(&b, &pose, &mut ProximityWorkspace::default());
        if distance.is_some_and(|apart| apart.distance > a.contact_offset() + b.contact_offset()) {
            prop_assert!(flush.is_empty());
        }
    }

    #[test]
    fn gradients_are_the_derivatives_of_the_volume(
        a in random_packing(40), b in random_packing(40), pose in random_pose(0.5),
    ) {
        let (a, b) = (tree(&a), tree(&b));
        let exact = reference::overlap(&a, &b, &pose);
        let (rotation, translation) = (pose.rotation.as_dquat().normalize(), pose.translation.as_dvec3());
        let e = 1e-6;
        for axis in DVec3::AXES {
            let moved = |s: f64| reference::overlap_at(&a, &b, rotation, translation + axis * s).volume;
            prop_assert!(((moved(e) - moved(-e)) / (2.0 * e) - exact.gradient.dot(axis)).abs() < 1e-4);
            let turned = |s: f64| {
                let turn = DQuat::from_axis_angle(axis, s);
                let pivot = exact.centroid;
                reference::overlap_at(&a, &b, turn * rotation, pivot + turn * (translation - pivot)).volume
            };
            prop_assert!(((turned(e) - turned(-e)) / (2.0 * e) - exact.rotation_gradient.dot(axis)).abs() < 1e-4);
        }
    }
}

#[test]
fn two_balls_give_the_lens() {
    let overlap =
        ball(1.0).overlap(&ball(0.5), &Pose3::translation(0.0, 1.2, 0.0), &mut OverlapWorkspace::default());
    let lens = crate::lens::Lens::new(1.0, 0.5, 1.2);
    assert!((f64::from(overlap.volume) - lens.volume).abs() < 1e-6);
    assert!((overlap.centroid.y - lens.centroid as f32).abs() < 1e-6);
    assert!((overlap.gradient - Vec3::new(0.0, -lens.area as f32, 0.0)).length() < 1e-6);
    assert!(
        (overlap.force - Vec3::Y * overlap.volume).length() < 1e-6,
        "away from A, as large as the volume"
    );
    assert!(overlap.torque.length() < 1e-6);
}

#[test]
fn a_ball_inside_a_ball_is_pushed_out() {
    let pose = Pose3::from_parts(Vec3::new(0.3, 0.1, 0.0), Quat::from_rotation_z(2.0));
    let overlap = ball(1.0).overlap(&ball(0.2), &pose, &mut OverlapWorkspace::default());
    assert_eq!(overlap.gradient, Vec3::ZERO);
    assert!((overlap.force.length() / overlap.volume - 1.0).abs() < 1e-4);
}

#[test]
fn useless_poses_give_no_overlap() {
    let (a, b) = (ball(1.0), ball(1.0));
    let mut workspace = OverlapWorkspace::default();
    for pose in [
        Pose3::translation(f32::NAN, 0.0, 0.0),
        Pose3::translation(f32::INFINITY, 0.0, 0.0),
        Pose3::from_rotation(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
        Pose3::from_rotation(Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)),
    ] {
        assert_eq!(a.overlap(&b, &pose, &mut workspace), Overlap::default());
    }
}

#[test]
fn concentric_balls_overlap_in_the_smaller() {
    let overlap = ball(1.0).overlap(&ball(0.5), &Pose3::IDENTITY, &mut OverlapWorkspace::default());
    assert!((f64::from(overlap.volume) / crate::lens::Lens::new(0.5, 9.0, 0.0).volume - 1.0).abs() < 1e-6);
    assert!(overlap.centroid.is_finite() && overlap.force.is_finite() && overlap.torque.is_finite());
}

#[test]
fn coincident_solids_overlap_wholly() {
    for radius in [1e-4, 1.0, 5.0, 1e4] {
        let solid = ball(radius);
        let query = OverlapQuery { stiffness: true, ..OverlapQuery::default() };
        let overlap = solid.overlap_with(&solid, &Pose3::IDENTITY, query, &mut OverlapWorkspace::default());
        let volume = solid.solid().volume;
        assert!((f64::from(overlap.volume) / volume - 1.0).abs() < 1e-5, "{radius}: {}", overlap.volume);
        assert!(overlap.force.is_finite() && overlap.torque.is_finite());
        assert!(overlap.stiffness.unwrap().to_rows().as_flattened().iter().all(|x| x.is_finite()));
        assert!(overlap.intersects);
    }
}

/// A large volume without any direction was divided by zero.
#[test]
fn issue_a_large_volume_without_direction_gives_nan() {
    let overlap = ball(2.0).overlap(&ball(1.9), &Pose3::IDENTITY, &mut OverlapWorkspace::default());
    assert!(overlap.volume > 4.0 && overlap.force == Vec3::ZERO && overlap.torque == Vec3::ZERO);
}
