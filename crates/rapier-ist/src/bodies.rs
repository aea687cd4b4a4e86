//! The bodies of a step, as the solve sees them.

use crate::WorldParts;
use crate::candidates::Candidate;
use crate::joint_rows::joint_forces;
use crate::joints::{Joint, can_move, joints_of};
use crate::penalty::{JointForces, SolverBody};
use crate::supports::{neighbours, supports};
use rapier3d::dynamics::{ImpulseJointHandle, MultibodyLinkId, RigidBody, RigidBodyHandle};
use rapier3d::geometry::Collider;
use std::cmp::Ordering;

/// The bodies that take part, each once, in the order of their handles. Index 0 is the world itself.
pub(crate) struct Bodies {
    pub(crate) handles: Vec<Option<RigidBodyHandle>>,
    /// First those of `handles`, then all of them once more as what a dominated body sees: they move and do not give
    /// way.
    pub(crate) states: Vec<SolverBody>,
    /// Those that only Rapier's contacts connect with the others, in order: they do not give way.
    neighbours: Vec<RigidBodyHandle>,
    /// The multibody of which a body is a link, and the number of the link.
    pub(crate) links: Vec<Option<MultibodyLinkId>>,
    /// Their joints, and where Rapier's own contacts support them.
    pub(crate) joints: Vec<SolverJoint>,
}

/// A joint between two bodies, as the solve sees it.
pub(crate) struct SolverJoint {
    pub(crate) bodies: [usize; 2],
    pub(crate) forces: JointForces,
    /// Where it is an impulse joint.
    pub(crate) impulse: Option<ImpulseJointHandle>,
}

impl Bodies {
    pub(crate) fn new(world: &WorldParts<'_>, candidates: &[Candidate]) -> Self {
        let colliders = candidates.iter().flat_map(|candidate| candidate.colliders);
        let mut handles: Vec<_> = colliders.filter_map(|c| world.colliders.get(c)?.parent()).collect();
        let sort = |handles: &mut Vec<RigidBodyHandle>| {
            handles.sort_unstable_by_key(|handle| handle.into_raw_parts());
            handles.dedup();
        };
        sort(&mut handles);
        let beside = neighbours(world, &handles);
        handles.extend(beside.into_iter().filter(|body| world.bodies.get(*body).is_some_and(can_move)));
        let joints = joints_of(world, &mut handles);
        sort(&mut handles);
        let neighbours = neighbours(world, &handles);
        handles.extend(&neighbours);
        sort(&mut handles);
        let state = |handle: &RigidBodyHandle| {
            let body = &world.bodies[*handle];
            SolverBody::new(body, can_move(body), world.gravity, world.integration_parameters.dt)
        };
        let mut states: Vec<_> =
            std::iter::once(SolverBody::FIXED).chain(handles.iter().map(state)).collect();
        states.extend_from_within(..);
        states[handles.len() + 1..].iter_mut().for_each(|state| *state = state.unyielding());
        let handles: Vec<_> = std::iter::once(None).chain(handles.into_iter().map(Some)).collect();
        let link = |handle: &Option<RigidBodyHandle>| {
            handle.and_then(|handle| world.multibody_joints.rigid_body_link(handle).copied())
        };
        let links = handles.iter().map(link).collect();
        let mut bodies = Self { links, handles, states, neighbours, joints: Vec::new() };
        let forces = |joint: &Joint<'_>| {
            let indices = joint.bodies.map(|handle| bodies.index(Some(handle)));
            let poses = joint.bodies.map(|handle| world.bodies[handle].position());
            let states = indices.map(|index| &bodies.states[index]);
            let forces = joint_forces(states, poses, joint, world.integration_parameters)?;
            Some(SolverJoint { bodies: indices, forces, impulse: joint.impulse })
        };
        bodies.joints = joints.iter().filter_map(forces).collect();
        bodies.joints.extend(supports(world, &bodies));
        bodies
    }

    /// Whether only Rapier's contacts connect a body with the others.
    pub(crate) fn is_neighbour(&self, handle: RigidBodyHandle) -> bool {
        let key = |handle: RigidBodyHandle| handle.into_raw_parts();
        self.neighbours.binary_search_by_key(&key(handle), |handle| key(*handle)).is_ok()
    }

    /// Indices of two bodies in contact by Rapier, that of the world for none; what dominates the other does not give way to it.
    pub(crate) fn in_contact(
        &self,
        handles: [Option<RigidBodyHandle>; 2],
        dominates: [bool; 2],
    ) -> [usize; 2] {
        [0, 1].map(|i| {
            let is_unyielding = dominates[i] || handles[i].is_some_and(|handle| self.is_neighbour(handle));
            self.index(handles[i]) + if is_unyielding { self.handles.len() } else { 0 }
        })
    }

    /// Index of a body; that of the world for none.
    fn index(&self, handle: Option<RigidBodyHandle>) -> usize {
        let key = handle.map(RigidBodyHandle::into_raw_parts);
        self.handles.binary_search_by_key(&key, |h| h.map(RigidBodyHandle::into_raw_parts)).unwrap_or(0)
    }

    pub(crate) fn pair(&self, world: &WorldParts<'_>, candidate: &Candidate) -> [usize; 2] {
        let parents =
            candidate.colliders.map(|collider| world.colliders.get(collider).and_then(Collider::parent));
        let [a, b] = parents.map(|parent| self.index(parent));
        // As in Rapier: what is not dynamic dominates everything that is.
        let dominance = |parent: Option<RigidBodyHandle>| {
            let body = parent.and_then(|parent| world.bodies.get(parent));
            body.map_or(i16::MAX, RigidBody::effective_dominance_group)
        };
        match dominance(parents[0]).cmp(&dominance(parents[1])) {
            Ordering::Greater => [a + self.handles.len(), b],
            Ordering::Less => [a, b + self.handles.len()],
            Ordering::Equal => [a, b],
        }
    }

    /// The body that really moves where a pair sees `body`: a dominated body sees the other one unyielding.
    pub(crate) fn real(&self, body: usize) -> usize {
        body % self.handles.len()
    }
}
