//! Queries of one tree: points, balls, rays, half-spaces and surfaces.

use crate::fuzzing::numbers::{any_float, any_vector, below, moderate, moderate_vector, raw};
use crate::fuzzing::solids::{Solid, point_near, reach, unit_vector};
use arbitrary::Unstructured;
use glam::{DVec3, Vec3};
use ist::{BallKind, InnerSphereTree, Ray, SurfaceDistance, reference};
use std::ops::ControlFlow;

/// Rounding of distances of one tree, relative to its reach and to that of what it is asked about.
const ROUNDING: f64 = 1e-5;

pub(super) fn check(u: &mut Unstructured, solid: &Solid, kind: BallKind) {
    let tree = &solid.tree;
    let is_any = below(u, 8) == 7;
    let is_ordinary = solid.is_ordinary && !is_any;
    let size = tree.bounding_ball().1;
    let point = if is_any { any_vector(u) } else { point_near(u, tree) };
    check_point(tree, kind, point, is_ordinary);
    let radius = if is_any { any_float(u) } else { moderate(u) * 0.25 * size };
    check_ball(tree, kind, (point, radius), is_ordinary);
    let direction = if is_any { any_vector(u) } else { moderate_vector(u) * size };
    let max_time = if is_any || raw(u) { any_float(u) } else { moderate(u).abs() };
    check_ray(tree, kind, (&Ray { origin: point, direction, max_time }, raw(u)), is_ordinary);
    let normal = if is_any { any_vector(u) } else { unit_vector(u) };
    let offset = if is_any { any_float(u) } else { normal.dot(point) };
    check_half_space(tree, normal, offset, is_ordinary);
}

fn check_point(tree: &InnerSphereTree, kind: BallKind, point: Vec3, is_ordinary: bool) {
    let found = tree.nearest_sphere(point, kind);
    let contains = tree.contains_point(point, kind);
    if !point.is_finite() {
        assert!(found.is_none() && !contains);
        return;
    }
    if let Some(found) = &found {
        assert!(!found.distance.is_nan() && !found.point.is_nan() && !found.normal.is_nan(), "{found:?}");
        assert!(found.sphere < tree.len());
    }
    if !is_ordinary {
        return;
    }
    let Some(found) = found else { unreachable!("{point} is near the tree") };
    let distance =
        |(center, radius): (Vec3, f32)| point.as_dvec3().distance(center.as_dvec3()) - f64::from(radius);
    let list = reference::balls(tree, kind);
    let least = list.iter().map(|ball| distance(*ball)).fold(f64::INFINITY, f64::min);
    let rounding = ROUNDING * (reach(tree) + f64::from(point.length()));
    assert!((f64::from(found.distance) - least).abs() <= rounding, "{found:?}, not {least}");
    assert!((distance(list[found.sphere]) - least).abs() <= rounding, "{found:?}, not {least}");
    assert!(least.abs() <= rounding || contains == (least < 0.0), "{contains} at {least}");
}

fn check_ball(tree: &InnerSphereTree, kind: BallKind, (center, radius): (Vec3, f32), is_ordinary: bool) {
    let mut found = Vec::new();
    let end = tree.visit_spheres_in_ball(center, radius, kind, |sphere| {
        found.push(sphere);
        ControlFlow::<()>::Continue(())
    });
    assert!(end.is_continue());
    assert_eq!(tree.meets_ball(center, radius, kind), !found.is_empty());
    found.sort_unstable();
    assert!(found.is_sorted_by(|a, b| a < b), "each once");
    let is_ball = center.is_finite() && radius >= 0.0;
    assert!(is_ball || found.is_empty());
    if !(is_ordinary && is_ball) {
        return;
    }
    let rounding = ROUNDING * (reach(tree) + f64::from(center.length() + radius));
    for (sphere, (c, r)) in reference::balls(tree, kind).into_iter().enumerate() {
        let gap = center.as_dvec3().distance(c.as_dvec3()) - f64::from(r) - f64::from(radius);
        assert!(gap.abs() <= rounding || found.binary_search(&sphere).is_ok() == (gap < 0.0), "{gap}");
    }
}

/// Way (m) along a unit direction to the first surface of a ball.
fn way(from: DVec3, direction: DVec3, radius: f64, is_inside: bool) -> Option<f64> {
    // The distance of the line from the centre, without the cancellation of the discriminant.
    let along = from.dot(direction);
    let off = (from - along * direction).length();
    let half = (radius * radius - off * off).max(0.0).sqrt();
    match is_inside {
        true => Some(half - along),
        false if off < radius && along < 0.0 => Some((-half - along).max(0.0)),
        false => None,
    }
}

