//! The stiffness against finite differences and against its definition.

use super::tests::{random_pose, tree};
use super::*;
use crate::tree::tests::random_packing;
use crate::{SpherePacking, reference};
use glam::{DQuat, DVec3, Quat};
use proptest::prelude::*;

const STIFF: OverlapQuery =
    OverlapQuery { law: ForceLaw::VolumeGradient, stiffness: true, engine: Engine::Tree };

/// Gradient of the reference's volume by translation and by rotation about `pivot`, with B displaced by
/// a translation and a rotation vector about it.
fn gradient(
    trees: [&InnerSphereTree; 2],
    pose: &Pose3,
    pivot: DVec3,
    [moved, turned]: [DVec3; 2],
) -> [f64; 6] {
    let turn = DQuat::from_scaled_axis(turned);
    let rotation = turn * pose.rotation.as_dquat().normalize();
    let translation = moved + pivot + turn * (pose.translation.as_dvec3() - pivot);
    let overlap = reference::overlap_at(trees[0], trees[1], rotation, translation);
    let about_pivot = overlap.rotation_gradient + (overlap.centroid - pivot).cross(overlap.gradient);
    let ([x, y, z], [u, v, w]) = (overlap.gradient.to_array(), about_pivot.to_array());
    [x, y, z, u, v, w]
}

/// Rows and columns.
fn entries() -> impl Iterator<Item = (usize, usize)> {
    (0..6).flat_map(|row| (0..6).map(move |column| (row, column)))
}

/// The packing in a frame whose origin is `origin` away, both in steps that single precision holds exactly.
fn moved(packing: &SpherePacking, origin: Vec3) -> SpherePacking {
    let mut spheres = packing.spheres().to_vec();
    for sphere in &mut spheres {
        sphere.center = in_steps(sphere.center) + origin;
        sphere.cell_centroid = sphere.center;
    }
    SpherePacking::new(spheres, *packing.solid()).expect("only moved")
}

fn in_steps(p: Vec3) -> Vec3 {
    (p * 512.0).round() / 512.0
}

