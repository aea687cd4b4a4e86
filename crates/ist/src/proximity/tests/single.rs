//! Points, balls and rays against one tree.

use super::*;
use crate::reference;
use core::ops::ControlFlow;

/// The least and the greatest way along a unit direction to the first surface of a ball known to `rounding`: where the
/// line grazes, a little of the radius is much of the way.
fn ways_to_ball(
    [origin, unit]: [DVec3; 2],
    (center, radius): (Vec3, f32),
    rounding: f64,
    solid: bool,
) -> [f64; 2] {
    let from_origin = center.as_dvec3() - origin;
    let nearest = from_origin.dot(unit);
    let aside = from_origin - nearest * unit;
    let half_chord = |radius: f64| (radius * radius - aside.length_squared()).max(0.0).sqrt();
    let [small, large] = [-rounding, rounding].map(|change| (f64::from(radius) + change).max(0.0));
    if from_origin.length() > large {
        let way_in = |radius| {
            let meets = nearest > 0.0 && aside.length() <= radius;
            if meets { nearest - half_chord(radius) } else { f64::INFINITY }
        };
        [way_in(large) - rounding, way_in(small) + rounding]
    } else if from_origin.length() >= small {
        [0.0, f64::INFINITY]
    } else if solid {
        [0.0; 2]
    } else {
        [nearest + half_chord(small) - rounding, nearest + half_chord(large) + rounding]
    }
}

proptest! {
    #[test]
    fn the_nearest_sphere_is_that_of_a_plain_loop(
        tree in random_tree(500), point in prop::array::uniform3(-6.0_f32..6.0), kind in random_kind(),
    ) {
        let point = Vec3::from(point);
        let found = tree.nearest_sphere(point, kind).unwrap();
        let list = reference::balls(&tree, kind);
        let distance = |(center, radius): (Vec3, f32)| {
            point.as_dvec3().distance(center.as_dvec3()) - f64::from(radius)
        };
        let least = list.iter().map(|&ball| distance(ball)).fold(f64::INFINITY, f64::min);
        let rounding = 1e-5 * f64::from(tree.bounding_ball().1 + point.length());
        prop_assert!((f64::from(found.distance) - least).abs() <= rounding);
        prop_assert!((distance(list[found.sphere]) - least).abs() <= rounding);
        let (center, radius) = list[found.sphere];
        prop_assert!(found.point.distance(center + radius * found.normal) <= rounding as f32);
        prop_assert!((point - found.point).dot(found.normal) - found.distance <= rounding as f32);
        if least.abs() > rounding {
            prop_assert_eq!(tree.contains_point(point, kind), least < 0.0);
        }
    }

    #[test]
    fn a_ball_finds_the_spheres_of_a_plain_loop(
        tree in random_tree(500), center in prop::array::uniform3(-3.0_f32..3.0), radius in 0.0_f32..4.0,
        kind in random_kind(),
    ) {
        let center = Vec3::from(center);
        let mut found = Vec::new();
        let end = tree.visit_spheres_in_ball(center, radius, kind, |sphere| {
            found.push(sphere);
            ControlFlow::<()>::Continue(())
        });
        prop_assert!(end.is_continue());
        prop_assert_eq!(tree.meets_ball(center, radius, kind), !found.is_empty());
        let order = found.clone();
        found.sort_unstable();
        let count = found.len();
        found.dedup();
        prop_assert_eq!(found.len(), count, "each once");
        for (sphere, (c, r)) in reference::balls(&tree, kind).into_iter().enumerate() {
            let gap = center.distance(c) - r - radius;
            if gap.abs() > 1e-5 * (tree.bounding_ball().1 + radius) {
                prop_assert_eq!(found.binary_search(&sphere).is_ok(), gap < 0.0);
            }
        }
        // A visitor that breaks sees the beginning.
        let mut first = None;
        let end = tree.visit_spheres_in_ball(center, radius, kind, |sphere| {
            first = Some(sphere);
            ControlFlow::Break(sphere)
        });
        prop_assert_eq!(first, order.first().copied());
        prop_assert_eq!(end.is_break(), first.is_some());
    }

    #[test]
    fn a_ray_hits_what_a_plain_loop_hits(
        tree in random_tree(500), origin in prop::array::uniform3(-4.0_f32..4.0),
        aim in prop::array::uniform3(-1.0_f32..1.0), length in 0.125_f32..5.0, max_time in 0.0_f32..8.0,
        solid in any::<bool>(), kind in random_kind(),
    ) {
        let (origin, aim) = (Vec3::from(origin), Vec3::from(aim) * tree.scale());
        let Some(unit) = (aim - origin).try_normalize() else { return Ok(()) };
        let ray = Ray { origin, direction: unit * length, max_time };
        let hit = tree.cast_ray(&ray, solid, kind);
        let list = reference::balls(&tree, kind);
        let rounding = 1e-6 * (origin.length() + tree.bounding_ball().0.length() + tree.bounding_ball().1);
        let exact = [origin.as_dvec3(), ray.direction.as_dvec3().normalize()];
        let [least, greatest] = list
            .iter()
            .map(|&ball| ways_to_ball(exact, ball, rounding.into(), solid))
            .fold([f64::INFINITY; 2], |[a, b], [c, d]| [a.min(c), b.min(d)]);
        if let Some(hit) = hit {
            let way = f64::from(hit.time) * ray.direction.as_dvec3().length();
            prop_assert!(least <= way && way <= greatest, "{least} {way} {greatest}");
            prop_assert!(hit.time <= max_time);
            prop_assert!((hit.normal.length() - 1.0).abs() < 1e-5);
            prop_assert!(hit.point.distance(origin + hit.time * ray.direction) <= rounding);
            let (center, radius) = list[hit.sphere];
            let outside = hit.point.distance(center) - radius;
            prop_assert!(outside.abs() <= rounding || (solid && hit.time == 0.0 && outside < 0.0));
            if hit.time > 0.0 {
                prop_assert!(hit.normal.dot(unit) <= (2.0 * rounding / radius).sqrt(), "faces the ray");
            }
        } else {
            let end = f64::from(max_time) * ray.direction.as_dvec3().length();
            prop_assert!(greatest > end, "{greatest} {end}");
        }
    }
}

