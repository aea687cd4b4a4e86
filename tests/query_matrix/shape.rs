//! Queries of the shape itself: points, rays, features, scales.

use crate::{BALLS, solid};
use rapier3d::math::Vector;
use rapier3d::parry::query::{PointQuery, Ray, RayCast};
use rapier3d::parry::shape::{FeatureId, Shape};

fn points() -> impl Iterator<Item = Vector> {
    (0..500).map(|i| Vector::new((i as f32 * 0.7).sin(), (i as f32 * 1.3).cos(), (i as f32 * 2.1).sin()))
}

#[test]
fn points_are_projected_as_on_a_compound_of_the_balls() {
    let (tree, compound) = solid(&BALLS);
    for point in points() {
        for solid in [true, false] {
            let [ours, parry] =
                [tree.project_local_point(point, solid), compound.project_local_point(point, solid)];
            assert_eq!(ours.is_inside, parry.is_inside, "{point}");
            assert!((ours.point.distance(point) - parry.point.distance(point)).abs() < 1e-5, "{point}");
        }
        assert_eq!(tree.contains_local_point(point), compound.contains_local_point(point), "{point}");
        let (projection, feature) = tree.project_local_point_and_get_feature(point);
        let FeatureId::Face(sphere) = feature else { panic!("{feature:?}") };
        let (center, radius) = BALLS[sphere as usize];
        assert!((projection.point.distance(center) - radius).abs() < 1e-5, "{point}");
        let normal = tree.feature_normal_at_point(0, feature, projection.point).unwrap();
        assert!(normal.distance((projection.point - center) / radius) < 1e-4, "{point}");
    }
    assert!(!tree.project_local_point(Vector::NAN, true).is_inside);
    assert_eq!(tree.feature_normal_at_point(0, FeatureId::Face(99), Vector::ZERO), None);
}

#[test]
fn rays_hit_as_on_a_compound_of_the_balls() {
    let (tree, compound) = solid(&BALLS);
    let mut hits = 0;
    for (i, point) in points().enumerate() {
        let towards = Vector::new(0.2, 0.1, -0.1) - point;
        for solid in [true, false] {
            let ray = Ray::new(point * (1.0 + (i % 3) as f32), towards);
            let ours = tree.cast_local_ray_and_get_normal(&ray, 10.0, solid);
            let parry = compound.cast_local_ray_and_get_normal(&ray, 10.0, solid);
            assert_eq!(ours.is_some(), parry.is_some(), "{ray:?}");
            let (Some(ours), Some(parry)) = (ours, parry) else { continue };
            hits += 1;
            assert!((ours.time_of_impact - parry.time_of_impact).abs() < 1e-4, "{ours:?} {parry:?}");
            if ours.time_of_impact > 0.0 {
                assert!(ours.normal.distance(parry.normal) < 1e-2, "{ours:?} {parry:?}");
            }
        }
    }
    assert!(hits > 300, "{hits}");
}

#[test]
fn only_positive_uniform_scales_are_taken() {
    let (tree, _) = solid(&BALLS);
    for bad in [-1.0, 0.0, f32::NAN, f32::INFINITY] {
        assert!(tree.scale_dyn(Vector::splat(bad), 0).is_none(), "{bad}");
    }
    assert!(tree.scale_dyn(Vector::new(1.0, 1.0, 2.0), 0).is_none());
    let twice = tree.scale_dyn(Vector::splat(2.0), 0).unwrap();
    let (before, after) = (tree.compute_local_aabb(), twice.compute_local_aabb());
    assert!(after.extents().distance(2.0 * before.extents()) < 1e-5);
}
