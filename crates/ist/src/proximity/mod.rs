//! Distance, intersection, casts and separation of sphere packings.
//!
//! Queries of two trees take B at a pose in A's frame and run in A's unscaled frame, as the overlap does; those
//! of moving trees run in the frame of the motions. Bounds of eight balls are tested at once.

mod ball;
mod deepest;
mod distance;
mod impact;
mod intersects;
mod motion;
mod nearest;
mod penetration;
mod placement;
mod planes;
mod point;
mod projection;
mod ray;
mod safe_step;
mod side;
mod stack;
mod surface;
mod surface_impact;
mod workspace;

pub use deepest::BallContact;
pub use distance::{DistanceOptions, Separation};
pub use impact::{Impact, ImpactOptions, TimeOfImpact};
pub use motion::RigidMotion;
pub use penetration::Penetration;
pub use point::NearestSphere;
pub use ray::{Ray, RayHit};
pub use surface::SurfaceSeparation;
pub use workspace::ProximityWorkspace;

/// Which balls of a packing a query sees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BallKind {
    /// The certified inner balls. They lie inside the solid, so whatever meets one of them meets the solid.
    /// The skin does not belong to them.
    #[default]
    Inner,
    /// The volume balls, which overlap and contact rest on, skin included. They fill the solid in the mean, reach
    /// beyond its surface in places and leave out others. See [`InnerSphere::volume_ball`](crate::InnerSphere::volume_ball).
    Volume,
}

#[cfg(test)]
mod tests;
