//! Properties of contact patches, against brute force and against the overlap as a whole.

use super::*;
use crate::tree::tests::random_packing;
use crate::{InnerSphere, Overlap, OverlapQuery, SolidProperties, SpherePacking};
use alloc::vec;
use glam::{DVec3, Quat};
use proptest::prelude::*;

fn random_pose(reach: f32) -> impl Strategy<Value = Pose3> {
    (prop::array::uniform3(-reach..reach), prop::array::uniform3(-3.0_f32..3.0))
        .prop_map(|(t, r)| Pose3::from_parts(t.into(), Quat::from_scaled_axis(r.into())))
}

fn patches_of(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> Vec<ContactPatch> {
    let mut patches = vec![ContactPatch::default()];
    a.contact_patches(b, pose, &mut OverlapWorkspace::default(), &mut patches);
    patches
}

fn overlap_of(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> Overlap {
    a.overlap(b, pose, &mut OverlapWorkspace::default())
}

fn tree_of(spheres: Vec<InnerSphere>) -> InnerSphereTree {
    InnerSphereTree::new(&SpherePacking::new(spheres, SolidProperties::ball(1.0)).unwrap())
}

/// Balls of radius 0.05 in rows that fill a box, as large as their cells, with normals away from the box's centre.
fn lattice(lower: Vec3, upper: Vec3) -> Vec<InnerSphere> {
    let counts = ((upper - lower) / 0.1).round().as_ivec3();
    let mut spheres = Vec::new();
    for x in 0..counts.x {
        for y in 0..counts.y {
            for z in 0..counts.z {
                let center = lower + 0.1 * (Vec3::new(x as f32, y as f32, z as f32) + 0.5);
                let outward = (center - 0.5 * (lower + upper)).try_normalize().unwrap_or(Vec3::Y);
                let mut sphere = InnerSphere::solid_ball(center, 0.05, outward);
                sphere.cell_volume = 1e-3;
                spheres.push(sphere);
            }
        }
    }
    spheres
}

/// Two walls along y and z with 0.8 between them.
fn walls() -> InnerSphereTree {
    let mut spheres = lattice(Vec3::new(-0.7, -0.5, -0.5), Vec3::new(-0.4, 0.5, 0.5));
    spheres.extend(lattice(Vec3::new(0.4, -0.5, -0.5), Vec3::new(0.7, 0.5, 0.5)));
    tree_of(spheres)
}

/// Groups by brute force: for each sphere of `tree` that takes part, the least one that it is connected with.
fn groups(tree: &InnerSphereTree, takes_part: &[bool]) -> Vec<usize> {
    let balls: Vec<_> = tree.volume_balls().collect();
    let mut group: Vec<usize> = (0..balls.len()).collect();
    let touch = |i: usize, j: usize| {
        let reach = touching::REACH * (balls[i].1 + balls[j].1);
        takes_part[i] && takes_part[j] && balls[i].0.distance_squared(balls[j].0) <= reach * reach
    };
    loop {
        let before = group.clone();
        for i in 0..balls.len() {
            for j in (0..balls.len()).filter(|j| touch(i, *j)) {
                group[i] = group[i].min(group[j]);
            }
        }
        if group == before {
            return group;
        }
    }
}

proptest! {
    #[test]
    fn patches_add_up_to_the_overlap(
        a in random_packing(200), b in random_packing(200), pose in random_pose(1.5),
        scale in prop::array::uniform2(0.2_f32..5.0), skin in prop::array::uniform2(0.0_f32..0.1),
    ) {
        let solid = |packing, i: usize| InnerSphereTree::new(packing).scaled(scale[i]).unwrap().with_skin(skin[i]).unwrap();
        let (a, b) = (solid(&a, 0), solid(&b, 1));
        let (patches, overlap) = (patches_of(&a, &b, &pose), overlap_of(&a, &b, &pose));
        let volume: f64 = patches.iter().map(|p| f64::from(p.volume)).sum();
        let whole = f64::from(overlap.volume);
        prop_assert!((volume - whole).abs() <= 1e-5 * whole);
        let size = f64::from(scale[0] + scale[1] + skin[0] + skin[1]) * 2.0;
        let moment: DVec3 = patches.iter().map(|p| f64::from(p.volume) * p.centroid.as_dvec3()).sum();
        prop_assert!((moment - whole * overlap.centroid.as_dvec3()).length() <= 1e-5 * whole * size);
        let area: f64 = patches.iter().map(|p| f64::from(p.area)).sum();
        let gradient: DVec3 = patches.iter().map(|p| p.gradient.as_dvec3()).sum();
        prop_assert!((gradient - overlap.gradient.as_dvec3()).length() <= 1e-5 * area);
        // Turning about A's origin, so that terms of different centroids can be added.
        let turned = |centroid: Vec3, gradient: Vec3, about: Vec3| {
            about.as_dvec3() + centroid.as_dvec3().cross(gradient.as_dvec3())
        };
        let all = turned(overlap.centroid, overlap.gradient, overlap.rotation_gradient);
        let parts: DVec3 = patches.iter().map(|p| turned(p.centroid, p.gradient, p.rotation_gradient)).sum();
        prop_assert!((parts - all).length() <= 2e-5 * area * size);
        // Pairs that graze each other without a volume are of no patch.
        let pairs: u32 = patches.iter().map(|p| p.pairs).sum();
        prop_assert!(pairs <= overlap.pairs && overlap.pairs - pairs <= 1 + overlap.pairs / 100);
    }

    #[test]
    fn each_patch_is_sound(a in random_packing(200), b in random_packing(200), pose in random_pose(1.5)) {
        let (a, b) = (InnerSphereTree::new(&a), InnerSphereTree::new(&b));
        let patches = patches_of(&a, &b, &pose);
        prop_assert!(patches.is_sorted_by(|p, q| p.volume >= q.volume));
        for p in &patches {
            prop_assert!(p.volume > 0.0 && p.pairs > 0);
            prop_assert!(p.gradient.length() <= p.area * (1.0 + 1e-5));
            prop_assert!(p.force.length() <= p.volume * 1.001);
            let (lower, upper) = (p.bounds.0 - 1e-5, p.bounds.1 + 1e-5);
            for point in p.points.iter().chain([&p.centroid]) {
                prop_assert!(point.cmpge(lower).all() && point.cmple(upper).all(), "{p:?}");
            }
        }
        if let [patch] = &patches[..] {
            let overlap = overlap_of(&a, &b, &pose);
            let tolerance = 2e-4 * overlap.volume;
            prop_assert!((patch.force - overlap.force).length() <= tolerance);
            prop_assert!((patch.torque - overlap.torque).length() <= tolerance * 4.0);
        }
    }

    #[test]
    fn regions_are_those_of_the_definition(a in random_packing(60), b in random_packing(60), pose in random_pose(2.0)) {
        let trees = [InnerSphereTree::new(&a), InnerSphereTree::new(&b)];
        with_lenses(&trees[0], &trees[1], &pose, &mut OverlapWorkspace::default(), |cloud, scratch| {
            scratch.split(&cloud, [&trees[0], &trees[1]]);
            let groups = [0, 1].map(|side| {
                let mut takes_part = vec![false; trees[side].len()];
                for lens in 0..cloud.len() {
                    takes_part[cloud.spheres(lens)[side] as usize] = true;
                }
                groups(&trees[side], &takes_part)
            });
            let mut expected: Vec<[u32; 2]> = Vec::new();
            for lens in 0..cloud.len() {
                let spheres = cloud.spheres(lens);
                let label = [0, 1].map(|side| groups[side][spheres[side] as usize] as u32);
                let run = scratch.runs.iter().find(|run| run.lenses[1] as usize > lens).unwrap();
                assert_eq!(run.groups, label);
                expected.push(label);
            }
            expected.sort_unstable();
            expected.dedup();
            assert_eq!(scratch.regions.len(), expected.len());
            for run in &scratch.runs {
                assert_eq!(expected[run.region as usize], run.groups, "in the order of the least spheres");
            }
        });
    }

    #[test]
    fn linear_force_laws_add_up(a in random_packing(100), b in random_packing(100), pose in random_pose(1.5)) {
        let (a, b) = (InnerSphereTree::new(&a), InnerSphereTree::new(&b));
        for law in [ForceLaw::VolumeGradient, ForceLaw::OutwardNormals] {
            let mut workspace = OverlapWorkspace::default();
            let query = OverlapQuery { law, ..OverlapQuery::default() };
            let whole = a.overlap_with(&b, &pose, query, &mut workspace);
            let (mut force, mut size) = (Vec3::ZERO, 0.0);
            with_lenses(&a, &b, &pose, &mut workspace, |cloud, scratch| {
                scratch.split(&cloud, [&a, &b]);
                scratch.measure(&cloud, law);
                force = scratch.regions.iter().map(|region| region.patch.force).sum();
                size = scratch.regions.iter().map(|region| region.patch.area + region.patch.volume).sum();
            });
            prop_assert!((force - whole.force).length() <= 1e-4 * size);
        }
    }

    #[test]
    fn a_body_between_two_walls_has_two_contacts(shift in -0.04_f32..0.04, angle in -3.0_f32..3.0, scale in -2..3) {
        let scale = 10.0_f32.powi(2 * scale);
        let (walls, body) = (walls(), tree_of(lattice(Vec3::splat(-0.45), Vec3::splat(0.45))));
        let pose = Pose3::from_parts(Vec3::X * shift * scale, Quat::from_rotation_x(angle));
        let patches = patches_of(&walls.scaled(scale).unwrap(), &body.scaled(scale).unwrap(), &pose);
        prop_assert_eq!(patches.len(), 2);
        // The deeper contact pushes harder.
        let away = -shift.signum() * Vec3::X;
        let directions = patches.iter().map(|p| p.force.normalize()).collect::<Vec<_>>();
        prop_assert!(shift.abs() < 5e-3 || (directions[0].dot(away) > 0.99 && directions[1].dot(away) < -0.99));
        prop_assert!(directions[0].dot(directions[1]) < -0.99);
        for patch in &patches {
            let spread = patch.points[0].distance(patch.points[1]);
            prop_assert!(spread > 0.5 * scale, "a manifold as wide as the wall");
        }
    }
}

#[test]
fn prongs_of_a_fork_on_a_plate_are_a_contact_each() {
    let plate = tree_of(lattice(Vec3::new(-1.0, -0.1, -0.5), Vec3::new(1.0, 0.0, 0.5)));
    let mut fork = lattice(Vec3::new(-0.9, 0.5, -0.1), Vec3::new(0.9, 0.7, 0.1));
    for prong in 0..3 {
        let x = 0.7 * prong as f32 - 0.8;
        fork.extend(lattice(Vec3::new(x, 0.0, -0.1), Vec3::new(x + 0.2, 0.5, 0.1)));
    }
    for sunk in [0.001, 0.03] {
        let patches = patches_of(&plate, &tree_of(fork.clone()), &Pose3::translation(0.0, -sunk, 0.0));
        assert_eq!(patches.len(), 3, "{sunk}");
        assert!(patches.iter().all(|p| p.force.normalize().y > 0.99), "{patches:?}");
    }
}

#[test]
fn one_ball_between_two_walls_has_two_contacts() {
    let ball = tree_of(vec![InnerSphere::solid_ball(Vec3::ZERO, 0.42, Vec3::X)]);
    let patches = patches_of(&walls(), &ball, &Pose3::IDENTITY);
    assert_eq!(patches.len(), 2);
    assert!(patches[0].force.normalize().dot(patches[1].force.normalize()) < -0.99);
}

#[test]
fn equal_bodies_in_the_same_place_have_one_contact() {
    let body = tree_of(lattice(Vec3::splat(-0.2), Vec3::splat(0.2)));
    let patches = patches_of(&body, &body, &Pose3::IDENTITY);
    assert_eq!(patches.len(), 1);
    assert!(patches[0].force.is_finite() && patches[0].points.iter().all(|p| p.is_finite()));
    let ball = tree_of(vec![InnerSphere::solid_ball(Vec3::ONE, 1.0, Vec3::Y)]);
    let patches = patches_of(&ball, &ball, &Pose3::IDENTITY);
    assert_eq!((patches.len(), patches[0].points), (1, [Vec3::ONE; 4]));
    let small = tree_of(vec![InnerSphere::solid_ball(Vec3::ONE, 1e-7, Vec3::Y)]);
    assert_eq!(patches_of(&ball, &small, &Pose3::IDENTITY).len(), 1);
}

#[test]
fn no_overlap_and_useless_poses_give_no_patch() {
    let ball = tree_of(vec![InnerSphere::solid_ball(Vec3::ZERO, 1.0, Vec3::Y)]);
    for pose in [
        Pose3::translation(3.0, 0.0, 0.0),
        Pose3::translation(f32::NAN, 0.0, 0.0),
        Pose3::translation(0.0, f32::INFINITY, 0.0),
        Pose3::from_rotation(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
    ] {
        assert!(patches_of(&ball, &ball, &pose).is_empty());
    }
}

#[test]
fn a_used_workspace_changes_nothing() {
    let (walls, body) = (walls(), tree_of(lattice(Vec3::splat(-0.45), Vec3::splat(0.45))));
    let mut workspace = OverlapWorkspace::default();
    let mut patches = Vec::new();
    for (a, b, shift) in
        [(&body, &walls, 0.3), (&walls, &body, 0.02), (&body, &body, 0.1), (&walls, &body, -0.01)]
    {
        let pose = Pose3::translation(shift, 0.0, 0.0);
        a.contact_patches(b, &pose, &mut workspace, &mut patches);
        assert_eq!(patches, patches_of(a, b, &pose));
    }
}
