//! Distances, intersection, rays, points, impacts and penetration of trees, against plain loops.
//!
//! Of usual solids results are those of loops over all balls, but for rounding: a distance lies within its bounds, its
//! witnesses lie on the balls, a translation that separates does so, a time of impact is not late. Of all others, and for all
//! numbers, queries end without a panic and without NaN.

mod single;

use super::numbers::{
    any_pose, any_vector, below, finite_float, is_usable, moderate, moderate_vector, pose, raw,
};
use super::solids::{Solid, solid};
use arbitrary::Unstructured;
use glam::Vec3;
use glamx::Pose3;
use ist::{
    BallKind, DistanceOptions, ImpactOptions, InnerSphereTree, OverlapWorkspace, ProximityWorkspace,
    RigidMotion, Separation, TimeOfImpact, reference,
};

/// Enough for most queries; others end undecided.
const MOST_VISITS: usize = 2_000;

/// Two solids, where they are and how they move, from bytes.
pub fn check(data: &[u8]) {
    let u = &mut Unstructured::new(data);
    let a = solid(u);
    let kind = if raw(u) { BallKind::Volume } else { BallKind::Inner };
    single::check(u, &a, kind);
    let b = if below(u, 4) == 0 { Solid { tree: a.tree.clone(), ..a } } else { solid(u) };
    let size = a.tree.bounding_ball().1.max(b.tree.bounding_ball().1);
    let is_any = below(u, 8) == 7;
    let pose = if is_any { any_pose(u) } else { pose(u, 2.0 * size) };
    let pair = Pair { a: &a.tree, b: &b.tree, pose, kind };
    // Queries find nothing beyond 1e18 times A's size, and say so.
    let is_in_range = pair.extent() < 1e17 * f64::from(a.tree.bounding_ball().1);
    let is_ordinary = a.is_ordinary && b.is_ordinary && !is_any && is_in_range;
    pair.check_distance(is_ordinary, [moderate(u).abs() * size, moderate(u).abs() * size], raw(u));
    pair.check_penetration(is_ordinary);
    let velocities: [Vec3; 4] = if below(u, 8) == 7 {
        [(); 4].map(|()| any_vector(u))
    } else {
        [size, 1.0, size, 1.0].map(|size| moderate_vector(u) * size)
    };
    let moves = is_ordinary && velocities.iter().all(|v| v.abs().max_element() <= 8.0 * size.max(1.0));
    let options = ImpactOptions {
        balls: kind,
        max_time: if is_ordinary { moderate(u).abs() } else { finite_float(u) },
        target_distance: if below(u, 2) == 0 { 0.0 } else { 0.1 * size * moderate(u) },
        tolerance: if below(u, 2) == 0 { 0.0 } else { 0.1 * size * moderate(u) },
        max_visits: MOST_VISITS.min(usize::from(raw::<u16>(u))),
        ..ImpactOptions::default()
    };
    pair.check_impact(moves, velocities, &options);
}

/// Two trees and where the second stands in the frame of the first.
struct Pair<'a> {
    a: &'a InnerSphereTree,
    b: &'a InnerSphereTree,
    pose: Pose3,
    kind: BallKind,
}

