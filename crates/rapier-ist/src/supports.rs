//! What Rapier's own contacts do to the bodies of the solve.
//!
//! A table that trees lie on stands on a floor, and a robot that holds one on its wheels. The solve has to know what carries them, or it
//! takes them to fall together. Rapier still solves these contacts: they are in the solve so that it expects what they do.

use crate::WorldParts;
use crate::bodies::{Bodies, SolverJoint};
use crate::hooks::is_solid;
use crate::joint_rows::SOFTNESS;
use crate::penalty::{JointForces, JointRow, Screw, SolverBody, compliance};
use rapier3d::dynamics::{RigidBody, RigidBodyHandle};
use rapier3d::geometry::{ContactManifold, ContactPair, SolverFlags};
use rapier3d::glamx::DVec3;
use rapier3d::math::Vector;
use std::collections::BTreeSet;

/// Contacts that rebound are left to Rapier where bodies approach faster than this many times what gravity gives in a step. Not tuned.
const BOUNCING: f64 = 2.0;

/// A contact whose points are farther from each other sideways (in units of length), and than two steps lead, is one of where a body was before
/// the user moved it. A choice.
const MOVED: f64 = 0.02;

/// The contacts of a body that Rapier solves, each with what it is in contact with.
fn contacts_of<'a>(
    world: &'a WorldParts<'_>,
    body: RigidBodyHandle,
) -> impl Iterator<Item = (&'a ContactPair, Option<RigidBodyHandle>)> {
    let body = world.bodies.get(body).filter(|body| body.is_dynamic() && !body.is_sleeping());
    let colliders = body.into_iter().flat_map(RigidBody::colliders);
    colliders.flat_map(|collider| {
        world.narrow_phase.contact_pairs_with(*collider).filter_map(|pair| {
            let colliders = [pair.collider1, pair.collider2];
            let is_ours = colliders.iter().any(|c| world.colliders.get(*c).is_none_or(is_solid));
            let other = colliders[usize::from(colliders[0] == *collider)];
            (!is_ours).then(|| (pair, world.colliders[other].parent()))
        })
    })
}

/// What Rapier's contacts connect with `bodies`, which are in the order of their handles, and is not one of them; in that order.
pub(crate) fn neighbours(world: &WorldParts<'_>, bodies: &[RigidBodyHandle]) -> Vec<RigidBodyHandle> {
    let others = bodies.iter().flat_map(|body| contacts_of(world, *body).filter_map(|(_, other)| other));
    let key = |handle: &RigidBodyHandle| handle.into_raw_parts();
    let is_other = |other: &RigidBodyHandle| bodies.binary_search_by_key(&key(other), key).is_err();
    let mut others: Vec<RigidBodyHandle> = others.filter(is_other).collect();
    others.sort_unstable_by_key(key);
    others.dedup();
    others
}

/// All points at which Rapier's solver pushes the bodies of the solve apart, and off others, as they stand since its last detection; but
/// for contacts between links of multibodies.
pub(crate) fn supports(world: &WorldParts<'_>, bodies: &Bodies) -> Vec<SolverJoint> {
    let dt = f64::from(world.integration_parameters.dt);
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for handle in bodies.handles.iter().flatten().filter(|handle| !bodies.is_neighbour(**handle)) {
        for (pair, _) in contacts_of(world, *handle) {
            if seen.insert([pair.collider1, pair.collider2].map(|c| c.into_raw_parts())) {
                for manifold in pair.solver_manifolds() {
                    add_points(world, (bodies, dt), manifold, &mut found);
                }
            }
        }
    }
    found
}

fn add_points(
    world: &WorldParts<'_>,
    (bodies, dt): (&Bodies, f64),
    manifold: &ContactManifold,
    found: &mut Vec<SolverJoint>,
) {
    let data = &manifold.data;
    if !data.solver_flags.contains(SolverFlags::COMPUTE_RIGID_IMPULSES) {
        return;
    }
    let dominance = data.relative_dominance;
    let handles = [data.rigid_body1, data.rigid_body2];
    // With these, ragdolls of Rapier's cuboids that lie on each other and on trees are thrown about in one of six runs, without in none.
    let is_link = |body: Option<RigidBodyHandle>| {
        body.is_some_and(|body| world.multibody_joints.rigid_body_link(body).is_some())
    };
    if handles.into_iter().all(is_link) {
        return;
    }
    let indices = bodies.in_contact(handles, [dominance > 0, dominance < 0]);
    let states = indices.map(|index| &bodies.states[index]);
    let places = [dominance > 0, dominance < 0].into_iter().zip(handles).map(|(is_world, handle)| {
        let body = handle.and_then(|handle| world.bodies.get(handle)).filter(|_| !is_world);
        move |anchor: Vector| in_world(body, anchor)
    });
    let places: Vec<_> = places.collect();
    let normal = data.normal.as_dvec3();
    let fall = f64::from(world.gravity.length()) * dt;
    let least = MOVED * f64::from(world.integration_parameters.length_unit);
    for point in &data.solver_contacts {
        let anchors = [places[0](point.anchor1), places[1](point.anchor2)].map(|place| place.as_dvec3());
        let velocity = (states[1].twist_at(anchors[1]) - states[0].twist_at(anchors[0])).linear;
        let is_moved =
            sideways(anchors[1] - anchors[0], normal) > least + 2.0 * dt * sideways(velocity, normal);
        let rebounds = data.restitution > 0.0 && -velocity.dot(normal) > BOUNCING * fall;
        if is_moved || rebounds {
            continue;
        }
        if let Some(forces) = support(states, anchors, (normal, f64::from(data.friction)), dt) {
            found.push(SolverJoint { bodies: indices, forces, impulse: None });
        }
    }
}

fn sideways(vector: DVec3, normal: DVec3) -> f64 {
    (vector - normal * vector.dot(normal)).length()
}

/// A point of a contact in the world: Rapier keeps it in the frame of the body's centre of mass, and of what does not give way in the
/// world's.
fn in_world(body: Option<&RigidBody>, anchor: Vector) -> Vector {
    body.map_or(anchor, |body| body.center_of_mass() + *body.rotation() * anchor)
}

/// One point: a row along the normal that pushes only, and two of friction.
fn support(
    states: [&SolverBody; 2],
    anchors: [DVec3; 2],
    (normal, friction): (DVec3, f64),
    dt: f64,
) -> Option<JointForces> {
    let along = |linear: DVec3| Screw { linear, ..Screw::ZERO };
    let damping = |axis: Screw| 1.0 / (dt * compliance(states, anchors, axis) * SOFTNESS);
    let room = (anchors[1] - anchors[0]).dot(normal).max(0.0);
    let push = along(normal);
    let push = JointRow::new(push, -room / dt, damping(push), [0.0, f64::INFINITY]);
    let (first, second) = normal.any_orthonormal_pair();
    let tangents = [first, second].map(|tangent| {
        let axis = along(tangent);
        JointRow::new(axis, 0.0, damping(axis), [0.0; 2]).rubs(0, friction)
    });
    // Along locked axes nothing can move, and nothing has to rub.
    let rows = std::iter::once(push).chain(tangents.into_iter().filter(JointRow::is_finite)).collect();
    let is_finite = anchors.iter().all(|anchor| anchor.is_finite()) && push.is_finite();
    is_finite.then(|| JointForces::new(anchors, rows).of_support())
}