fn check_ray(tree: &InnerSphereTree, kind: BallKind, (ray, solid): (&Ray, bool), is_ordinary: bool) {
    let hit = tree.cast_ray(ray, solid, kind);
    if let Some(hit) = &hit {
        assert!(!hit.time.is_nan() && !hit.point.is_nan() && !hit.normal.is_nan(), "{ray:?} {hit:?}");
        assert!(hit.time >= 0.0 && hit.time <= ray.max_time && hit.sphere < tree.len(), "{ray:?} {hit:?}");
    }
    let length = ray.direction.as_dvec3().length();
    if !is_ordinary || length == 0.0 || ray.max_time.is_nan() || ray.max_time < 0.0 {
        return;
    }
    let direction = ray.direction.as_dvec3() / length;
    let rounding = ROUNDING * (reach(tree) + f64::from(ray.origin.length()));
    // No ball that is a little smaller may be hit earlier, and some ball that is a little larger is hit by then.
    let (mut latest, mut earliest) = (f64::INFINITY, f64::INFINITY);
    for (center, radius) in reference::balls(tree, kind) {
        let (from, radius) = (ray.origin.as_dvec3() - center.as_dvec3(), f64::from(radius));
        let depth = radius - from.length();
        if depth.abs() <= 2.0 * rounding {
            // On the surface it may be begun inside or outside.
            earliest = 0.0;
            continue;
        }
        let is_inside = depth > 0.0;
        let least = |sum: f64| match is_inside && solid {
            true => Some(0.0),
            false => way(from, direction, sum, is_inside),
        };
        let (larger, smaller) = (least(radius + rounding), least(radius - rounding));
        let (first, last) = if is_inside { (smaller, larger) } else { (larger, smaller) };
        earliest = earliest.min(first.unwrap_or(f64::INFINITY));
        latest = latest.min(last.unwrap_or(f64::INFINITY));
    }
    let end = f64::from(ray.max_time) * length;
    match hit {
        Some(hit) => {
            let way = f64::from(hit.time) * length;
            let slack = 2.0 * rounding + 1e-6 * way;
            assert!(way <= latest + slack && way >= earliest - slack, "{ray:?} {hit:?}: {earliest} {latest}");
        }
        None => {
            assert!(latest >= end * (1.0 - 1e-6) - 2.0 * rounding, "{ray:?} hits at {latest} before {end}")
        }
    }
}

fn check_half_space(tree: &InnerSphereTree, normal: Vec3, offset: f32, is_ordinary: bool) {
    let overlap = tree.overlap_with_half_space(normal, offset);
    let vectors = [overlap.centroid, overlap.gradient, overlap.force, overlap.torque];
    assert!(!overlap.volume.is_nan() && !vectors.iter().any(|v| v.is_nan()), "{overlap:?}");
    let length = normal.length();
    if !(length > 0.5 && length < 2.0 && offset.is_finite()) {
        assert_eq!(overlap, ist::Overlap::default());
        return;
    }
    let outward = normal / length;
    let plane = |point: Vec3| SurfaceDistance { distance: outward.dot(point) - offset, outward };
    let surface = tree.overlap_with_surface(plane);
    assert_eq!((surface.pairs, surface.volume), (overlap.pairs, overlap.volume));
    let mut samples = Vec::new();
    let clearance = tree.contact_samples_with_surface(plane, &mut samples);
    assert!(!clearance.is_nan() && samples.len() == overlap.pairs as usize);
    let nearest = tree.nearest_to_surface(BallKind::Volume, f32::INFINITY, plane);
    assert!(nearest.is_none_or(|nearest| !nearest.gap.is_nan()), "{nearest:?}");
    if !is_ordinary {
        return;
    }
    let rounding = ROUNDING * (reach(tree) + f64::from(offset.abs()));
    let volume = |shift: f64| {
        reference::overlap_with_half_space(tree, outward.as_dvec3(), f64::from(offset) + shift).volume
    };
    let (least, most) = (volume(-rounding) * (1.0 - 2e-5) - 1e-44, volume(rounding) * (1.0 + 2e-5) + 1e-44);
    assert!((least..=most).contains(&f64::from(overlap.volume)), "{overlap:?} is not in {least} to {most}");
    let gaps = tree.volume_balls().map(|(c, r)| outward.as_dvec3().dot(c.as_dvec3()) - f64::from(r));
    let gap = gaps.fold(f64::INFINITY, f64::min) - f64::from(offset);
    let Some(nearest) = nearest else { unreachable!("some ball is nearest") };
    assert!((f64::from(nearest.gap) - gap).abs() <= rounding, "{nearest:?}, not {gap}");
    assert!(gap.abs() <= rounding || (overlap.pairs > 0) == (gap < 0.0), "{overlap:?} at {gap}");
}
