//! Solids that are given by their signed distance.

use glam::Vec3;

/// The surface of a solid as one point sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceDistance {
    /// Distance to the surface (m), negative inside. A point whose distance is no number meets nothing.
    pub distance: f32,
    /// Unit vector away from the solid.
    pub outward: Vec3,
}

/// A solid that says how far away it is.
///
/// Distances must be 1-Lipschitz, as those of solids are: they change by no more than the way. Closures from points to
/// [`SurfaceDistance`]s are such solids.
pub trait SignedDistance {
    /// The surface as seen from `point`.
    fn distance(&mut self, point: Vec3) -> SurfaceDistance;

    /// The same where the distance is less than `reach` (m). Where it is not, any number from `reach` to the distance will do,
    /// with any outward vector: most points that a tree asks about are clear of the solid, and how far away they are is not
    /// needed.
    fn distance_within(&mut self, point: Vec3, _reach: f32) -> SurfaceDistance {
        self.distance(point)
    }
}

impl<F: FnMut(Vec3) -> SurfaceDistance> SignedDistance for F {
    fn distance(&mut self, point: Vec3) -> SurfaceDistance {
        self(point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::tests::random_packing;
    use crate::{BallKind, ImpactOptions, InnerSphere, InnerSphereTree, ProximityWorkspace, RigidMotion};
    use crate::{SolidProperties, SpherePacking, TimeOfImpact};
    use alloc::vec::Vec;
    use glamx::Pose3;
    use proptest::prelude::*;

    /// A ball of radius 0.7 that tells no more than it must.
    struct LazyBall;

    impl SignedDistance for LazyBall {
        fn distance(&mut self, point: Vec3) -> SurfaceDistance {
            let outward = point.normalize_or(Vec3::Y);
            SurfaceDistance { distance: point.length() - 0.7, outward }
        }

        fn distance_within(&mut self, point: Vec3, reach: f32) -> SurfaceDistance {
            let seen = self.distance(point);
            if seen.distance < reach { seen } else { SurfaceDistance { distance: reach, outward: Vec3::NAN } }
        }
    }

    fn eager(point: Vec3) -> SurfaceDistance {
        LazyBall.distance(point)
    }

    proptest! {
        /// Nothing but the clearance depends on how far away what is not near is.
        #[test]
        fn what_is_not_near_need_not_be_measured(
            packing in random_packing(200), skin in 0.0_f32..0.1, at in prop::array::uniform3(-1.5_f32..1.5),
            max_gap in -0.5_f32..1.0,
            velocities in prop::array::uniform4(prop::array::uniform3(-3.0_f32..3.0)),
        ) {
            let tree = InnerSphereTree::new(&packing).with_skin(skin).unwrap();
            let at = Vec3::from(at);
            let moved = |point: Vec3| eager(point - at);
            struct Moved(Vec3);
            impl SignedDistance for Moved {
                fn distance(&mut self, point: Vec3) -> SurfaceDistance {
                    LazyBall.distance(point - self.0)
                }
                fn distance_within(&mut self, point: Vec3, reach: f32) -> SurfaceDistance {
                    LazyBall.distance_within(point - self.0, reach)
                }
            }
            prop_assert_eq!(tree.overlap_with_surface(Moved(at)), tree.overlap_with_surface(moved));
            let (mut few, mut all) = (Vec::new(), Vec::new());
            let clearance = tree.contact_samples_with_surface(Moved(at), &mut few);
            let most = tree.contact_samples_with_surface(moved, &mut all);
            prop_assert_eq!(few, all);
            prop_assert!(clearance >= 0.0 && clearance <= most + 1e-6, "{} {}", clearance, most);
            let [lazy, known] = [
                tree.nearest_to_surface(BallKind::Volume, max_gap, Moved(at)),
                tree.nearest_to_surface(BallKind::Volume, max_gap, moved),
            ];
            prop_assert_eq!(lazy, known);
            let [linear_a, linear_b, angular_a, angular_b] = velocities.map(Vec3::from);
            let motion = |translation, linear_velocity, angular_velocity| RigidMotion {
                linear_velocity,
                angular_velocity,
                ..RigidMotion::at_rest(Pose3::from_translation(translation))
            };
            let motions = [motion(Vec3::ZERO, linear_a, angular_a), motion(at * 2.0, linear_b, angular_b)];
            let mut workspace = ProximityWorkspace::default();
            for max_time in [0.0, 0.5, f32::INFINITY] {
                let options = ImpactOptions { max_time, tolerance: 1e-3, ..ImpactOptions::default() };
                let lazy = tree.time_of_surface_impact(LazyBall, &motions, &options, &mut workspace);
                let known = tree.time_of_surface_impact(eager, &motions, &options, &mut workspace);
                prop_assert_eq!(lazy, known);
                let lazy = tree.time_of_convex_impact(LazyBall, &motions, &options, &mut workspace);
                let known = tree.time_of_convex_impact(eager, &motions, &options, &mut workspace);
                prop_assert_eq!(lazy, known);
            }
        }
    }

    fn unit_ball() -> InnerSphereTree {
        let ball = InnerSphere::solid_ball(Vec3::ZERO, 1.0, Vec3::X);
        InnerSphereTree::new(&SpherePacking::new(alloc::vec![ball], SolidProperties::ball(1.0)).unwrap())
    }

    #[test]
    fn touching_is_meeting() {
        let plane = |height: f32| move |p: Vec3| SurfaceDistance { distance: p.y + height, outward: Vec3::Y };
        assert!(unit_ball().meets_surface(BallKind::Inner, plane(1.0)));
        assert!(!unit_ball().meets_surface(BallKind::Inner, plane(1.0_f32.next_up())));
    }

    #[test]
    fn a_solid_that_stands_still_forever_is_never_met() {
        let tree = unit_ball();
        let away = RigidMotion::at_rest(Pose3::from_translation(Vec3::X * 9.0));
        let turning = RigidMotion { angular_velocity: Vec3::Y, ..RigidMotion::at_rest(Pose3::IDENTITY) };
        for b in [RigidMotion::at_rest(Pose3::IDENTITY), turning] {
            let options = ImpactOptions { max_time: 1e3, tolerance: 1e-2, ..ImpactOptions::default() };
            let mut workspace = ProximityWorkspace::default();
            let met = tree.time_of_surface_impact(LazyBall, &[away, b], &options, &mut workspace);
            assert!(!matches!(met, TimeOfImpact::Hit(_)), "{met:?}");
        }
    }
}
