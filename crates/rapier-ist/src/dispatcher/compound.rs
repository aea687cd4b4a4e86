//! Inner sphere trees as parts of parry's compounds.
//!
//! parry's dispatcher asks itself about the parts of a compound, and does not know trees. So pairs with such a compound are
//! taken from it: by parry's own algorithms for composite shapes, with a dispatcher that knows the parts.

use super::IstDispatcher;
use super::manifold::mark_unordered;
use super::parts::for_each_part;
use crate::IstShape;
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::bounding_volume::BoundingVolume;
use rapier3d::parry::query::details::{self, ShapeCastOptions};
use rapier3d::parry::query::{
    ClosestPoints, Contact, ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher,
    NonlinearRigidMotion, PersistentQueryDispatcher, QueryDispatcher, QueryDispatcherChain, ShapeCastHit,
    ShapeDistance, ShapeIntersection, Unsupported,
};
use rapier3d::parry::shape::{CompositeShape, Compound, Shape, ShapeType};

/// What knows the parts.
fn parts() -> QueryDispatcherChain<IstDispatcher, DefaultQueryDispatcher> {
    IstDispatcher.chain(DefaultQueryDispatcher)
}

/// Two shapes of which at least one is a compound with an inner sphere tree among its parts.
#[derive(Clone, Copy)]
pub(super) struct CompoundPair<'a> {
    compound: &'a Compound,
    other: &'a dyn Shape,
    /// Whether the compound is the second shape of the query.
    is_swapped: bool,
}

