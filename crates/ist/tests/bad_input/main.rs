//! What overlap queries make of input that is useless or extreme: an error or a defined result, and no NaN.
//!
//! Damaged `.ist` files are covered beside their reader, and proximity queries beside theirs.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod extremes;

use glam::{Quat, Vec3};
use glamx::Pose3;
use ist::{
    Budget, ContactPatch, Engine, ForceLaw, InnerSphere, InnerSphereTree, Overlap, OverlapCache,
    OverlapQuery, OverlapWorkspace, PackingError, SolidProperties, SpherePacking, TimeCriticalWorkspace,
    reference,
};

const LAWS: [ForceLaw; 3] = [ForceLaw::VolumeGradient, ForceLaw::OutwardNormals, ForceLaw::Blended];
const ENGINES: [Engine; 3] = [Engine::Auto, Engine::Tree, Engine::Grid];

fn packing(spheres: Vec<InnerSphere>) -> Result<SpherePacking, PackingError> {
    SpherePacking::new(spheres, SolidProperties::ball(1.0))
}

fn solid(spheres: Vec<InnerSphere>) -> InnerSphereTree {
    InnerSphereTree::new(&packing(spheres).unwrap()).with_grid()
}

/// A sphere with a cell as large as `volume`.
fn sphere(center: Vec3, radius: f32, volume: f32) -> InnerSphere {
    InnerSphere { center, radius, cell_volume: volume, cell_centroid: center, normal: Vec3::Y }
}

/// A body of `size` about `center`: 4 × 4 × 4 balls that touch, normals outwards.
fn body(size: f32, center: Vec3) -> Vec<InnerSphere> {
    let step = size / 4.0;
    (0..64)
        .map(|i| {
            let at = Vec3::new((i % 4) as f32, (i / 4 % 4) as f32, (i / 16) as f32) - 1.5;
            let normal = at.normalize();
            InnerSphere::solid_ball(center + at * step, 0.5 * step, normal)
        })
        .collect()
}

fn numbers(overlap: &Overlap) -> Vec<f32> {
    let Overlap { volume, centroid, gradient, rotation_gradient, force, torque, stiffness, deepest, .. } =
        *overlap;
    let mut all = vec![volume, deepest.map_or(0.0, |d| d.depth)];
    all.extend([centroid, gradient, rotation_gradient, force, torque].iter().flat_map(|v| v.to_array()));
    if let Some(stiffness) = stiffness {
        all.extend(stiffness.to_rows().as_flattened());
    }
    all
}

/// Results of all engines and laws, with and without stiffness; `passes` holds every number of them and of all contact
/// samples. Returns that of the default query.
fn all_overlaps(what: &str, [a, b]: [&InnerSphereTree; 2], pose: &Pose3, passes: fn(f32) -> bool) -> Overlap {
    let mut workspace = OverlapWorkspace::default();
    for engine in ENGINES {
        for law in LAWS {
            for stiffness in [false, true] {
                let query = OverlapQuery { law, stiffness, engine };
                let overlap = a.overlap_with(b, pose, query, &mut workspace);
                assert!(numbers(&overlap).into_iter().all(passes), "{what}, {query:?}: {overlap:?}");
            }
        }
    }
    let mut cache = OverlapCache::default();
    let mut time_critical = TimeCriticalWorkspace::default();
    for visits in [1, 10, 100_000] {
        let query = OverlapQuery { stiffness: true, ..OverlapQuery::default() };
        let cached = a.overlap_cached(b, pose, query, (&mut cache, &mut workspace));
        assert!(numbers(&cached).into_iter().all(passes), "{what}, cached: {cached:?}");
        let estimate = a.overlap_within(b, pose, Budget::Visits(visits), &mut time_critical);
        assert!(numbers(&estimate.expected).into_iter().all(passes), "{what}, {visits} visits: {estimate:?}");
        assert!(passes(estimate.lower) && passes(estimate.upper) && estimate.lower <= estimate.upper);
    }
    let mut patches = Vec::new();
    a.contact_patches(b, pose, &mut workspace, &mut patches);
    for patch in patches {
        let ContactPatch { centroid, gradient, rotation_gradient, force, torque, bounds, points, .. } = patch;
        let vectors = [centroid, gradient, rotation_gradient, force, torque, bounds.0, bounds.1];
        let all = vectors.iter().chain(&points).flat_map(|v| v.to_array());
        assert!(all.chain([patch.volume, patch.area]).all(passes), "{what}: {patch:?}");
    }
    let mut samples = Vec::new();
    a.contact_samples(b, pose, &mut workspace, &mut samples);
    a.flush_contact_samples(b, pose, &mut workspace, &mut samples);
    for sample in samples {
        let all = [sample.point.to_array(), sample.vector_area.to_array(), [sample.volume; 3]];
        assert!(all.as_flattened().iter().all(|&x| passes(x)), "{what}: {sample:?}");
        assert!((sample.normal.length() - 1.0).abs() < 1e-4, "{what}: {sample:?}");
    }
    a.overlap(b, pose, &mut workspace)
}

fn finite(what: &str, trees: [&InnerSphereTree; 2], pose: &Pose3) -> Overlap {
    all_overlaps(what, trees, pose, f32::is_finite)
}

/// Poses from coincidence to a shallow overlap of bodies of `size`.
fn poses(size: f32) -> [Pose3; 4] {
    [0.0, 0.1, 0.3, 0.6].map(|shift| {
        Pose3::from_parts(Vec3::new(shift, 0.2 * shift, 0.0) * size, Quat::from_rotation_z(shift))
    })
}

