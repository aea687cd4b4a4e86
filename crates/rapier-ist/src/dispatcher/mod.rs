//! Rapier's queries for inner sphere trees.

mod cast;
mod compound;
mod manifold;
mod pair;
mod parts;
mod patch;
mod proximity;
mod regions;
mod workspace;

pub(crate) use cast::time_of_impact;
use compound::CompoundPair;
use ist::ImpactOptions;
use manifold::{Division, detected_patch, with_patches, write_manifold, write_manifolds};
use pair::Pair;
use rapier3d::geometry::ContactManifoldData;
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::{
    ContactManifoldsWorkspace, NormalConstraints, ShapeCastOptions, ShapeIntersection,
};
use rapier3d::parry::query::{
    ClosestPoints, Contact, ContactManifold, NonlinearRigidMotion, PersistentQueryDispatcher,
    QueryDispatcher, ShapeCastHit, ShapeDistance, Unsupported,
};
use rapier3d::parry::shape::Shape;
use std::any::Any;
pub(crate) use workspace::with_workspace;

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
/// - Manifolds that Rapier's solver leaves alone, as while a volume penalty pushes, and no contact-modification hook looks at
///   have one point: they tell that shapes are in contact. It is the deepest place where the tree meets one of its own kind, and
///   else that of the step in which the shapes met, for as long as they touch there.
/// - Compounds with inner sphere trees among their parts are seen part by part, by parry's own algorithms. Contacts of
///   such a part have one manifold with one normal, and forces come from Rapier's solver under every
///   [`ContactModel`](crate::ContactModel): several colliders on one body do better. Other custom parts are not seen.
/// - Parry's shapes are seen by their signed distance, in casts by their convex parts. Half-spaces, heightfields and polylines are as
///   parry has them; trimeshes have an inside only with `TriMeshFlags::ORIENTED`, segments, triangles, polylines and heightfields
///   never.
///
/// # Results at the edges
/// Where a pose or a velocity is not finite nothing meets: no intersection, no contact, no hit, and the distance is
/// [`Real::MAX`]. Sub-shapes are those of compounds, else 0.
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
        if let Some(pair) = CompoundPair::new(g1, g2) {
            return Ok(pair.intersection_test(pos12));
        }
        let intersecting = Pair::new(g1, g2)?.intersects(pos12);
        Ok(ShapeIntersection { intersecting, subshape1: 0, subshape2: 0 })
    }

    fn distance(&self, pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> Result<ShapeDistance, Unsupported> {
        if let Some(pair) = CompoundPair::new(g1, g2) {
            return Ok(pair.distance(pos12));
        }
        proximity::distance(pos12, g1, g2).map(ShapeDistance::from)
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        if let Some(pair) = CompoundPair::new(g1, g2) {
            return Ok(pair.contact(pos12, prediction));
        }
        proximity::contact(pos12, g1, g2, prediction)
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        margin: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        if let Some(pair) = CompoundPair::new(g1, g2) {
            return Ok(pair.closest_points(pos12, margin));
        }
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
        if let Some(pair) = CompoundPair::new(g1, g2) {
            return Ok(pair.cast(pos12, velocity, options));
        }
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
        if let Some(pair) = CompoundPair::new(g1, g2) {
            return Ok(pair.cast_nonlinear([motion1, motion2], (start_time, end_time), stop_at_penetration));
        }
        cast::cast_nonlinear((g1, g2), [motion1, motion2], (start_time, end_time), stop_at_penetration)
    }
}

impl<ManifoldData, ContactData> PersistentQueryDispatcher<ManifoldData, ContactData> for IstDispatcher
where
    ManifoldData: Default + Clone + Send + Sync + 'static,
    ContactData: Default + Copy + Send + Sync,
{
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold<ManifoldData, ContactData>>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        if let Some(pair) = CompoundPair::new(g1, g2) {
            return pair.contact_manifolds(pos12, prediction, manifolds, workspace);
        }
        if are_left_alone(manifolds) {
            let last = manifolds.first().and_then(|manifold| manifold.points.first());
            let last = last.map(|point| [point.local_p1, point.local_p2]);
            let patch = detected_patch(pos12, (g1, g2), prediction, last)?;
            write_manifolds(patch.as_slice(), (pos12, prediction), manifolds, workspace);
            return Ok(());
        }
        with_patches(pos12, (g1, g2), prediction, Division::Regions, |patches| {
            write_manifolds(patches, (pos12, prediction), manifolds, workspace);
        })
    }

    /// For parts of composite shapes, which have one manifold each.
    fn contact_manifold_convex_convex(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        _: Option<&dyn NormalConstraints>,
        _: Option<&dyn NormalConstraints>,
        prediction: Real,
        manifold: &mut ContactManifold<ManifoldData, ContactData>,
    ) -> Result<(), Unsupported> {
        with_patches(pos12, (g1, g2), prediction, Division::Whole, |patches| {
            write_manifold(patches.first(), (pos12, prediction), manifold);
        })
    }
}

/// Whether Rapier's solver does nothing with these manifolds, and no hook does: they tell that the shapes are in contact.
fn are_left_alone<ManifoldData: 'static, ContactData>(
    manifolds: &[ContactManifold<ManifoldData, ContactData>],
) -> bool {
    let data = manifolds.first().map(|manifold| &manifold.data as &dyn Any);
    data.and_then(|data| data.downcast_ref::<ContactManifoldData>())
        .is_some_and(|data| data.rigid_body1.or(data.rigid_body2).is_some() && data.solver_flags.is_empty())
}
