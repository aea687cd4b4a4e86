//! Queries of the shape itself: points, rays, features, scales.

use crate::{BALLS, poses, solid};
use packer::{PackOptions, Solid, pack};
use rapier_ist::IstShape;
use rapier_ist_examples::shapes;
use rapier3d::glamx::DVec3;
use rapier3d::math::{Pose, Rotation, Vector};
use rapier3d::parry::query::{PointQuery, Ray, RayCast};
use rapier3d::parry::shape::{FeatureId, Shape, SharedShape};

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

#[test]
fn boxes_hold_all_balls_and_touch_them_at_any_pose() {
    let (tree, _) = solid(&BALLS);
    for (step, pose) in poses().iter().enumerate() {
        let bounds = tree.compute_aabb(pose);
        let ends = |balls: &mut dyn Iterator<Item = (Vector, f32)>| {
            balls.fold((Vector::INFINITY, Vector::NEG_INFINITY), |(mins, maxs), (center, radius)| {
                let center = *pose * center;
                (mins.min(center - Vector::splat(radius)), maxs.max(center + Vector::splat(radius)))
            })
        };
        let (mins, maxs) = ends(&mut tree.tree().volume_balls());
        let slack = Vector::splat(1e-5 * (1.0 + pose.translation.length()));
        assert!((bounds.mins - slack).cmple(mins).all() && (bounds.maxs + slack).cmpge(maxs).all(), "{step}");
        if pose.rotation.angle_between(Rotation::IDENTITY) == 0.0 {
            assert!(bounds.mins.distance(mins) < 1e-5 && bounds.maxs.distance(maxs) < 1e-5, "{step}");
        }
        let sphere = tree.compute_bounding_sphere(pose);
        for (center, radius) in tree.tree().volume_balls() {
            let reach = (*pose * center).distance(sphere.center) + radius;
            assert!(reach <= sphere.radius * (1.0 + 1e-5) + slack.x, "{step}");
        }
        let end = Pose::from_parts(pose.translation + Vector::new(1.0, -2.0, 0.5), pose.rotation);
        let swept = tree.compute_swept_aabb(pose, &end);
        for bounds in [bounds, tree.compute_aabb(&end)] {
            assert!(
                (swept.mins - slack).cmple(bounds.mins).all()
                    && (swept.maxs + slack).cmpge(bounds.maxs).all()
            );
        }
    }
}

#[test]
fn a_copy_answers_as_the_original() {
    let (tree, _) = solid(&BALLS);
    let copy = tree.clone_dyn();
    assert!(copy.as_shape::<IstShape>().is_some());
    assert_eq!(copy.compute_local_aabb(), tree.compute_local_aabb());
    for point in points() {
        let [ours, theirs] = [copy.as_ref(), &tree].map(|shape| shape.project_local_point(point, true));
        assert_eq!((ours.is_inside, ours.point), (theirs.is_inside, theirs.point));
    }
}

#[test]
fn a_packed_box_weighs_what_a_box_weighs_at_any_scale() {
    let half = DVec3::new(0.2, 0.3, 0.5);
    let mut mesh = shapes::cuboid(half);
    let offset = DVec3::new(0.1, -0.2, 0.3);
    mesh.vertices.iter_mut().for_each(|vertex| *vertex += offset);
    let solid = Solid::new(&mesh).unwrap();
    let packing = pack(&solid, &PackOptions::fast().spheres(20)).unwrap().packing;
    let tree = IstShape::from_packing(&packing);
    for scale in [0.01_f32, 1.0, 7.0] {
        let scaled = tree.scale_dyn(Vector::splat(scale), 0).unwrap();
        let ours = scaled.mass_properties(2000.0);
        let exact = SharedShape::cuboid(0.2 * scale, 0.3 * scale, 0.5 * scale).mass_properties(2000.0);
        assert!((ours.mass() / exact.mass() - 1.0).abs() < 1e-5, "{scale}");
        assert!(ours.local_com.distance(offset.as_vec3() * scale) < 1e-5 * scale);
        let (mut inertia, mut expected) =
            (ours.principal_inertia().to_array(), exact.principal_inertia().to_array());
        inertia.sort_by(f32::total_cmp);
        expected.sort_by(f32::total_cmp);
        for (a, b) in inertia.into_iter().zip(expected) {
            assert!((a / b - 1.0).abs() < 1e-4, "{scale}: {a} {b}");
        }
    }
    let massless = tree.mass_properties(0.0);
    assert_eq!((massless.mass(), massless.inv_mass), (0.0, 0.0));
}

#[test]
fn features_name_spheres_by_their_index_in_the_packing() {
    let (tree, _) = solid(&BALLS);
    for (index, (center, radius)) in BALLS.iter().enumerate() {
        let out = (*center - Vector::new(0.15, 0.1, -0.1)).normalize();
        let ray = Ray::new(*center + out * 5.0, -out);
        let hit = tree.cast_local_ray_and_get_normal(&ray, 10.0, true).unwrap();
        let at = ray.point_at(hit.time_of_impact);
        if (at.distance(*center) - radius).abs() < 1e-4 {
            assert_eq!(hit.feature, FeatureId::Face(index as u32));
            let normal = tree.feature_normal_at_point(0, hit.feature, at).unwrap();
            assert!(normal.distance(hit.normal) < 1e-4);
        }
        let (_, feature) = tree.project_local_point_and_get_feature(*center);
        assert_eq!(feature, FeatureId::Face(index as u32));
    }
    assert_eq!(tree.feature_normal_at_point(0, FeatureId::Vertex(0), Vector::ZERO), None);
}