/// `overlap` is that of the reference, within 1e-5; `size` is that of the bodies.
fn assert_exact(what: &str, overlap: &Overlap, exact: &reference::ReferenceOverlap, size: f64) {
    assert!((f64::from(overlap.volume) / exact.volume - 1.0).abs() < 1e-5, "{what}: {overlap:?}");
    assert!((overlap.centroid.as_dvec3() - exact.centroid).length() < 1e-5 * size, "{what}: {overlap:?}");
    let gradient = overlap.gradient.as_dvec3() - exact.gradient;
    assert!(gradient.length() <= 1e-5 * exact.area, "{what}: {overlap:?}");
}

#[test]
fn a_packing_needs_spheres_with_usable_numbers() {
    assert_eq!(packing(Vec::new()).unwrap_err(), PackingError::Empty);
    let good = sphere(Vec3::ZERO, 1.0, 5.0);
    for bad in [f32::NAN, f32::INFINITY, -1.0, 0.0] {
        assert!(packing(vec![good, sphere(Vec3::ZERO, bad, 5.0)]).is_err(), "radius {bad}");
        assert!(packing(vec![good, sphere(Vec3::ZERO, 1.0, bad)]).is_err(), "cell volume {bad}");
    }
    let nowhere = Vec3::new(0.0, f32::NAN, 0.0);
    assert!(packing(vec![sphere(nowhere, 1.0, 5.0)]).is_err());
    assert!(packing(vec![InnerSphere { cell_centroid: nowhere, ..good }]).is_err());
    assert!(packing(vec![InnerSphere { normal: nowhere, ..good }]).is_err());
    assert!(packing(vec![InnerSphere { normal: Vec3::ZERO, ..good }]).is_err());
    assert!(
        SpherePacking::new(vec![good], SolidProperties { volume: 0.0, ..SolidProperties::ball(1.0) })
            .is_err()
    );
}

#[test]
fn useless_poses_give_nothing() {
    let tree = solid(body(1.0, Vec3::ZERO));
    let turned = |length: f32| Pose3::from_rotation(Quat::from_rotation_x(0.4) * length);
    let mut useless: Vec<Pose3> = [0.0, 0.1, 0.49, 2.1, 3.0, 1e30, f32::NAN].map(turned).to_vec();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        useless.extend(Vec3::AXES.map(|axis| Pose3::from_translation(axis * bad)));
        useless.push(Pose3::from_rotation(Quat::from_xyzw(0.0, bad, 0.0, 1.0)));
    }
    for pose in useless {
        for engine in ENGINES {
            let query = OverlapQuery { engine, stiffness: true, ..OverlapQuery::default() };
            let overlap = tree.overlap_with(&tree, &pose, query, &mut OverlapWorkspace::default());
            assert_eq!(overlap, Overlap::default(), "{pose:?}");
        }
        let mut samples = Vec::new();
        tree.contact_samples(&tree, &pose, &mut OverlapWorkspace::default(), &mut samples);
        tree.flush_contact_samples(&tree, &pose, &mut OverlapWorkspace::default(), &mut samples);
        assert!(samples.is_empty());
    }
}

#[test]
fn rotations_of_about_unit_length_are_normalised() {
    let tree = solid(body(1.0, Vec3::ZERO));
    let at = |length: f32| {
        Pose3::from_parts(Vec3::new(0.5, 0.1, 0.0), Quat::from_rotation_x(0.4).normalize() * length)
    };
    let exact = finite("unit", [&tree, &tree], &at(1.0));
    for length in [0.51, 0.9, 1.1, 1.9] {
        let overlap = finite("nearly unit", [&tree, &tree], &at(length));
        assert!((overlap.volume / exact.volume - 1.0).abs() < 1e-5);
        assert!(overlap.force.distance(exact.force) < 1e-5 * exact.volume);
    }
}

#[test]
fn scales_and_skins_that_are_none_are_refused() {
    let tree = solid(body(1.0, Vec3::ZERO));
    for bad in [0.0, -0.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert!(tree.scaled(bad).is_none(), "{bad}");
        assert!(bad == 0.0 || tree.with_skin(bad).is_none(), "{bad}");
    }
    assert!(tree.scaled(1e-30).and_then(|tree| tree.scaled(1e-30)).is_none(), "underflows to zero");
    assert!(tree.scaled(1e30).and_then(|tree| tree.scaled(1e30)).is_none(), "overflows to infinity");
}

#[test]
fn equal_spheres_and_coincident_trees() {
    for count in [1, 2, 7, 8, 9, 63, 64, 65, 300] {
        let tree = solid(vec![InnerSphere::solid_ball(Vec3::ONE, 0.5, Vec3::Y); count]);
        let pairs = (count * count) as u32;
        for pose in [Pose3::IDENTITY, Pose3::translation(0.25, 0.0, 0.0), Pose3::translation(1e-20, 0.0, 0.0)]
        {
            let overlap = finite("equal spheres", [&tree, &tree], &pose);
            assert_eq!(overlap.pairs, pairs);
            assert!(overlap.intersects);
            assert_exact("equal spheres", &overlap, &reference::overlap(&tree, &tree, &pose), 1.0);
        }
        let apart =
            tree.overlap(&tree, &Pose3::translation(1.01, 0.0, 0.0), &mut OverlapWorkspace::default());
        assert_eq!(apart, Overlap::default());
    }
    for tree in [solid(body(1.0, Vec3::ZERO)), solid(body(1.0, Vec3::splat(3.0)))] {
        let overlap = finite("coincident", [&tree, &tree], &Pose3::IDENTITY);
        assert!(
            (f64::from(overlap.volume) / reference::overlap(&tree, &tree, &Pose3::IDENTITY).volume - 1.0)
                .abs()
                < 1e-5
        );
        let skinned = tree.with_skin(0.01).unwrap();
        finite("coincident, with skins", [&skinned, &skinned], &Pose3::IDENTITY);
    }
}