impl Pair<'_> {
    fn check_distance(&self, is_ordinary: bool, [tolerance, max_distance]: [f32; 2], visits: u8) {
        let Self { a, b, pose, kind } = self;
        let mut workspace = ProximityWorkspace::default();
        let exact = DistanceOptions { balls: *kind, ..DistanceOptions::default() };
        let tolerant = DistanceOptions { tolerance, ..exact };
        let near = DistanceOptions { max_distance, ..exact };
        let hasty = DistanceOptions { max_visits: visits.into(), ..exact };
        let found = [exact, tolerant, near, hasty].map(|options| {
            let found = a.distance_with(b, pose, &options, &mut workspace);
            assert!(found.is_none() || is_usable(pose), "{found:?}");
            if let Some(found) = &found {
                let numbers = [found.distance, found.lower_bound];
                let vectors = [found.point_a, found.point_b, found.normal];
                let is_nan = numbers.iter().any(|x| x.is_nan()) || vectors.iter().any(|v| v.is_nan());
                assert!(!is_nan && found.lower_bound <= found.distance, "{found:?}");
            }
            found
        });
        let meet = a.intersects(b, pose, &mut workspace);
        assert!(!meet || is_usable(pose));
        if !is_ordinary {
            return;
        }
        let [Some(found), Some(tolerant), near, Some(hasty)] = found else {
            unreachable!("{found:?} is the distance of usual solids")
        };
        let truth = reference::distance(a, b, pose, *kind).gap;
        let rounding = 3e-6 * self.extent();
        let distance = truth.max(0.0);
        let error = f64::from(found.distance) - distance;
        assert!((-1e-6 * distance..=rounding).contains(&error), "{found:?}, not {truth}");
        assert!(f64::from(found.lower_bound) >= distance - rounding, "{found:?}, not {truth}");
        let more = f64::from(tolerance) * (1.0 + 1e-6) + rounding;
        assert!(f64::from(tolerant.distance) <= distance + more, "{tolerant:?}, not {truth}");
        if (distance - f64::from(max_distance)).abs() > rounding {
            assert_eq!(near.is_some(), distance < f64::from(max_distance), "{near:?}, not {truth}");
        }
        for found in [found, tolerant, hasty] {
            assert!(f64::from(found.lower_bound) <= distance * (1.0 + 1e-6), "{found:?}, not {truth}");
            assert!(f64::from(found.distance) >= distance * (1.0 - 1e-6), "{found:?}, not {truth}");
            self.check_witnesses(&found);
        }
        let inner = reference::distance(a, b, pose, BallKind::Inner).gap;
        assert!(inner.abs() <= rounding || meet == (inner < 0.0), "{meet} at {inner}");
    }

    /// They lie on the balls that are named, as far apart as the distance says.
    fn check_witnesses(&self, found: &Separation) {
        let rounding = 1e-5 * self.extent();
        let (center_a, radius_a) = reference::balls(self.a, self.kind)[found.sphere_a];
        let (center_b, radius_b) = reference::balls(self.b, self.kind)[found.sphere_b];
        let rotation = self.pose.rotation.normalize();
        let center_b = rotation * center_b + self.pose.translation;
        let apart = f64::from(found.point_a.distance(found.point_b) - found.distance);
        assert!(apart.abs() <= rounding, "{found:?}");
        assert!((found.normal.length() - 1.0).abs() < 1e-5, "{found:?}");
        let outside = [(found.point_a, center_a, radius_a), (found.point_b, center_b, radius_b)]
            .map(|(point, center, radius)| f64::from(point.distance(center) - radius));
        let meet = found.distance == 0.0;
        assert!(outside.iter().all(|x| *x <= rounding && (meet || *x >= -rounding)), "{found:?} {outside:?}");
    }

    fn check_penetration(&self, is_ordinary: bool) {
        let Self { a, b, pose, .. } = self;
        let mut workspace = ProximityWorkspace::default();
        let Some(found) = a.penetration(b, pose, &mut workspace) else { return };
        assert!(is_usable(pose));
        assert!(!found.translation.is_nan() && !found.lower_bound.is_nan() && !found.depth.is_nan());
        assert!(found.lower_bound <= found.depth, "{found:?}");
        if !is_ordinary {
            return;
        }
        assert_eq!(found.depth, found.translation.length());
        let moved = Pose3::from_parts(pose.translation + found.translation, pose.rotation);
        let gap = reference::distance(a, b, &moved, BallKind::Volume).gap;
        assert!(gap >= 0.0, "{found:?} leaves {gap}");
        assert_eq!(a.overlap(b, &moved, &mut OverlapWorkspace::default()).pairs, 0, "{found:?}");
        let deepest = -reference::distance(a, b, pose, BallKind::Volume).gap;
        assert!(f64::from(found.lower_bound) <= deepest.max(0.0) * (1.0 + 1e-6), "{found:?}, not {deepest}");
    }

    fn check_impact(&self, is_ordinary: bool, velocities: [Vec3; 4], options: &ImpactOptions) {
        let [v_a, w_a, v_b, w_b] = velocities;
        let center = self.a.bounding_ball().0;
        let motion = |pose, linear_velocity, angular_velocity| RigidMotion {
            pose,
            local_center: center,
            linear_velocity,
            angular_velocity,
        };
        let motions = [motion(Pose3::IDENTITY, v_a, w_a), motion(self.pose, v_b, w_b)];
        let result = self.a.time_of_impact(self.b, &motions, options, &mut ProximityWorkspace::default());
        let (until, is_hit) = match result {
            TimeOfImpact::Hit(impact) => {
                assert!(!impact.point_a.is_nan() && !impact.point_b.is_nan() && !impact.normal.is_nan());
                (impact.time, true)
            }
            TimeOfImpact::NoHit => (options.max_time.max(0.0), false),
            TimeOfImpact::Undecided { safe_time } => (safe_time, false),
        };
        assert!(until >= 0.0, "{result:?}");
        if !is_ordinary {
            return;
        }
        let gap_at = |time: f32| {
            let [a, b] = [0, 1].map(|i| motions[i].pose_at(time));
            reference::distance(self.a, self.b, &(a.inverse() * b), self.kind).gap
        };
        let way = f64::from(until) * f64::from(v_a.length() + v_b.length());
        let rounding = 2e-5 * (self.extent() + way + 2.0 * center.as_dvec3().length());
        let target = f64::from(options.target_distance.max(0.0));
        for sample in 0..24 {
            let time = until * sample as f32 / 24.0;
            let gap = gap_at(time);
            assert!(until == 0.0 || gap >= target - rounding, "{gap} at {time}: {result:?}");
        }
        if is_hit {
            let smaller = self.a.bounding_ball().1.min(self.b.bounding_ball().1);
            let tolerance = f64::from(options.tolerance).max(1e-6 * f64::from(smaller));
            let gap = gap_at(until);
            assert!(gap <= target + tolerance + rounding, "{gap}: {result:?}");
        }
    }

    /// Largest coordinates that enter (m): what rounding is relative to.
    fn extent(&self) -> f64 {
        let reach = |tree: &InnerSphereTree| {
            let (center, radius) = tree.bounding_ball();
            f64::from(center.abs().max_element() + radius)
        };
        reach(self.a) + reach(self.b) + f64::from(self.pose.translation.abs().max_element())
    }
}
