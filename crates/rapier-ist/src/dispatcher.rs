//! Rapier's queries for inner sphere trees.

use crate::{IstShape, against_shape};
use ist::{ContactSample, OverlapWorkspace};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::{
    ContactManifoldsWorkspace, NormalConstraints, ShapeCastOptions, ShapeIntersection,
};
use rapier3d::parry::query::{
    ClosestPoints, Contact, ContactManifold, NonlinearRigidMotion, PersistentQueryDispatcher,
    QueryDispatcher, ShapeCastHit, ShapeDistance, TrackedContact, Unsupported,
};
use rapier3d::parry::shape::{PackedFeatureId, Shape};
use std::cell::RefCell;

/// Answers queries that involve an [`IstShape`] and leaves all others to the dispatcher behind it:
/// `IstDispatcher.chain(DefaultQueryDispatcher)`.
///
/// Supported: intersection tests and contact manifolds, against inner sphere trees and against every shape of
/// parry. Distances, closest points and shape casts are refused with [`Unsupported`]; in particular there is no
/// continuous collision detection for the shape.
#[derive(Clone, Copy, Debug, Default)]
pub struct IstDispatcher;

thread_local! {
    /// The dispatcher's methods take no workspace, and a query must not allocate.
    static WORKSPACE: RefCell<(OverlapWorkspace, Vec<ContactSample>)> = RefCell::default();
}

/// The overlap of two shapes as one contact, in the first shape's frame.
#[derive(Clone, Copy, Debug)]
struct MeanContact {
    point: Vector,
    /// From the first shape to the second.
    normal: Vector,
    depth: Real,
}

/// Mean contact of two shapes of which at least one is an inner sphere tree.
fn mean_contact(pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> Result<Option<MeanContact>, Unsupported> {
    WORKSPACE.with_borrow_mut(|(workspace, samples)| {
        samples.clear();
        match (g1.as_shape::<IstShape>(), g2.as_shape::<IstShape>()) {
            (Some(a), Some(b)) => a.tree().contact_samples(b.tree(), pos12, workspace, samples),
            (Some(a), None) => against_shape::contact_samples(a.tree(), g2, pos12, samples),
            (None, Some(b)) => {
                against_shape::contact_samples(b.tree(), g1, &pos12.inverse(), samples);
                for sample in &mut *samples {
                    sample.point = *pos12 * sample.point;
                    sample.normal = -(pos12.rotation * sample.normal);
                    sample.separation = -(pos12.rotation * sample.separation);
                }
            }
            (None, None) => return Err(Unsupported),
        }
        let volume: Real = samples.iter().map(|s| s.volume).sum();
        let moment: Vector = samples.iter().map(|s| s.volume * s.point).sum();
        let direction: Vector = samples.iter().map(|s| s.volume * s.normal).sum();
        let Some(normal) = direction.try_normalize().filter(|_| volume > 0.0) else { return Ok(None) };
        let area: Real = samples.iter().map(|s| s.separation.dot(normal)).sum();
        // A body wholly inside another has a volume and no cross-section: its own size bounds the depth.
        let depth = (volume / area.max(Real::MIN_POSITIVE)).min(volume.cbrt());
        Ok(Some(MeanContact { point: moment / volume, normal, depth }))
    })
}

impl QueryDispatcher for IstDispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        let intersecting = match (g1.as_shape::<IstShape>(), g2.as_shape::<IstShape>()) {
            (Some(a), Some(b)) => {
                let query = |workspace: &mut OverlapWorkspace| a.tree().overlap(b.tree(), pos12, workspace);
                WORKSPACE.with_borrow_mut(|(workspace, _)| query(workspace).intersects)
            }
            _ => mean_contact(pos12, g1, g2)?.is_some(),
        };
        Ok(ShapeIntersection { intersecting, subshape1: 0, subshape2: 0 })
    }

    fn distance(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape) -> Result<ShapeDistance, Unsupported> {
        Err(Unsupported)
    }

    fn contact(
        &self,
        _: &Pose,
        _: &dyn Shape,
        _: &dyn Shape,
        _: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        Err(Unsupported)
    }

    fn closest_points(
        &self,
        _: &Pose,
        _: &dyn Shape,
        _: &dyn Shape,
        _: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        Err(Unsupported)
    }

    fn cast_shapes(
        &self,
        _: &Pose,
        _: Vector,
        _: &dyn Shape,
        _: &dyn Shape,
        _: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        Err(Unsupported)
    }

    fn cast_shapes_nonlinear(
        &self,
        _: &NonlinearRigidMotion,
        _: &dyn Shape,
        _: &NonlinearRigidMotion,
        _: &dyn Shape,
        _: Real,
        _: Real,
        _: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        Err(Unsupported)
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
        _: Real,
        manifolds: &mut Vec<ContactManifold<ManifoldData, ContactData>>,
        _: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        let contact = mean_contact(pos12, g1, g2)?;
        // Rapier identifies manifolds by their position in the list, so the one manifold of the pair always stays.
        manifolds.resize_with(1, ContactManifold::new);
        let manifold = &mut manifolds[0];
        manifold.clear();
        let Some(MeanContact { point, normal, depth }) = contact else { return Ok(()) };
        manifold.local_n1 = normal;
        manifold.local_n2 = -(pos12.rotation.inverse() * normal);
        let half = normal * (0.5 * depth);
        manifold.points.push(TrackedContact::new(
            point + half,
            pos12.inverse_transform_point(point - half),
            PackedFeatureId::face(0),
            PackedFeatureId::face(0),
            -depth,
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
