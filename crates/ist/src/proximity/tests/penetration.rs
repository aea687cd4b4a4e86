//! Penetration depth.

use super::*;
use crate::{OverlapWorkspace, reference};

fn translated(pose: &Pose3, translation: Vec3) -> Pose3 {
    Pose3::from_parts(pose.translation + translation, pose.rotation)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn the_translation_separates(a in random_tree(120), b in random_tree(120), pose in random_pose(3.0)) {
        let mut workspace = ProximityWorkspace::default();
        let found = a.penetration(&b, &pose, &mut workspace).unwrap();
        let moved = translated(&pose, found.translation);
        let gap = reference::distance(&a, &b, &moved, BallKind::Volume).gap;
        prop_assert!(gap > 0.0, "{gap}");
        prop_assert_eq!(a.overlap(&b, &moved, &mut OverlapWorkspace::default()).pairs, 0);
        prop_assert_eq!(found.depth, found.translation.length());
        prop_assert!(found.lower_bound <= found.depth);
        let deepest = -reference::distance(&a, &b, &pose, BallKind::Volume).gap;
        prop_assert!(f64::from(found.lower_bound) <= deepest.max(0.0));
        // Locally the shortest: a little less of it does not separate.
        if found.depth > 0.0 {
            let less = translated(&pose, found.translation * 0.99);
            let shorter = reference::distance(&a, &b, &less, BallKind::Volume).gap;
            prop_assert!(shorter < 1e-3 * f64::from(extent(&a, &b, &pose)), "{shorter} of {}", found.depth);
        }
    }

    #[test]
    fn two_balls_are_exact(
        radii in prop::array::uniform2(0.125_f32..2.0), at in prop::array::uniform3(-1.0_f32..1.0),
        skin in 0.0_f32..0.2,
    ) {
        let (a, b) = (ball(radii[0]).with_skin(skin).unwrap(), ball(radii[1]));
        let pose = Pose3::from_translation(at.into());
        let found = a.penetration(&b, &pose, &mut Default::default()).unwrap();
        let exact = (radii[0] + radii[1] + skin - Vec3::from(at).length()).max(0.0);
        let rounding = 3e-5 * extent(&a, &b, &pose);
        prop_assert!((found.depth - exact).abs() <= rounding, "{} {exact}", found.depth);
        prop_assert!((found.lower_bound - exact).abs() <= rounding);
        prop_assert!(found.translation.distance(Vec3::from(at).normalize_or_zero() * found.depth) <= 3e-2 * found.depth);
    }
}

#[test]
fn slabs_part_the_short_way() {
    let slab: Vec<_> = (0..100).map(|i| (Vec3::new((i % 10) as f32, (i / 10) as f32, 0.0), 0.6)).collect();
    let (a, b) = (balls(&slab), balls(&slab));
    let pose = Pose3::translation(0.5, 0.5, 0.3);
    let found = a.penetration(&b, &pose, &mut Default::default()).unwrap();
    // Balls of the one sit in the hollows of the other: (½, ½, z) at distance 1.2, so z² = 1.44 − ½.
    let exact = 0.94_f32.sqrt() - 0.3;
    assert!(found.depth <= exact + 1e-3, "{} {exact}", found.depth);
    assert!(found.translation.z > 0.0);
}

#[test]
fn concentric_and_separate_bodies() {
    let mut workspace = ProximityWorkspace::default();
    let concentric = ball(1.0).penetration(&ball(0.5), &Pose3::IDENTITY, &mut workspace).unwrap();
    assert!((concentric.depth - 1.5).abs() < 1e-4 && (concentric.lower_bound - 1.5).abs() < 1e-4);
    let apart =
        ball(1.0).penetration(&ball(0.5), &Pose3::translation(2.0, 0.0, 0.0), &mut workspace).unwrap();
    assert_eq!(apart, Penetration::default());
}
