//! One mean contact of two shapes, for Rapier's solver and events.

use super::pair::{Other, Pair};
use super::workspace::with_workspace;
use crate::against_shape;
use ist::BallKind;
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::Unsupported;
use rapier3d::parry::shape::Shape;

/// The overlap of two shapes as one contact, or their nearest places, in the first shape's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeanContact {
    /// Of the first shape and of the second.
    pub(super) points: [Vector; 2],
    /// From the first shape to the second.
    pub(super) normal: Vector,
    /// Negative where they overlap (m).
    pub(super) distance: Real,
}

/// The contact of two shapes of which at least one is an inner sphere tree: their mean contact where volume balls overlap, the
/// nearest places of volume balls nearer than `prediction` where they do not.
pub(super) fn mean_contact(
    pos12: &Pose,
    g1: &dyn Shape,
    g2: &dyn Shape,
    prediction: Real,
) -> Result<Option<MeanContact>, Unsupported> {
    let pair = Pair::new(g1, g2)?;
    if !pos12.is_finite() {
        return Ok(None);
    }
    Ok(pair.overlap(pos12).or_else(|| {
        let gap = pair.gap(pos12, BallKind::Volume, prediction)?;
        Some(MeanContact { points: gap.points, normal: gap.normal, distance: gap.gap.max(0.0) })
    }))
}

impl Pair<'_> {
    /// The overlap as one contact: depth V/A, normal of the mean sample.
    fn overlap(&self, pos12: &Pose) -> Option<MeanContact> {
        let pose = self.pose(pos12);
        with_workspace(|workspace| {
            let samples = &mut workspace.samples;
            samples.clear();
            match self.other {
                Other::Tree(other) => {
                    self.tree.contact_samples(other, &pose, &mut workspace.overlap, samples);
                }
                Other::Shape(shape) => against_shape::contact_samples(self.tree, shape, &pose, samples),
            }
            let volume: Real = samples.iter().map(|s| s.volume).sum();
            let moment: Vector = samples.iter().map(|s| s.volume * s.point).sum();
            let direction: Vector = samples.iter().map(|s| s.volume * s.normal).sum();
            let normal = direction.try_normalize().filter(|_| volume > 0.0)?;
            let area: Real = samples.iter().map(|s| s.separation.dot(normal)).sum();
            // A body wholly inside another has a volume and no cross-section: its own size bounds the depth.
            let depth = (volume / area.max(Real::MIN_POSITIVE)).min(volume.cbrt());
            let (mut point, mut normal) = (moment / volume, normal);
            if self.is_swapped {
                (point, normal) = (*pos12 * point, -(pos12.rotation * normal));
            }
            let half = normal * (0.5 * depth);
            Some(MeanContact { points: [point + half, point - half], normal, distance: -depth })
        })
    }
}