impl<'a> CompoundPair<'a> {
    /// `None` where neither shape is such a compound, and where the other is a custom shape that is not ours.
    pub(super) fn new(g1: &'a dyn Shape, g2: &'a dyn Shape) -> Option<Self> {
        let is_known = |g: &dyn Shape| g.shape_type() != ShapeType::Custom || is_tree(g);
        let compound = |g: &'a dyn Shape| {
            g.as_compound().filter(|c| c.shapes().iter().any(|(_, part)| is_tree(part.as_ref())))
        };
        match (compound(g1), compound(g2)) {
            (Some(compound), _) if is_known(g2) => Some(Self { compound, other: g2, is_swapped: false }),
            (None, Some(compound)) if is_known(g1) => Some(Self { compound, other: g1, is_swapped: true }),
            _ => None,
        }
    }

    pub(super) fn intersection_test(self, pos12: &Pose) -> ShapeIntersection {
        let Self { compound, other, is_swapped } = self;
        match is_swapped {
            false => details::intersection_test_composite_shape_shape(&parts(), pos12, compound, other),
            true => details::intersection_test_shape_composite_shape(&parts(), pos12, other, compound),
        }
    }

    pub(super) fn distance(self, pos12: &Pose) -> ShapeDistance {
        let Self { compound, other, is_swapped } = self;
        match is_swapped {
            false => details::distance_composite_shape_shape(&parts(), pos12, compound, other),
            true => details::distance_shape_composite_shape(&parts(), pos12, other, compound),
        }
    }

    pub(super) fn contact(self, pos12: &Pose, prediction: Real) -> Option<Contact> {
        let Self { compound, other, is_swapped } = self;
        match is_swapped {
            false => details::contact_composite_shape_shape(&parts(), pos12, compound, other, prediction),
            true => details::contact_shape_composite_shape(&parts(), pos12, other, compound, prediction),
        }
    }

    pub(super) fn closest_points(self, pos12: &Pose, margin: Real) -> ClosestPoints {
        let Self { compound, other, is_swapped } = self;
        match is_swapped {
            false => details::closest_points_composite_shape_shape(&parts(), pos12, compound, other, margin),
            true => details::closest_points_shape_composite_shape(&parts(), pos12, other, compound, margin),
        }
    }

    pub(super) fn cast(
        self,
        pos12: &Pose,
        velocity: Vector,
        options: ShapeCastOptions,
    ) -> Option<ShapeCastHit> {
        let Self { compound, other, is_swapped } = self;
        match is_swapped {
            false => details::cast_shapes_composite_shape_shape(
                &parts(),
                pos12,
                velocity,
                compound,
                other,
                options,
            ),
            true => details::cast_shapes_shape_composite_shape(
                &parts(),
                pos12,
                velocity,
                other,
                compound,
                options,
            ),
        }
    }

    pub(super) fn cast_nonlinear(
        self,
        [motion1, motion2]: [&NonlinearRigidMotion; 2],
        (start, end): (Real, Real),
        stop: bool,
    ) -> Option<ShapeCastHit> {
        let Self { compound, other, is_swapped } = self;
        match is_swapped {
            false => details::cast_shapes_nonlinear_composite_shape_shape(
                &parts(),
                motion1,
                compound,
                motion2,
                other,
                start,
                end,
                stop,
            ),
            true => details::cast_shapes_nonlinear_shape_composite_shape(
                &parts(),
                motion1,
                other,
                motion2,
                compound,
                start,
                end,
                stop,
            ),
        }
    }

    /// One manifold for each pair of parts that are near each other.
    pub(super) fn contact_manifolds<ManifoldData, ContactData>(
        self,
        pos12: &Pose,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold<ManifoldData, ContactData>>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported>
    where
        ManifoldData: Default + Clone + Send + Sync + 'static,
        ContactData: Default + Copy + Send + Sync,
    {
        let Self { compound, other, is_swapped } = self;
        let pos21 = pos12.inverse();
        let from_compound = if is_swapped { &pos21 } else { pos12 };
        if let Some(other) = other.as_composite_shape() {
            let (g1, g2): (&dyn CompositeShape, &dyn CompositeShape) =
                if is_swapped { (other, compound) } else { (compound, other) };
            details::contact_manifolds_composite_shape_composite_shape(
                &parts(),
                pos12,
                g1,
                g2,
                prediction,
                manifolds,
                workspace,
            );
        } else if let Some(field) = other.as_heightfield() {
            let to_compound = if is_swapped { pos12 } else { &pos21 };
            details::contact_manifolds_heightfield_composite_shape(
                &parts(),
                to_compound,
                from_compound,
                field,
                compound,
                prediction,
                manifolds,
                workspace,
                !is_swapped,
            );
        } else if other.as_voxels().is_some() {
            self.voxels_manifolds(from_compound, prediction, manifolds);
            mark_unordered(workspace);
        } else {
            details::contact_manifolds_composite_shape_shape(
                &parts(),
                from_compound,
                compound,
                other,
                prediction,
                manifolds,
                workspace,
                is_swapped,
            );
        }
        Ok(())
    }

    /// A manifold for each part that is a tree, and for each voxel near another part. parry's own algorithm panics where a part
    /// is not convex.
    fn voxels_manifolds<ManifoldData, ContactData>(
        self,
        to_other: &Pose,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold<ManifoldData, ContactData>>,
    ) where
        ManifoldData: Default + Clone + Send + Sync + 'static,
        ContactData: Default + Copy + Send + Sync,
    {
        manifolds.clear();
        for (index, (place, part)) in self.compound.shapes().iter().enumerate() {
            let mut add = |at: &Pose, other: &dyn Shape| {
                let mut manifold = ContactManifold::new();
                let pos12 = place.inv_mul(&(*to_other * *at));
                let known = if self.is_swapped {
                    manifold.subshape2 = index as u32;
                    manifold.set_subshape_pos1(Some(*at));
                    manifold.set_subshape_pos2(Some(*place));
                    let (pos12, part) = (pos12.inverse(), part.as_ref());
                    parts().contact_manifold_convex_convex(
                        &pos12,
                        other,
                        part,
                        None,
                        None,
                        prediction,
                        &mut manifold,
                    )
                } else {
                    manifold.subshape1 = index as u32;
                    manifold.set_subshape_pos1(Some(*place));
                    manifold.set_subshape_pos2(Some(*at));
                    let part = part.as_ref();
                    parts().contact_manifold_convex_convex(
                        &pos12,
                        part,
                        other,
                        None,
                        None,
                        prediction,
                        &mut manifold,
                    )
                };
                if known.is_ok() && !manifold.points.is_empty() {
                    manifolds.push(manifold);
                }
            };
            if is_tree(part.as_ref()) {
                add(&Pose::IDENTITY, self.other);
            } else {
                let region = part.compute_aabb(&to_other.inv_mul(place)).loosened(prediction);
                for_each_part(self.other, &region, &mut add);
            }
        }
    }
}

fn is_tree(shape: &dyn Shape) -> bool {
    shape.as_shape::<IstShape>().is_some()
}
