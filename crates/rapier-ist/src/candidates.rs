//! Which pairs of colliders may be in volume contact.
//!
//! Found anew from the predicted motion before every step, not from Rapier's contact graph, which is as old as the last
//! detection: a pair that begins to overlap now is pushed now.

use crate::WorldParts;
use crate::drives::Drives;
use crate::hooks::is_solid;
use crate::lookahead::Displacement;
use crate::permission::Permission;
use rapier3d::geometry::{Collider, ColliderHandle, Shape};
use rapier3d::math::{Pose, Real};
use rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::parry::partitioning::{Bvh, BvhBuildStrategy};
use rapier3d::pipeline::PhysicsHooks;
use std::collections::HashMap;
use std::ops::RangeInclusive;

/// Two colliders near each other, of which at least one is an inner sphere tree; the smaller handle first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Candidate {
    pub(crate) colliders: [ColliderHandle; 2],
    /// At the start of the step.
    pub(crate) poses: [Pose; 2],
    /// What the bodies would do during the step if nothing stopped them.
    pub(crate) displacements: [Displacement; 2],
    /// Longest side (m) of the smaller collider's box, in its own frame.
    pub(crate) size: Real,
    /// Whether they touched at the end of the last step.
    pub(crate) touched: bool,
    /// How far apart they are certain to be where they were last measured (m); 0 where they touch or nothing is known.
    pub(crate) clearance: Real,
    /// Whether they can meet only where something else pushes one of them: not measured until it does.
    pub(crate) is_distant: bool,
    /// Whether a motor or the user drives one of them.
    pub(crate) is_driven: bool,
    /// Whether they were apart where they were last measured in this step.
    pub(crate) was_apart: bool,
    /// Whether they are to be measured at the end of their displacements, however long their way is.
    pub(crate) is_at_end: bool,
}

impl Candidate {
    /// To be measured half-way between the end of its displacements and that of `displacements`.
    pub(crate) fn half_way_from(&self, displacements: [Displacement; 2]) -> Self {
        let half_way = |i: usize| self.displacements[i].half_way_from(&displacements[i]);
        Self { displacements: [0, 1].map(half_way), is_at_end: true, ..*self }
    }
}

/// All pairs whose boxes overlap, or would if what else overlaps one of them pushed it as far as it can, and which Rapier would let
/// collide; sorted by handles.
pub(crate) fn candidates(world: &WorldParts<'_>, hooks: &dyn PhysicsHooks) -> Vec<Candidate> {
    let colliders = Colliders::new(world);
    let permission = Permission { world, hooks };
    let mut pairs = Vec::new();
    let driven = colliders.driven(world);
    colliders.add_near(&permission, &mut pairs);
    colliders.add_distant(&permission, &driven, &mut pairs);
    for pair in &mut pairs {
        pair.is_driven = pair.colliders.iter().any(|collider| driven.contains_key(collider));
    }
    pairs.sort_unstable_by_key(|pair| pair.colliders.map(ColliderHandle::into_raw_parts));
    pairs.dedup_by_key(|pair| pair.colliders);
    pairs
}

/// All that can touch: inner sphere trees, with a tree over their boxes, and other shapes.
struct Colliders<'a> {
    solids: Vec<Near<'a>>,
    bvh: Bvh,
    others: Vec<Near<'a>>,
}

impl<'a> Colliders<'a> {
    fn new(world: &'a WorldParts<'_>) -> Self {
        let mut solids = Vec::new();
        let mut others = Vec::new();
        for (handle, collider) in world.colliders.iter_enabled().filter(|(_, c)| !c.is_sensor()) {
            let (pose, displacement) = motion(world, collider);
            if !pose.is_finite() {
                continue;
            }
            let shape = collider.shape();
            let bounds = shape.compute_aabb(&pose).merged(&shape.compute_aabb(&displacement.apply(&pose)));
            let bounds = bounds.loosened(collider.contact_skin());
            let near = Near { handle, collider, pose, displacement, bounds };
            let list = if is_solid(collider) { &mut solids } else { &mut others };
            list.push(near);
        }
        let boxes: Vec<Aabb> = solids.iter().map(|solid| solid.bounds).collect();
        let bvh = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        Self { solids, bvh, others }
    }

    /// The trees whose boxes overlap `region`, and perhaps some more: a box is read as f32 extents with a margin of its own.
    fn solids_in<'b>(&'b self, region: &'b Aabb) -> impl Iterator<Item = (usize, &'b Near<'a>)> + 'b {
        self.bvh.intersect_aabb(region).map(|leaf| (leaf as usize, &self.solids[leaf as usize]))
    }

    /// Pairs whose boxes overlap.
    fn add_near(&self, permission: &Permission<'_>, pairs: &mut Vec<Candidate>) {
        for (index, solid) in self.solids.iter().enumerate() {
            for (_, other) in self.solids_in(&solid.bounds).filter(|(other, _)| *other > index) {
                push(permission, [solid, other], 0.0..=0.0, pairs);
            }
        }
        for other in &self.others {
            for (_, solid) in self.solids_in(&other.bounds) {
                push(permission, [solid, other], 0.0..=0.0, pairs);
            }
        }
    }