proptest! {
    #[test]
    fn the_reference_equals_finite_differences(
        a in random_packing(12), b in random_packing(12), pose in random_pose(0.5),
    ) {
        let (a, b) = (tree(&a), tree(&b));
        let exact = reference::overlap(&a, &b, &pose);
        let e = 1e-7;
        let mut differences = [[0.0; 6]; 6];
        for column in 0..6 {
            let step = |sign: f64| {
                let mut twist = [DVec3::ZERO; 2];
                twist[column / 3][column % 3] = sign * e;
                gradient([&a, &b], &pose, exact.centroid, twist)
            };
            let (ahead, behind) = (step(1.0), step(-1.0));
            for (row, (ahead, behind)) in ahead.into_iter().zip(behind).enumerate() {
                differences[row][column] = (ahead - behind) / (2.0 * e);
            }
        }
        for (row, column) in entries() {
                // Rotations do not commute: their second derivative is the symmetric part. A translation moves the
                // pivot along with B, so the coupling is the derivative of the force.
                let difference = match (row < 3, column < 3) {
                    (false, true) => differences[column][row],
                    (false, false) => 0.5 * (differences[row][column] + differences[column][row]),
                    _ => differences[row][column],
                };
                let error = (exact.stiffness[row][column] - difference).abs();
                prop_assert!(error <= 1e-4 * exact.stiffness_scale.max(1e-3), "{row} {column} {error}");
        }
    }

    #[test]
    fn the_query_equals_the_reference(
        a in random_packing(150), b in random_packing(150), pose in random_pose(1.0), scale in 0.2_f32..5.0,
    ) {
        let (a, b) = (tree(&a).scaled(scale).unwrap(), tree(&b).scaled(scale).unwrap());
        let pose = Pose3::from_parts(pose.translation * scale, pose.rotation);
        let exact = reference::overlap(&a, &b, &pose);
        let mut workspace = OverlapWorkspace::default();
        let overlap = a.overlap_with(&b, &pose, STIFF, &mut workspace);
        let rows = overlap.stiffness.map_or([[0.0; 6]; 6], |stiffness| stiffness.to_rows());
        let unit = f64::from(scale);
        // Where one ball nearly contains the other the curvature changes within the rounding of the centres.
        let shifted = |shift: DVec3| {
            let translation = pose.translation.as_dvec3() + shift * (1e-6 * unit);
            reference::overlap_at(&a, &b, pose.rotation.as_dquat().normalize(), translation).stiffness
        };
        let nearby = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z].map(shifted);
        for (row, column) in entries() {
                let power = i32::from(row >= 3) + i32::from(column >= 3);
                let error = (f64::from(rows[row][column]) - exact.stiffness[row][column]).abs();
                let slack = nearby.map(|near| (near[row][column] - exact.stiffness[row][column]).abs());
                prop_assert!(
                    error <= slack.into_iter().sum::<f64>() + 2e-5 * exact.stiffness_scale * (2.0 * unit).powi(power) + 1e-9 * unit,
                    "{row} {column}: {} {}", rows[row][column], exact.stiffness[row][column]
                );
        }
        let plain = a.overlap_with(&b, &pose, OverlapQuery { stiffness: false, ..STIFF }, &mut workspace);
        prop_assert_eq!(plain, Overlap { stiffness: None, ..overlap });
    }

    /// The sums were about the origin of A's frame, in single precision: 79 % off a kilometre away, and 90 times as large as what they
    /// should be at ten.
    #[test]
    fn issue_the_stiffness_does_not_depend_on_where_solids_have_their_origins(
        a in random_packing(50), b in random_packing(50),
        (translation, origin) in (prop::array::uniform3(-1.0_f32..1.0), prop::array::uniform3(-8_000_i32..8_000)),
    ) {
        let (translation, origin) = (in_steps(Vec3::from_array(translation)), Vec3::from_array(origin.map(|x| x as f32)));
        let stiffness = |origin: Vec3| {
            let (a, b) = (tree(&moved(&a, origin)), tree(&moved(&b, origin)));
            let pose = Pose3::from_parts(translation, Quat::IDENTITY);
            let scale = reference::overlap(&a, &b, &pose).stiffness_scale;
            let found = a.overlap_with(&b, &pose, STIFF, &mut OverlapWorkspace::default()).stiffness;
            (found.map_or([[0.0; 6]; 6], |stiffness| stiffness.to_rows()), scale)
        };
        let (near, scale) = stiffness(Vec3::ZERO);
        let (far, _) = stiffness(origin);
        // The centroid, about which B turns, is a sum about the origin in single precision.
        let tolerance = (3e-7 * f64::from(origin.length())).max(2e-5);
        for (row, column) in entries() {
            let error = f64::from((near[row][column] - far[row][column]).abs());
            let power = i32::from(row >= 3) + i32::from(column >= 3);
            prop_assert!(error <= tolerance * scale * 2.0_f64.powi(power), "{row} {column}: {error} of {}", near[row][column]);
        }
    }

    #[test]
    fn the_deepest_pair_is_the_deepest(
        a in random_packing(100), b in random_packing(100), pose in random_pose(0.7),
    ) {
        let (packings, a, b) = ([a.clone(), b.clone()], tree(&a), tree(&b));
        let depth = |in_a: usize, in_b: usize| {
            let ((ca, ra), (cb, rb)) =
                (packings[0].spheres()[in_a].volume_ball(), packings[1].spheres()[in_b].volume_ball());
            (ra + rb - ca.distance(pose.transform_point(cb))).min(2.0 * ra.min(rb))
        };
        let greatest = (0..a.len())
            .flat_map(|i| (0..b.len()).map(move |j| (i, j)))
            .map(|(i, j)| depth(i, j))
            .fold(0.0, f32::max);
        let overlap = a.overlap(&b, &pose, &mut OverlapWorkspace::default());
        let Some(deepest) = overlap.deepest else {
            prop_assert!(greatest < 1e-5);
            return Ok(());
        };
        prop_assert!((deepest.depth - greatest).abs() < 1e-5);
        prop_assert!((depth(deepest.spheres[0], deepest.spheres[1]) - greatest).abs() < 1e-5);
    }
}
