//! The cache gives what a query without it gives.

use super::tests::{random_pose, tree};
use super::*;
use crate::tree::tests::random_packing;
use glam::Quat;
use proptest::prelude::*;

proptest! {
    #[test]
    fn a_path_gives_the_same_with_and_without(
        a in random_packing(400), b in random_packing(400), start in random_pose(0.8),
        velocity in prop::array::uniform6(-1.0_f32..1.0), speed in 0..5, skin in 0.0_f32..0.05,
    ) {
        let (a, mut b) = (tree(&a).with_skin(skin).unwrap(), tree(&b));
        let step = [0.0, 1e-6, 1e-3, 1e-2, 0.1][speed as usize];
        let [x, y, z, u, v, w] = velocity.map(|v| v * step);
        let (turn, shift) = (Quat::from_scaled_axis(Vec3::new(u, v, w)), Vec3::new(x, y, z));
        let (mut cache, mut workspace) = (OverlapCache::default(), OverlapWorkspace::default());
        let mut pose = start;
        for i in 0..40 {
            let query = OverlapQuery { stiffness: i % 2 == 0, ..OverlapQuery::default() };
            let cached = a.overlap_cached(&b, &pose, query, (&mut cache, &mut workspace));
            let plain = a.overlap_with(&b, &pose, query, &mut workspace);
            prop_assert_eq!(cached.pairs, plain.pairs);
            prop_assert_eq!(cached.intersects, plain.intersects);
            prop_assert_eq!(cached.deepest.map(|d| d.depth), plain.deepest.map(|d| d.depth));
            prop_assert!((cached.volume - plain.volume).abs() <= 1e-5 * plain.volume);
            let scale = 1e-5 * (plain.gradient.length() + 0.1 * plain.pairs as f32);
            prop_assert!(cached.gradient.distance(plain.gradient) <= scale);
            prop_assert!(cached.rotation_gradient.distance(plain.rotation_gradient) <= 3.0 * scale);
            prop_assert!(cached.centroid.distance(plain.centroid) <= 1e-5);
            pose = Pose3::from_parts(pose.translation + shift, turn * pose.rotation);
            match i {
                20 => b = b.scaled(1.01).unwrap(),
                30 => pose.translation += Vec3::X * 0.3,
                _ => {}
            }
        }
        if step < 1e-3 {
            prop_assert!(cache.walks() < 16, "{}", cache.walks());
        }
    }
}

#[test]
fn another_solid_makes_another_list() {
    let ball = |radius: f32| {
        let spheres = (0..20)
            .map(|i| crate::InnerSphere::solid_ball(Vec3::X * i as f32 * 2.0 * radius, radius, Vec3::Y))
            .collect();
        tree(&crate::SpherePacking::new(spheres, crate::SolidProperties::ball(1.0)).unwrap())
    };
    let (mut cache, mut workspace) = (OverlapCache::default(), OverlapWorkspace::default());
    let pose = Pose3::translation(0.05, 0.05, 0.0);
    for radius in [0.1, 0.1, 0.2, 0.2, 0.2, 0.1] {
        // A new tree every time, maybe at the address of the last.
        let (a, b) = (ball(radius), ball(0.1));
        let plain = a.overlap(&b, &pose, &mut workspace);
        let caches = (&mut cache, &mut workspace);
        let cached = a.overlap_cached(&b, &pose, OverlapQuery::default(), caches);
        assert_eq!((cached.pairs, cached.volume), (plain.pairs, plain.volume), "{radius}");
    }
}
