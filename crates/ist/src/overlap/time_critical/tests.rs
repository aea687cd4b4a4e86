//! Properties of queries within a budget, against the full query and [`crate::reference`].

use super::*;
use crate::tree::tests::random_packing;
use crate::{InnerSphere, OverlapWorkspace, SolidProperties, SpherePacking, reference};
use alloc::vec::Vec;
use glam::{Quat, Vec3};
use proptest::prelude::*;

fn random_pose(reach: f32) -> impl Strategy<Value = Pose3> {
    (prop::array::uniform3(-reach..reach), prop::array::uniform3(-3.0_f32..3.0))
        .prop_map(|(t, r)| Pose3::from_parts(t.into(), Quat::from_scaled_axis(r.into())))
}

/// Touching and nearly disjoint balls in a lattice, as a packing has.
fn lattice(side: i32, spacing: f32, origin: Vec3) -> InnerSphereTree {
    let mut spheres = Vec::new();
    for x in 0..side {
        for y in 0..side {
            for z in 0..side {
                let center = origin + spacing * Vec3::new(x as f32, y as f32, z as f32);
                let mut sphere = InnerSphere::solid_ball(center, 0.5 * spacing, Vec3::Y);
                sphere.cell_volume = spacing * spacing * spacing;
                spheres.push(sphere);
            }
        }
    }
    tree(spheres)
}

fn tree(spheres: Vec<InnerSphere>) -> InnerSphereTree {
    InnerSphereTree::new(&SpherePacking::new(spheres, SolidProperties::ball(1.0)).unwrap())
}

fn balls(count: usize, radius: f32) -> InnerSphereTree {
    tree(alloc::vec![InnerSphere::solid_ball(Vec3::ZERO, radius, Vec3::X); count])
}

