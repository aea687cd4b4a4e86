//! Sizes, places and proportions at the ends of f32 and beyond.

use super::{all_overlaps, assert_exact, body, finite, numbers, packing, poses, solid, sphere};
use glam::{Quat, Vec3};
use glamx::Pose3;
use ist::{BallKind, InnerSphere, InnerSphereTree, Overlap, reference};

/// One result is that of the reference from atoms to stars: cells of 1e-38 m³, and torques of 1e37 N·m.
#[test]
fn all_sizes_are_as_exact() {
    for size in [1e-11, 1e-9, 1e-7, 1e-4, 1.0, 1e4, 1e6, 1e7, 1e8, 1e9] {
        let packed = solid(body(size, Vec3::ZERO));
        let scaled = solid(body(1.0, Vec3::ZERO)).scaled(size).unwrap();
        for (pose, tree) in poses(size).iter().flat_map(|pose| [(pose, &packed), (pose, &scaled)]) {
            let what = format!("{size} m at {pose:?}");
            let overlap = finite(&what, [tree, tree], pose);
            assert_exact(&what, &overlap, &reference::overlap(tree, tree, pose), f64::from(size));
        }
    }
}

/// Beyond f32 fields are infinite or zero, one by one, and never NaN.
#[test]
fn sizes_beyond_single_precision() {
    for size in [1e-38_f32, 1e-30, 1e-20, 1e-13, 1e10, 1e11, 1e12, 1e13, 1e20, 1e30] {
        // Cell volumes are refused where they are zero or infinite.
        let packed = packing(body(size, Vec3::ZERO)).ok().map(|p| InnerSphereTree::new(&p).with_grid());
        let scaled = solid(body(1.0, Vec3::ZERO)).scaled(size);
        for tree in packed.iter().chain(&scaled) {
            for pose in poses(size) {
                let what = format!("{size} m at {pose:?}");
                let overlap = all_overlaps(&what, [tree, tree], &pose, |x| !x.is_nan());
                let exact = reference::overlap(tree, tree, &pose);
                if size > 1e-20 {
                    let error = (overlap.centroid.as_dvec3() - exact.centroid).length();
                    assert!(error < 1e-5 * f64::from(size), "{what}: {overlap:?}");
                }
                if exact.volume < 3e38 {
                    assert!((f64::from(overlap.volume) - exact.volume).abs() <= 1e-5 * exact.volume + 1e-44);
                }
            }
        }
    }
}

#[test]
fn extreme_radii_and_cells() {
    let extremes = [
        (1e-30, 1e-30),
        (1e-30, 1.0),
        (1e-40, 1e-44),
        (1e30, 1.0),
        (1e30, 1e38),
        (f32::MAX, f32::MAX),
        (f32::MIN_POSITIVE, f32::MIN_POSITIVE),
        (1.0, 3e38),
        (1e-30, 3e38),
        (1.0, 4.2),
        (1e12, 1e36),
        (1e-12, 1e-36),
    ];
    for (ra, va) in extremes {
        for (rb, vb) in extremes {
            let (a, b) = (solid(vec![sphere(Vec3::ZERO, ra, va)]), solid(vec![sphere(Vec3::ZERO, rb, vb)]));
            for at in [0.0, 1e-30, 1e-12, 1.0, 0.7 * ra, 0.7 * rb, 0.7 * (ra * 0.5 + rb * 0.5)] {
                let what = format!("{ra} {va} against {rb} {vb} at {at}");
                let pose = Pose3::translation(at, 0.0, 0.0);
                let overlap = all_overlaps(&what, [&a, &b], &pose, |x| !x.is_nan());
                let exact = reference::overlap(&a, &b, &pose);
                let ratio = b.bounding_ball().1 / a.bounding_ball().1;
                if overlap.pairs > 0 && (1e-7..1e7).contains(&ratio) && exact.volume < 3e38 {
                    // Rounding of the distance, times the area.
                    let slack = 1e-5 * exact.volume + 1e-6 * exact.area * f64::from(at) + 1e-44;
                    assert!((f64::from(overlap.volume) - exact.volume).abs() <= slack, "{what}: {overlap:?}");
                }
            }
        }
    }
}

/// Spheres of one packing whose coordinates or radii differ by 60 powers of ten.
#[test]
fn extremes_in_one_packing() {
    let list = vec![
        sphere(Vec3::ZERO, 1.0, 5.0),
        sphere(Vec3::splat(1e30), 1e29, 1.0),
        sphere(Vec3::splat(-1e-30), 1e-30, 1e-40),
        sphere(Vec3::new(1e-3, f32::MIN_POSITIVE, -1e30), 1e-3, 1e-9),
    ];
    let far = InnerSphere { cell_centroid: Vec3::splat(-1e30), ..sphere(Vec3::ZERO, 1.0, 5.0) };
    for spheres in [list, vec![far], vec![far; 100]] {
        let tree = solid(spheres);
        for pose in [Pose3::IDENTITY, Pose3::translation(0.5, 0.0, 0.0), Pose3::translation(1e29, 0.0, 1e30)]
        {
            all_overlaps("extremes", [&tree, &tree], &pose, |x| !x.is_nan());
            let small = solid(body(1.0, Vec3::ZERO));
            all_overlaps("extremes", [&small, &tree], &pose, |x| !x.is_nan());
            all_overlaps("extremes", [&tree, &small], &pose, |x| !x.is_nan());
        }
    }
}

