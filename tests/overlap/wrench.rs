//! Forces and torques on the assets: equal and opposite, about any point, and the derivatives of the reference's volume.

use super::{PAIRS, figures, packing, size, trees};
use glam::{DQuat, DVec3, Vec3};
use glamx::Pose3;
use ist::{
    ForceLaw, InnerSphere, InnerSphereTree, OverlapQuery, OverlapWorkspace, SolidProperties, SpherePacking,
    reference,
};
use rapier_ist_tests::Truth;

/// Every fourth pose of a file at which something overlaps.
fn some_poses(name: &str) -> Vec<Pose3> {
    let truth = Truth::load(name).unwrap();
    truth.poses.iter().filter(|pose| pose.volume > 0.0).step_by(4).map(|pose| pose.pose()).collect()
}

#[test]
fn both_solids_feel_the_opposite() {
    for (name, assets, scale) in PAIRS {
        let [a, b] = trees(assets, scale, 300);
        let mut workspace = OverlapWorkspace::default();
        let reach = size(&a).max(size(&b));
        let mut worst = [0.0_f64; 3];
        for pose in some_poses(name) {
            let exact = reference::overlap(&a, &b, &pose);
            if exact.volume == 0.0 {
                continue;
            }
            for (law, worst) in [ForceLaw::VolumeGradient, ForceLaw::OutwardNormals, ForceLaw::Blended]
                .into_iter()
                .zip(&mut worst)
            {
                let query = OverlapQuery { law, ..OverlapQuery::default() };
                let ab = a.overlap_with(&b, &pose, query, &mut workspace);
                let ba = b.overlap_with(&a, &pose.inverse(), query, &mut workspace);
                let size = if law == ForceLaw::VolumeGradient { exact.area.max(1e-12) } else { exact.volume };
                let force = (ab.force + pose.rotation * ba.force).as_dvec3().length() / size;
                let torque = (ab.torque + pose.rotation * ba.torque).as_dvec3().length() / (size * reach);
                // Rounding of distances by 1e-7 of the reach, against a force that changes over the depth.
                let depth = exact.volume / exact.area.max(1e-12);
                let slack = 1e-5 + 1e-6 * reach / depth;
                assert!(force.max(torque) < slack, "{name}, {law:?} at {pose:?}: {force} {torque}, {slack}");
                *worst = worst.max(force).max(torque);
            }
        }
        println!(
            "{name}: forces on A and B differ by at most {} (gradient, normals, blended)",
            figures(&worst)
        );
    }
}

#[test]
fn torques_are_those_of_the_samples_about_any_point() {
    for (name, assets, scale) in PAIRS {
        let [a, b] = trees(assets, scale, 300);
        let (mut workspace, mut samples) = (OverlapWorkspace::default(), Vec::new());
        let query = OverlapQuery { law: ForceLaw::VolumeGradient, ..OverlapQuery::default() };
        for pose in some_poses(name) {
            let overlap = a.overlap_with(&b, &pose, query, &mut workspace);
            samples.clear();
            a.contact_samples(&b, &pose, &mut workspace, &mut samples);
            let area: f64 = samples.iter().map(|s| s.vector_area.as_dvec3().length()).sum();
            for point in [overlap.centroid, Vec3::ZERO, Vec3::new(3.0, -2.0, 1.0), pose.translation] {
                let (mut torque, mut arms) = (DVec3::ZERO, 0.0);
                for sample in &samples {
                    let arm = (sample.point - point).as_dvec3();
                    torque += arm.cross(sample.vector_area.as_dvec3());
                    arms += arm.length() * sample.vector_area.as_dvec3().length();
                }
                let arm = (overlap.centroid - point).as_dvec3();
                let shifted = overlap.torque.as_dvec3() + arm.cross(overlap.force.as_dvec3());
                // The torque about the centroid is the difference of two about A's origin.
                let slack = 2e-5 * arms + 1e-6 * area * overlap.centroid.as_dvec3().length();
                assert!((torque - shifted).length() <= slack, "{name} about {point}: {torque} {shifted}");
            }
        }
    }
}