    /// How far (m) motors and the user may move colliders in the step beyond their own ways. What is slow is left out.
    fn driven(&self, world: &WorldParts<'_>) -> HashMap<ColliderHandle, Real> {
        let drives = Drives::new(world);
        let way = |near: &Near<'_>| {
            let way = drives.way(near.collider.parent()?, &near.bounds);
            (way > 0.0 && way > SLOW * longest_side(near.collider.shape())).then_some((near.handle, way))
        };
        self.solids.iter().chain(&self.others).filter_map(way).collect()
    }

    /// Pairs that one of `pairs` may push into each other, or that something drives there; some twice.
    fn add_distant(
        &self,
        permission: &Permission<'_>,
        driven: &HashMap<ColliderHandle, Real>,
        pairs: &mut Vec<Candidate>,
    ) {
        let mut pushes = pushes(pairs);
        for (collider, way) in driven {
            *pushes.entry(*collider).or_insert(0.0) += way;
        }
        let Some(most) = pushes.values().copied().reduce(Real::max) else { return };
        let way = |near: &Near<'_>| pushes.get(&near.handle).copied();
        for (index, solid) in self.solids.iter().enumerate() {
            let Some(way) = way(solid) else { continue };
            for (_, other) in self.solids_in(&solid.bounds.loosened(way)).filter(|(other, _)| *other != index)
            {
                push(permission, [solid, other], Real::MIN_POSITIVE..=way, pairs);
            }
        }
        for other in &self.others {
            for (_, solid) in self.solids_in(&other.bounds.loosened(most)) {
                let pushed = [way(solid), way(other)].into_iter().flatten();
                if let Some(way) = pushed.reduce(Real::max) {
                    push(permission, [solid, other], Real::MIN_POSITIVE..=way, pairs);
                }
            }
        }
    }
}

/// How far (m) each collider of `pairs` may be pushed in the step beyond its own way: as far as the fastest that may touch it moves
/// relative to it. What is slow is left out.
fn pushes(pairs: &[Candidate]) -> HashMap<ColliderHandle, Real> {
    let mut pushes: HashMap<ColliderHandle, Real> = HashMap::new();
    for pair in pairs {
        let [a, b] = pair.displacements;
        let way = a.reach(&b, pair.size) as Real;
        if way > SLOW * pair.size {
            for collider in pair.colliders {
                let most = pushes.entry(collider).or_insert(0.0);
                *most = most.max(way);
            }
        }
    }
    pushes
}

/// Ways, in parts of the smaller collider's size, by which nothing is pushed into what it did not touch before: next to it, boxes overlap.
/// Not tuned.
const SLOW: Real = 0.01;

/// Pose of a collider after all changes that the user made since the last step, and its motion in the next.
fn motion(world: &WorldParts<'_>, collider: &Collider) -> (Pose, Displacement) {
    let parent = collider.parent().and_then(|parent| world.bodies.get(parent));
    let (Some(body), Some(local)) = (parent, collider.position_wrt_parent()) else {
        return (*collider.position(), Displacement::default());
    };
    (*body.position() * *local, Displacement::of(body, world.integration_parameters.dt))
}

struct Near<'a> {
    handle: ColliderHandle,
    collider: &'a Collider,
    pose: Pose,
    displacement: Displacement,
    bounds: Aabb,
}

/// Adds a pair that may touch, if its boxes are as far apart as `distances` allow (m).
fn push(
    permission: &Permission<'_>,
    [a, b]: [&Near<'_>; 2],
    distances: RangeInclusive<Real>,
    pairs: &mut Vec<Candidate>,
) {
    let (a, b) = if a.handle.into_raw_parts() < b.handle.into_raw_parts() { (a, b) } else { (b, a) };
    let clearance = gap(&a.bounds, &b.bounds);
    if distances.contains(&clearance) && permission.allows((a.handle, a.collider), (b.handle, b.collider)) {
        pairs.push(Candidate {
            colliders: [a.handle, b.handle],
            poses: [a.pose, b.pose],
            displacements: [a.displacement, b.displacement],
            size: longest_side(a.collider.shape()).min(longest_side(b.collider.shape())),
            touched: false,
            clearance,
            is_distant: clearance > 0.0,
            is_driven: false,
            was_apart: false,
            is_at_end: false,
        });
    }
}

/// Distance (m) of two boxes along the axis along which it is largest; 0 where they overlap.
fn gap(a: &Aabb, b: &Aabb) -> Real {
    (a.mins - b.maxs).max(b.mins - a.maxs).max_element().max(0.0)
}

/// Longest side (m) of the box around a shape, in its own frame.
pub(crate) fn longest_side(shape: &dyn Shape) -> Real {
    shape.compute_local_aabb().extents().max_element()
}