/// A body against one 1e7 times smaller, deep in its largest ball and on its surface, either way round.
#[test]
fn sizes_ten_million_apart() {
    let large = solid(body(1.0, Vec3::ZERO));
    let small = large.scaled(1e-7).unwrap();
    for at in [Vec3::splat(0.125), Vec3::splat(0.1), Vec3::new(0.125, 0.125, 0.25 + 2e-8)] {
        for turn in [0.0, 0.7] {
            let pose = Pose3::from_parts(at, Quat::from_rotation_y(turn));
            let what = format!("{at}, turned by {turn}");
            let exact = reference::overlap(&large, &small, &pose);
            let by_large = finite(&what, [&large, &small], &pose);
            // The place is known to 6e-8 m, as far as f32 tells, which is more than half of the small body.
            let slack = 6e-8 * exact.area + 1e-5 * exact.volume;
            assert!((f64::from(by_large.volume) - exact.volume).abs() <= slack, "{what}");
            let by_small = finite(&what, [&small, &large], &pose.inverse());
            assert!(f64::from(by_small.volume) <= 1.01 * small_volume(&small), "{what}");
        }
    }
    let inside = finite("deep", [&large, &small], &Pose3::from_translation(Vec3::splat(0.125)));
    assert!((f64::from(inside.volume) / small_volume(&small) - 1.0).abs() < 1e-5);
    assert!(inside.intersects);
}

fn small_volume(tree: &InnerSphereTree) -> f64 {
    tree.volume_balls().map(|(_, r)| f64::from(r).powi(3) * 4.0 / 3.0 * core::f64::consts::PI).sum()
}

#[test]
fn sizes_so_far_apart_that_nothing_is_found() {
    let tree = solid(body(1.0, Vec3::ZERO));
    for factor in [1e-38, 1e-30, 1e-25, 1e-20, 1e-16, 1e-13, 1e13, 1e16, 1e20, 1e30, 1e38] {
        let other = tree.scaled(factor).unwrap();
        for at in [0.0, 0.1, 1.0, factor] {
            let pose = Pose3::translation(at, 0.0, 0.0);
            all_overlaps("far apart in size", [&tree, &other], &pose, |x| !x.is_nan());
            all_overlaps("far apart in size", [&other, &tree], &pose, |x| !x.is_nan());
            for kind in [BallKind::Inner, BallKind::Volume] {
                let _ = other.nearest_sphere(pose.translation, kind);
            }
            let _ = tree.intersects(&other, &pose, &mut Default::default());
            if let Some(found) = tree.distance(&other, &pose, &mut Default::default()) {
                assert!(!found.distance.is_nan() && found.normal.is_finite());
            }
        }
    }
    for thickness in [1e8, 1e10, 1e20, f32::MAX] {
        let thick = tree.with_skin(thickness).unwrap();
        for other in [&tree, &thick] {
            all_overlaps("skins", [&thick, other], &Pose3::IDENTITY, |x| !x.is_nan());
            all_overlaps("skins", [other, &thick], &Pose3::translation(1e7, 0.0, 0.0), |x| !x.is_nan());
        }
    }
}

/// Blocks of B are padded with points 1e30 from its origin. Of a body 1e30 times smaller than A they stood inside A, and were
/// taken for spheres that do not exist.
#[test]
fn issue_padding_of_small_bodies() {
    let large = solid(vec![sphere(Vec3::ZERO, 1.0, 4.2)]);
    for factor in [1e-38, 1e-31, 1e-30, 1e-29] {
        let small = large.scaled(factor).unwrap();
        assert_eq!(finite("padding", [&large, &small], &Pose3::IDENTITY), Overlap::default());
    }
}

/// A body that is modelled a hundred times its size from its frame's origin: only the rounding of its coordinates shows.
#[test]
fn far_from_the_origin() {
    for distance in [10.0, 100.0, 1e4] {
        let center = Vec3::new(0.6, -0.64, 0.48) * distance;
        let tree = solid(body(1.0, center));
        for pose in poses(1.0) {
            // About the body's centre.
            let translation = center + pose.translation - pose.rotation * center;
            let pose = Pose3::from_parts(translation, pose.rotation);
            let what = format!("{distance} m away at {pose:?}");
            let overlap = finite(&what, [&tree, &tree], &pose);
            let exact = reference::overlap(&tree, &tree, &pose);
            // Four roundings of coordinates of that size.
            let shift = 4.0 * f64::from(f32::EPSILON * distance);
            let error = f64::from(overlap.volume) - exact.volume;
            assert!(error.abs() <= shift * exact.area + 1e-5 * exact.volume, "{what}: {error}");
            let moved = overlap.centroid.as_dvec3() - exact.centroid;
            assert!(moved.length() <= shift * (1.0 + exact.area / exact.volume), "{what}: {moved}");
            let turned = overlap.rotation_gradient.as_dvec3() - exact.rotation_gradient;
            assert!(turned.length() <= (shift * 10.0 + 1e-5) * exact.area.max(1.0), "{what}: {turned}");
        }
    }
}

#[test]
fn half_spaces() {
    for size in [1e-30, 1e-9, 1.0, 1e9, 1e30] {
        let tree = solid(body(1.0, Vec3::ZERO)).scaled(size).unwrap();
        for offset in [0.0, 0.1 * size, -0.3 * size, 1e30, -1e30, f32::MAX, -f32::MAX] {
            let overlap = tree.overlap_with_half_space(Vec3::Y, offset);
            assert!(numbers(&overlap).iter().all(|x| !x.is_nan()), "{size} {offset}: {overlap:?}");
        }
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(tree.overlap_with_half_space(Vec3::Y, bad), Overlap::default());
            assert_eq!(tree.overlap_with_half_space(Vec3::splat(bad), 0.0), Overlap::default());
        }
    }
}
