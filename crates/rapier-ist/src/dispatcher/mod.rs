//! Rapier's queries for inner sphere trees.

mod cast;
mod manifold;
mod pair;
mod parts;
mod proximity;
mod workspace;

pub(crate) use cast::time_of_impact;
use ist::ImpactOptions;
use manifold::{MeanContact, mean_contact};
use pair::Pair;
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::{
    ContactManifoldsWorkspace, NormalConstraints, ShapeCastOptions, ShapeIntersection,
};
use rapier3d::parry::query::{
    ClosestPoints, Contact, ContactManifold, NonlinearRigidMotion, PersistentQueryDispatcher,
    QueryDispatcher, ShapeCastHit, ShapeDistance, TrackedContact, Unsupported,
};
use rapier3d::parry::shape::{PackedFeatureId, Shape};

/// Answers every query that involves an [`IstShape`](crate::IstShape) and leaves all others to the dispatcher behind it:
/// `IstDispatcher.chain(DefaultQueryDispatcher)`.
///
/// The other shape may be an inner sphere tree or any of parry's, in either order. Custom shapes of others are refused with
/// [`Unsupported`], so that the next dispatcher may know them.
///
/// # What queries see
/// - Intersection, distance, contact, closest points and casts see the certified inner balls, which lie in the solid: what they
///   report as meeting does meet, and distances are upper bounds of those of the solids. Contact manifolds rest on the volume
///   balls, as forces do.
/// - Parry's shapes are seen by their signed distance, in casts by their convex parts. Half-spaces, heightfields and polylines are as
///   parry has them; trimeshes have an inside only with `TriMeshFlags::ORIENTED`, segments, triangles, polylines and heightfields
///   never.
///
/// # Results at the edges
/// Where a pose or a velocity is not finite nothing meets: no intersection, no contact, no hit, and the distance is
/// [`Real::MAX`]. Sub-shapes are always 0.
///
/// Linear casts follow parry's contract for [`ShapeCastOptions`]. In nonlinear casts without `stop_at_penetration` shapes stop a
/// thousandth of the solid's thickness apart, so that continuous collision detection does not leave them in contact; balls in
/// contact at the start count only if they would approach by more than both shapes' thickness.
#[derive(Clone, Copy, Debug, Default)]
pub struct IstDispatcher;

impl QueryDispatcher for IstDispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        let intersecting = Pair::new(g1, g2)?.intersects(pos12);
        Ok(ShapeIntersection { intersecting, subshape1: 0, subshape2: 0 })
    }

    fn distance(&self, pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> Result<ShapeDistance, Unsupported> {
        proximity::distance(pos12, g1, g2).map(ShapeDistance::from)
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        proximity::contact(pos12, g1, g2, prediction)
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        margin: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        proximity::closest_points(pos12, g1, g2, margin)
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        velocity: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        let motions = [cast::straight(Pose::IDENTITY, Vector::ZERO), cast::straight(*pos12, velocity)];
        let ignored_approach = if options.stop_at_penetration { Real::NEG_INFINITY } else { 0.0 };
        let options = ImpactOptions {
            max_time: options.max_time_of_impact,
            target_distance: options.target_distance,
            ignored_approach,
            ..ImpactOptions::default()
        };
        cast::cast_pair((g1, g2), motions, options)
    }

    fn cast_shapes_nonlinear(
        &self,
        motion1: &NonlinearRigidMotion,
        g1: &dyn Shape,
        motion2: &NonlinearRigidMotion,
        g2: &dyn Shape,
        start_time: Real,
        end_time: Real,
        stop_at_penetration: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        cast::cast_nonlinear((g1, g2), [motion1, motion2], (start_time, end_time), stop_at_penetration)
    }
}

impl<ManifoldData, ContactData> PersistentQueryDispatcher<ManifoldData, ContactData> for IstDispatcher
where
    ManifoldData: Default + Clone,
    ContactData: Default + Copy,
{
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold<ManifoldData, ContactData>>,
        _: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        let contact = mean_contact(pos12, g1, g2, prediction)?;
        // Rapier identifies manifolds by their position in the list, so the one manifold of the pair always stays.
        manifolds.resize_with(1, ContactManifold::new);
        let manifold = &mut manifolds[0];
        manifold.clear();
        let Some(MeanContact { points, normal, distance }) = contact else { return Ok(()) };
        manifold.local_n1 = normal;
        manifold.local_n2 = -(pos12.rotation.inverse() * normal);
        manifold.points.push(TrackedContact::new(
            points[0],
            pos12.inverse_transform_point(points[1]),
            PackedFeatureId::face(0),
            PackedFeatureId::face(0),
            distance,
        ));
        Ok(())
    }

    fn contact_manifold_convex_convex(
        &self,
        _: &Pose,
        _: &dyn Shape,
        _: &dyn Shape,
        _: Option<&dyn NormalConstraints>,
        _: Option<&dyn NormalConstraints>,
        _: Real,
        _: &mut ContactManifold<ManifoldData, ContactData>,
    ) -> Result<(), Unsupported> {
        Err(Unsupported)
    }
}