/// Checks every promise for growing budgets, and gives the complete result.
fn check(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> OverlapEstimate {
    let full = a.overlap(b, pose, &mut OverlapWorkspace::default());
    let exact = reference::overlap(a, b, pose);
    let reach = |tree: &InnerSphereTree| tree.bounding_ball().0.length() + tree.bounding_ball().1;
    let reach = reach(a) + reach(b);
    // What rounding the centres to f32 moves.
    let slack = 1e-5 * exact.volume + 5e-7 * f64::from(reach) * exact.area;
    let exact = exact.volume;
    let mut workspace = TimeCriticalWorkspace::default();
    let mut last = OverlapEstimate { upper: f32::INFINITY, ..OverlapEstimate::default() };
    for budget in (0..32).map(|i| if i == 0 { 0 } else { 1_u32 << (i - 1) }) {
        let result = a.overlap_within(b, pose, Budget::Visits(budget), &mut workspace);
        assert!(result.lower <= full.volume && full.volume <= result.upper, "{full:?} {result:?}");
        assert!(result.expected.volume >= result.lower && result.expected.volume <= result.upper);
        assert!(result.lower >= last.lower && result.upper <= last.upper, "{last:?} {result:?}");
        assert!(f64::from(result.lower) <= exact + slack && exact <= f64::from(result.upper) + slack);
        let o = &result.expected;
        assert!(o.force.is_finite() && o.torque.is_finite() && o.centroid.is_finite(), "{o:?} {full:?}");
        assert!(o.gradient.is_finite() && o.rotation_gradient.is_finite());
        assert!(o.force.as_dvec3().length() <= 1.001 * f64::from(o.volume), "{o:?} {full:?}");
        assert!(!o.intersects || full.intersects);
        assert!(o.stiffness.is_none() && (o.volume > 0.0 || o.deepest.is_none()));
        let depth = |overlap: &Overlap| overlap.deepest.map_or(0.0, |pair| pair.depth);
        assert!(depth(o) <= depth(&full) && depth(o) >= depth(&last.expected), "{o:?} {full:?}");
        assert!(o.pairs > 0 || o.deepest.is_none());
        assert!(result.visits <= budget && result.visits >= last.visits);
        assert_eq!(result, a.overlap_within(b, pose, Budget::Visits(budget), &mut workspace.clone()));
        last = result;
        if result.complete {
            break;
        }
    }
    assert!(last.complete);
    assert_eq!((last.expected.pairs, last.expected.intersects), (full.pairs, full.intersects));
    let depth = |overlap: &Overlap| overlap.deepest.map(|pair| pair.depth);
    assert_eq!(depth(&last.expected), depth(&full));
    let volume = full.volume;
    assert!((last.expected.volume - volume).abs() <= 1e-5 * volume);
    assert!(last.upper - last.lower <= 3e-5 * volume);
    assert!((last.expected.centroid - full.centroid).length() <= 1e-4 * reach);
    assert!((last.expected.gradient - full.gradient).length() <= 1e-4 * full.gradient.length().max(volume));
    last
}

proptest! {
    #[test]
    fn the_interval_contains_the_volume_and_shrinks(
        a in random_packing(300), b in random_packing(300), pose in random_pose(1.5),
        scale in prop::array::uniform2(0.2_f32..5.0), skin in prop::array::uniform2(-0.1_f32..0.1),
    ) {
        let solid = |packing, i: usize| {
            let tree = InnerSphereTree::new(packing).scaled(scale[i]).unwrap();
            tree.with_skin(skin[i].max(0.0)).unwrap()
        };
        check(&solid(&a, 0), &solid(&b, 1), &pose);
    }

    #[test]
    fn it_does_so_for_packings_without_much_overlap(
        sides in prop::array::uniform2(1_i32..9), sizes in prop::array::uniform2(0.5_f32..2.0), pose in random_pose(1.5),
        skin in -0.02_f32..0.02,
    ) {
        let solid = |i: usize| lattice(sides[i], sizes[i] / sides[i] as f32, Vec3::splat(-0.5 * sizes[i]));
        check(&solid(0).with_skin(skin.max(0.0)).unwrap(), &solid(1), &pose);
    }

    #[test]
    fn it_does_so_at_any_scale(a in random_packing(100), b in random_packing(100), pose in random_pose(1.0), power in -4_i32..=4) {
        let scale = 10.0_f32.powi(power);
        let solid = |packing| InnerSphereTree::new(packing).scaled(scale).unwrap();
        check(&solid(&a), &solid(&b), &Pose3::from_parts(pose.translation * scale, pose.rotation));
    }

    #[test]
    fn it_does_so_for_solids_of_very_different_size(
        a in random_packing(100), b in random_packing(100), pose in random_pose(1.0), power in 1_i32..=7,
    ) {
        let scale = 10.0_f32.powi(-power);
        let (a, b) = (InnerSphereTree::new(&a), InnerSphereTree::new(&b).scaled(scale).unwrap());
        check(&a, &b, &pose);
        check(&b, &a, &pose.inverse());
    }

    #[test]
    fn swapping_the_solids_gives_the_same_result(a in random_packing(200), b in random_packing(200), pose in random_pose(1.0)) {
        let (a, b) = (InnerSphereTree::new(&a), InnerSphereTree::new(&b));
        let mut workspace = TimeCriticalWorkspace::default();
        for budget in [0, 10, 100, u32::MAX] {
            let ab = a.overlap_within(&b, &pose, Budget::Visits(budget), &mut workspace);
            let ba = b.overlap_within(&a, &pose.inverse(), Budget::Visits(budget), &mut workspace);
            // Rounding differs between the two frames.
            let slack = 1e-4 * ab.expected.volume.max(1e-3);
            prop_assert!(ab.lower <= ba.upper + slack && ba.lower <= ab.upper + slack);
            if ab.complete && ba.complete {
                prop_assert!((ab.expected.volume - ba.expected.volume).abs() <= slack);
                let size = ab.expected.force.length() + 0.02 * ab.expected.volume.max(1e-3);
                prop_assert!((ab.expected.force + pose.rotation * ba.expected.force).length() <= 3e-3 * size);
            }
        }
    }
}

#[test]
fn single_spheres_need_no_visits() {
    for distance in [0.0, 0.3, 1.2, 1.5, 7.0] {
        let result = check(&balls(1, 1.0), &balls(1, 0.5), &Pose3::translation(0.0, distance, 0.0));
        assert_eq!(result.visits, 0);
    }
}

#[test]
fn a_single_sphere_against_many() {
    let many = lattice(7, 0.2, Vec3::splat(-0.6));
    for distance in [0.0, 0.4, 1.0, 1.4] {
        for radius in [0.01, 0.3, 2.0] {
            let pose = Pose3::translation(distance, 0.1, 0.0);
            check(&balls(1, radius), &many, &pose);
            check(&many, &balls(1, radius), &pose);
        }
    }
}

#[test]
fn a_tree_inside_one_sphere_of_the_other_is_known_at_once() {
    let many = lattice(7, 0.01, Vec3::ZERO);
    let result = many.overlap_within(
        &balls(1, 1.0),
        &Pose3::IDENTITY,
        Budget::Visits(0),
        &mut TimeCriticalWorkspace::default(),
    );
    let volume: f32 = many.volume_balls().map(|(_, r)| 4.0 / 3.0 * core::f32::consts::PI * r * r * r).sum();
    assert!(!result.complete);
    assert!(
        (result.upper - result.lower) < 1e-4 * volume && (result.expected.volume / volume - 1.0).abs() < 1e-4
    );
}

#[test]
fn equal_spheres_and_coincident_trees() {
    for count in [2, 8, 9, 70, 100] {
        check(&balls(count, 1.0), &balls(count + 3, 1.0), &Pose3::IDENTITY);
        check(&balls(count, 1.0), &balls(count, 0.5), &Pose3::translation(0.9, 0.0, 0.0));
    }
    let solid = lattice(6, 0.1, Vec3::ZERO);
    check(&solid, &solid, &Pose3::IDENTITY);
    check(&solid, &solid.scaled(0.5).unwrap(), &Pose3::translation(0.1, 0.1, 0.1));
    check(&solid, &solid.scaled(3.0).unwrap().with_skin(0.01).unwrap(), &Pose3::IDENTITY);
}

#[test]
fn more_pairs_than_the_memory_holds() {
    // More than a million pairs of blocks.
    let (a, b) = (balls(9000, 1.0), balls(9000, 0.9));
    let pose = Pose3::translation(0.5, 0.0, 0.0);
    let mut workspace = TimeCriticalWorkspace::default();
    let few = a.overlap_within(&b, &pose, Budget::Visits(1000), &mut workspace);
    let all = a.overlap_within(&b, &pose, Budget::Visits(u32::MAX), &mut workspace);
    let full = a.overlap(&b, &pose, &mut OverlapWorkspace::default());
    assert!(all.complete && all.expected.pairs == full.pairs);
    for result in [few, all] {
        assert!(result.lower <= full.volume && full.volume <= result.upper);
    }
}

#[test]
fn a_tiny_packing_far_from_its_origin() {
    let solid = lattice(5, 1e-7, Vec3::new(1.0, 0.5, 0.25));
    check(&lattice(5, 0.5, Vec3::splat(-0.5)), &solid, &Pose3::IDENTITY);
    check(&solid, &lattice(5, 0.5, Vec3::splat(-0.5)), &Pose3::IDENTITY);
    check(&solid, &solid, &Pose3::translation(1e-7, 0.0, 0.0));
    check(&solid, &solid, &Pose3::from_rotation(Quat::from_rotation_y(1e-7)));
}

#[test]
fn issue_a_sphere_whose_volume_vanishes_in_its_packing_is_bounded() {
    let [small, far] = [(Vec3::ZERO, 1e-4), (Vec3::X * 1e15, 1.0)];
    let sphere = |(center, radius)| InnerSphere::solid_ball(center, radius, Vec3::Y);
    let (a, b) = (balls(1, 1.0), tree(alloc::vec![sphere(small), sphere(far)]));
    check(&a, &b, &Pose3::IDENTITY);
}

#[test]
fn useless_poses_give_no_overlap() {
    let solid = balls(1, 1.0);
    for pose in [
        Pose3::translation(f32::NAN, 0.0, 0.0),
        Pose3::translation(f32::INFINITY, 0.0, 0.0),
        Pose3::from_rotation(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
    ] {
        let mut workspace = TimeCriticalWorkspace::default();
        let result = solid.overlap_within(&solid, &pose, Budget::Visits(9), &mut workspace);
        assert_eq!(result, OverlapEstimate { complete: true, ..OverlapEstimate::default() });
    }
}

/// Checks that a query stops in time, by a clock that counts its work, and never knows less for more time.
fn check_time(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3, most_late: u64) {
    let mut workspace = TimeCriticalWorkspace::default();
    let mut all = Meter::new(Budget::Visits(u32::MAX));
    let full = a.overlap_metered(b, pose, &mut all, &mut workspace);
    // Eight pairs of spheres are at least a unit, and eight nodes of A in a list are that and more.
    assert!(all.done() >= u64::from(full.expected.pairs / 8 + full.visits / 8));
    let mut last = OverlapEstimate { upper: f32::INFINITY, ..OverlapEstimate::default() };
    for i in 0..200 {
        let time = all.done() * i / 199 * 6 / 5;
        let mut meter = Meter::of_work(core::time::Duration::from_nanos(time));
        let result = a.overlap_metered(b, pose, &mut meter, &mut workspace);
        let late = meter.done().saturating_sub(time - time / u64::from(budget::RESERVE));
        assert!(late <= most_late, "{late} units after the time, {time} of {} in all", all.done());
        assert!(result.lower <= full.expected.volume && full.expected.volume <= result.upper);
        assert!(result.lower >= last.lower && result.upper <= last.upper);
        last = result;
    }
    assert!(last.complete);
}

#[test]
fn it_stops_in_time() {
    // The leaves below 32 nodes of A with eight of B's, the pairs that are found, and a batch of lenses.
    let at_most = |pairs: u64| 8 + 32 * 8 + pairs + 256;
    let most = at_most(8 * 27);
    let solid = lattice(14, 0.1, Vec3::ZERO);
    for shift in [0.0, 0.3, 0.9] {
        let pose = Pose3::from_parts(Vec3::new(shift, 0.13, 0.04), Quat::from_rotation_x(0.3));
        check_time(&solid, &solid, &pose, most);
        check_time(&solid, &lattice(9, 0.02, Vec3::ZERO), &pose, most);
        check_time(&lattice(9, 0.02, Vec3::ZERO), &solid, &pose.inverse(), most);
    }
    // Where all spheres are on top of each other a row has 32 · 8 · 8 pairs.
    check_time(&balls(300, 1.0), &balls(500, 0.9), &Pose3::translation(0.5, 0.0, 0.0), at_most(32 * 8 * 8));
}

#[test]
fn any_time_will_do() {
    let solid = lattice(12, 0.1, Vec3::ZERO);
    let pose = Pose3::translation(0.21, 0.33, 0.4);
    let full = solid.overlap(&solid, &pose, &mut OverlapWorkspace::default());
    let mut workspace = TimeCriticalWorkspace::default();
    for nanoseconds in [0, 1, 1_000, 100_000, u64::MAX] {
        let budget = Budget::Time(core::time::Duration::from_nanos(nanoseconds));
        let result = solid.overlap_within(&solid, &pose, budget, &mut workspace);
        assert!(result.lower <= full.volume && full.volume <= result.upper);
        assert!(result.complete || nanoseconds < u64::MAX);
    }
    let endless = Budget::Time(core::time::Duration::MAX);
    assert!(solid.overlap_within(&solid, &pose, endless, &mut workspace).complete);
}

#[test]
fn preparing_once_prepares_every_copy() {
    let solid = lattice(4, 0.1, Vec3::ZERO);
    let copy = solid.scaled(2.0).unwrap().with_skin(0.01).unwrap();
    assert!(!solid.data().has_sums());
    copy.prepare_overlap_within();
    assert!(solid.data().has_sums());
    // A tree of its own is prepared by its first query.
    let (fresh, pose) = (lattice(4, 0.1, Vec3::ZERO), Pose3::translation(0.1, 0.2, 0.0));
    let mut workspace = TimeCriticalWorkspace::default();
    let unprepared = fresh.overlap_within(&fresh, &pose, Budget::Visits(20), &mut workspace);
    assert_eq!(unprepared, solid.overlap_within(&solid, &pose, Budget::Visits(20), &mut workspace));
    assert!(fresh.data().has_sums());
}

#[test]
fn the_full_query_prepares_nothing() {
    let solid = lattice(4, 0.1, Vec3::ZERO);
    let overlap = solid.overlap(&solid, &Pose3::IDENTITY, &mut OverlapWorkspace::default());
    assert!(overlap.volume > 0.0 && !solid.data().has_sums());
}
