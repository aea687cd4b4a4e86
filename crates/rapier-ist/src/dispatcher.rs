//! Rapier's queries for inner sphere trees.

use crate::IstShape;
use crate::against_shape::{self, Solid};
use ist::{ContactSample, OverlapWorkspace};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::contact_manifolds::{ContactManifoldsWorkspace, NormalConstraints};
use rapier3d::parry::query::details::ShapeCastOptions;
use rapier3d::parry::query::{
    ClosestPoints, Contact, ContactManifold, NonlinearRigidMotion, PersistentQueryDispatcher, QueryDispatcher,
    ShapeCastHit, ShapeDistance, ShapeIntersection, TrackedContact, Unsupported,
};
use rapier3d::parry::shape::{PackedFeatureId, Shape};
use std::cell::RefCell;

/// Answers queries that involve an [`IstShape`] and leaves all others to the dispatcher behind it:
/// `IstDispatcher.chain(DefaultQueryDispatcher)`.
///
/// Supported today: intersection tests and contact manifolds, against inner sphere trees and against every shape of
/// parry. Distances, closest points and shape casts are refused with `Unsupported`, so continuous collision
/// detection skips the pair.
#[derive(Clone, Copy, Debug, Default)]
pub struct IstDispatcher;
