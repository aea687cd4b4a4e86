//! The joints between bodies that touch, and those that hang on them.

use crate::WorldParts;
use crate::links::Link;
use rapier3d::dynamics::{GenericJoint, ImpulseJointHandle, RigidBody, RigidBodyHandle};
use std::collections::{BTreeMap, HashSet};

/// An enabled joint and its bodies.
pub(crate) struct Joint<'a> {
    pub(crate) bodies: [RigidBodyHandle; 2],
    pub(crate) data: &'a GenericJoint,
    /// Where it is one of a multibody.
    pub(crate) link: Option<Link<'a>>,
    /// Where it is not.
    pub(crate) impulse: Option<ImpulseJointHandle>,
}

/// Kind and number of a joint: the order in which the solve takes them.
type JointKey = (bool, (u32, u32));

/// All joints of `bodies` and of those that joints connect with them, through bodies that can move; adds these to `bodies`.
pub(crate) fn joints_of<'a>(world: &'a WorldParts<'_>, bodies: &mut Vec<RigidBodyHandle>) -> Vec<Joint<'a>> {
    if world.impulse_joints.is_empty() && world.multibody_joints.multibodies().next().is_none() {
        return Vec::new();
    }
    let mut found: BTreeMap<JointKey, Joint<'a>> = BTreeMap::new();
    let mut seen: HashSet<RigidBodyHandle> = bodies.iter().copied().collect();
    let mut next = 0;
    while let Some(&body) = bodies.get(next) {
        next += 1;
        if !world.bodies.get(body).is_some_and(can_move) {
            continue;
        }
        for (key, joint) in joints_at(world, body) {
            if joint.bodies.iter().all(|body| world.bodies.contains(*body)) {
                bodies.extend(joint.bodies.into_iter().filter(|body| seen.insert(*body)));
                found.insert(key, joint);
            }
        }
    }
    found.into_values().collect()
}

/// Whether the solve may change the velocity of a body.
pub(crate) fn can_move(body: &RigidBody) -> bool {
    body.is_dynamic() && !body.is_sleeping() && body.is_enabled()
}

/// All enabled joints of a body.
pub(crate) fn joints_at<'a>(
    world: &'a WorldParts<'_>,
    body: RigidBodyHandle,
) -> impl Iterator<Item = (JointKey, Joint<'a>)> {
    let impulse = world.impulse_joints.attached_enabled_joints(body).map(|(a, b, handle, joint)| {
        let joint = Joint { bodies: [a, b], data: &joint.data, link: None, impulse: Some(handle) };
        ((false, handle.0.into_raw_parts()), joint)
    });
    let links = world.multibody_joints.attached_joints(body).filter_map(|(a, b, handle)| {
        let (multibody, id) = world.multibody_joints.get(handle)?;
        let link = Link { multibody, link: multibody.link(id)? };
        let data = &link.link.joint().data;
        let joint = Joint { bodies: [a, b], data, link: Some(link), impulse: None };
        data.is_enabled().then_some(((true, handle.0.into_raw_parts()), joint))
    });
    impulse.chain(links)
}
