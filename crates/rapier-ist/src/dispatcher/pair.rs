//! Which of two shapes is the inner sphere tree.

use crate::IstShape;
use ist::InnerSphereTree;
use rapier3d::math::{Pose, Real};
use rapier3d::parry::query::Unsupported;
use rapier3d::parry::shape::{Shape, ShapeType};

/// What stands against a tree.
#[derive(Clone, Copy)]
pub(super) enum Other<'a> {
    Tree(&'a InnerSphereTree),
    Shape(&'a dyn Shape),
}

/// A tree and what stands against it.
pub(super) struct Pair<'a> {
    pub(super) tree: &'a InnerSphereTree,
    pub(super) other: Other<'a>,
    /// Whether the tree is the second shape of the query.
    pub(super) is_swapped: bool,
    /// Of the thinner solid (m).
    pub(super) thickness: Real,
}

impl<'a> Pair<'a> {
    /// # Errors
    /// Where neither shape is an inner sphere tree, and where the other is a custom shape that is not ours: those are for the
    /// next dispatcher.
    pub(super) fn new(g1: &'a dyn Shape, g2: &'a dyn Shape) -> Result<Self, Unsupported> {
        let [tree1, tree2] = [g1, g2].map(|g| g.as_shape::<IstShape>().map(IstShape::tree));
        let thickness = |g: &dyn Shape| g.as_shape::<IstShape>().map_or(Real::MAX, IstShape::thickness);
        let thickness = thickness(g1).min(thickness(g2));
        let known = |g: &'a dyn Shape| match g.shape_type() {
            ShapeType::Custom => Err(Unsupported),
            _ => Ok(Other::Shape(g)),
        };
        match (tree1, tree2) {
            (Some(tree), Some(other)) => {
                Ok(Self { tree, other: Other::Tree(other), is_swapped: false, thickness })
            }
            (Some(tree), None) => Ok(Self { tree, other: known(g2)?, is_swapped: false, thickness }),
            (None, Some(tree)) => Ok(Self { tree, other: known(g1)?, is_swapped: true, thickness }),
            (None, None) => Err(Unsupported),
        }
    }

    /// The pose of the other shape in the tree's frame.
    pub(super) fn pose(&self, pos12: &Pose) -> Pose {
        if self.is_swapped { pos12.inverse() } else { *pos12 }
    }
}