#[test]
fn inside_of_a_ball_rays_begin_or_leave() {
    let tree = balls(&[(Vec3::ZERO, 1.0), (3.0 * Vec3::X, 1.0)]);
    let ray = Ray { origin: 0.5 * Vec3::X, direction: 2.0 * Vec3::X, max_time: f32::INFINITY };
    let solid = tree.cast_ray(&ray, true, BallKind::Inner).unwrap();
    assert_eq!((solid.time, solid.sphere, solid.point), (0.0, 0, ray.origin));
    let hollow = tree.cast_ray(&ray, false, BallKind::Inner).unwrap();
    assert_eq!((hollow.time, hollow.sphere, hollow.normal), (0.25, 0, Vec3::NEG_X));
    let next = tree.cast_ray(&Ray { origin: 1.5 * Vec3::X, ..ray }, true, BallKind::Inner).unwrap();
    assert_eq!((next.time, next.sphere, next.normal), (0.25, 1, Vec3::NEG_X));
    assert_eq!(tree.cast_ray(&Ray { direction: Vec3::Y, ..ray }, true, BallKind::Inner).unwrap().time, 0.0);
    assert!(tree.cast_ray(&Ray { origin: 9.0 * Vec3::X, ..ray }, true, BallKind::Inner).is_none());
}

#[test]
fn the_skin_belongs_to_volume_balls_only() {
    let tree = ball(1.0).with_skin(0.5).unwrap();
    let point = 1.2 * Vec3::X;
    assert!(tree.contains_point(point, BallKind::Volume) && !tree.contains_point(point, BallKind::Inner));
    assert!((tree.nearest_sphere(point, BallKind::Volume).unwrap().distance + 0.3).abs() < 1e-6);
    let ray = Ray { origin: 5.0 * Vec3::X, direction: Vec3::NEG_X, max_time: 10.0 };
    let time = |kind| tree.cast_ray(&ray, true, kind).unwrap().time;
    assert!((time(BallKind::Volume) - 3.5).abs() < 1e-6 && (time(BallKind::Inner) - 4.0).abs() < 1e-6);
}