#[test]
fn gradients_are_derivatives_of_the_reference() {
    for (name, assets, scale) in PAIRS {
        let [a, b] = trees(assets, scale, 300);
        let (reach, mut worst) = (size(&b), [0.0_f64; 2]);
        let mut workspace = OverlapWorkspace::default();
        for pose in some_poses(name).iter().step_by(2) {
            let overlap = a.overlap(&b, pose, &mut workspace);
            let area = reference::overlap(&a, &b, pose).area;
            if area == 0.0 {
                continue;
            }
            let pivot = overlap.centroid.as_dvec3();
            let (rotation, translation) = (pose.rotation.as_dquat().normalize(), pose.translation.as_dvec3());
            let step = 1e-6 * reach;
            for axis in DVec3::AXES {
                let moved = |x: f64| reference::overlap_at(&a, &b, rotation, translation + x * axis).volume;
                let turned = |angle: f64| {
                    let turn = DQuat::from_axis_angle(axis, angle);
                    let place = pivot + turn * (translation - pivot);
                    reference::overlap_at(&a, &b, turn * rotation, place).volume
                };
                let slope = (moved(step) - moved(-step)) / (2.0 * step);
                let error = (slope - overlap.gradient.as_dvec3().dot(axis)).abs() / area;
                let slope = (turned(1e-6) - turned(-1e-6)) / 2e-6;
                let arm = size(&a).max(reach);
                let turning = (slope - overlap.rotation_gradient.as_dvec3().dot(axis)).abs() / (area * arm);
                assert!(error.max(turning) < 1e-4, "{name} at {pose:?}: {error} {turning}");
                worst = [worst[0].max(error), worst[1].max(turning)];
            }
        }
        println!("{name}: gradients off by at most {} of the area (translation, rotation)", figures(&worst));
    }
}

/// Both solids moved by `place` in their own frames.
fn moved(packing: &SpherePacking, place: Vec3) -> InnerSphereTree {
    let spheres = packing.spheres().iter().map(|s| InnerSphere {
        center: s.center + place,
        cell_centroid: s.cell_centroid + place,
        ..*s
    });
    let solid = *packing.solid();
    let solid = SolidProperties { centroid: solid.centroid + place.as_dvec3(), ..solid };
    InnerSphereTree::new(&SpherePacking::new(spheres.collect(), solid).unwrap()).with_grid()
}

/// Meshes that were modelled a hundred of their sizes away from their origins.
#[test]
fn origins_far_away() {
    for (name, assets, scale) in PAIRS {
        let place = Vec3::new(60.0, -64.0, 48.0);
        let [a, b] = assets.map(|asset| moved(&packing(asset, 300), place));
        let b = b.scaled(scale).unwrap();
        // Places are rounded to f32 when a solid is moved, when its pose is, and when it is transformed.
        let shift = 4.0 * f64::from(f32::EPSILON * place.length());
        let (mut workspace, mut worst) = (OverlapWorkspace::default(), [0.0_f64; 3]);
        for pose in some_poses(name) {
            let translation = pose.translation + place - pose.rotation * (place * scale);
            let pose = Pose3::from_parts(translation, pose.rotation);
            let exact = reference::overlap(&a, &b, &pose);
            let overlap = a.overlap(&b, &pose, &mut workspace);
            if exact.area == 0.0 {
                continue;
            }
            let volume = (f64::from(overlap.volume) - exact.volume).abs();
            assert!(volume <= shift * exact.area + 1e-5 * exact.volume, "{name}: {volume}");
            // The disc of a pair changes with the distance by up to 2π times the smaller radius.
            let radius = b.volume_balls().map(|(_, r)| f64::from(r)).fold(0.0, f64::max);
            let slack = shift * std::f64::consts::TAU * radius * f64::from(exact.pairs);
            let gradient = (overlap.gradient.as_dvec3() - exact.gradient).length();
            assert!(gradient <= slack + 1e-5 * exact.area, "{name}: {gradient}");
            let turned = (overlap.rotation_gradient.as_dvec3() - exact.rotation_gradient).length();
            let arm = 2.0 * size(&a).max(size(&b));
            // A torque about the centroid is the difference of two about an origin that is far away.
            let far = f64::from(f32::EPSILON * place.length()) * exact.area;
            assert!(
                turned <= (slack + 1e-5 * exact.area) * arm + 4.0 * far + slack * arm,
                "{name}: {turned}"
            );
            worst = [
                worst[0].max(volume / (exact.area * size(&b))),
                worst[1].max(gradient / exact.area),
                worst[2].max(turned / (exact.area * arm)),
            ];
        }
        println!(
            "{name}, {:.0} m away: volume off by at most {:.1e} of area times size, gradients by {:.1e} and {:.1e}",
            place.length(),
            worst[0],
            worst[1],
            worst[2]
        );
    }
}
