//! Stiffness, friction and restitution of a pair.

use crate::candidates::longest_side;
use crate::modified_contacts::ModifiedContacts;
use crate::penalty::Material;
use crate::query::Contact;
use crate::stiffness::{StiffnessTable, valid};
use crate::{IstShape, Stiffness, StiffnessContext, VolumePenalty, WorldParts};
use rapier3d::dynamics::{CoefficientCombineRule, RigidBody};
use rapier3d::geometry::{Collider, Shape, ShapeType};
use rapier3d::glamx::DVec3;
use rapier3d::math::Real;

/// Stiffness of [`Stiffness::Automatic`] in units of weight per cubed size; see [`automatic_stiffness`].
///
/// With 5e4 the pile example (seeds 1 to 4) is asleep within 10 s and no exact mesh is deeper in another than 1.6 to
/// 2.2 % of the smaller body. Before contacts were measured
/// at the present velocity, 2e4 left up to 7.6 %, and from 2e5 on some bodies kept creeping at a few cm/s.
const RELATIVE_STIFFNESS: f64 = 5e4;

/// Longest side of a solid in thicknesses, see [`thickness`], beyond which it counts as slender: its stiffness follows from so many
/// thicknesses instead.
///
/// Heaps of 30 bars of 1 m × 5 cm, of 20 planks of 1 m × 20 cm × 2 cm and of twelve femurs of 1 m, three each: at rest, the greatest
/// depth of a patch is 34 to 61, 50 to 87 and 11 to 24 mm where stiffness follows from the longest side alone; with six thicknesses 5,
/// 11 to 34 and 5 to 7 mm, with 4.5 4, 8 to 16 and 4 to 5 mm, with three 2, 9 to 12 and 3 to 4 mm. They are at rest as soon, those of
/// bars and planks in a quarter to a half of the computing time. Stiff beams stand on the unevenness of their faces: eight layers of 6 cm are 13, 23 and 33 mm too
/// high then, and 40 mm too low before. Compact bodies are as before: a ring a fifth as thick as it is wide, and a disc a tenth, have 3.6.
const SLENDER: f64 = 4.5;

/// A contact that carries more than so many times the lighter body's weight is as much stiffer: at rest it overlaps by at most ten times
/// what the weight alone makes it.
///
/// Eight rings of 26 cm with tubes of 8, 4 and 2 cm hang from each other, the last of which is a hundred times as heavy as the others:
/// 20 mm longer, torn and torn without this; 7, 15 and 15 mm longer with 10, 9, 10 and 8 mm with 3. A thousand times as heavy, that of 8 cm
/// is torn without this, and 12 and 8 mm longer. With 10 most piles and stacks have no such contacts.
const HEAVY: f64 = 10.0;

/// Approach speed (m/s, times `length_unit`) under which nothing rebounds, so that resting bodies come to rest: a little
/// more than gravity adds in a step of 1/60 s. Not tuned.
const REBOUND_SPEED: f64 = 0.2;

/// Overlap pushes no faster than by the smaller body's longest side in this time (s).
///
/// A bunny of 0.2 m inside one of 1 m gets out of all 73 poses: at up to 18 rad/s with 0.4 s, 17 with 0.45 s and 14 with 0.5 s, the last
/// after 1.1, 1.2 and 1.3 s. With 0.5 s a ball on a hinge of a multibody bounces by a millimetre for ever.
const RECOVERY_TIME: f64 = 0.45;

/// Friction from which on more makes no difference: a slope this steep is a wall.
const MOST_FRICTION: Real = 100.0;

/// Stiffness from which on a contact is rigid, and the linear system only worse for it, in units of m/(h² L²), with
/// the lighter body's mass m, the time step h and the smaller body's size L. Balls of 0.1 m under 1e12 N/m³ are at 3e6.
const RIGID: f64 = 1e8;

/// What decides about the materials of pairs.
#[derive(Clone, Copy)]
pub(crate) struct ContactLaw<'a> {
    pub(crate) penalty: &'a VolumePenalty,
    pub(crate) stiffness: &'a StiffnessTable,
}

/// Material of a pair that has carried `carried` (N) of late, after Rapier's combine rules and the user's hook.
pub(crate) fn material(
    world: &WorldParts<'_>,
    contact: &Contact,
    carried: f64,
    law: ContactLaw<'_>,
) -> Material {
    let penalty = law.penalty;
    let [a, b] = contact.candidate.colliders.map(|handle| world.colliders[handle].material());
    let modified = ModifiedContacts::of(world, contact.candidate.colliders).unwrap_or_else(|| {
        let combine = CoefficientCombineRule::combine;
        ModifiedContacts {
            friction: combine(a.friction, b.friction, a.friction_combine_rule, b.friction_combine_rule),
            restitution: combine(
                a.restitution,
                b.restitution,
                a.restitution_combine_rule,
                b.restitution_combine_rule,
            ),
            tangent_velocity: DVec3::ZERO,
        }
    });
    let unit = f64::from(world.integration_parameters.length_unit);
    Material {
        stiffness: stiffness(world, contact, carried, law),
        dissipation: f64::from(penalty.dissipation),
        // NaN passes through a clamp.
        friction: modified.friction.clamp(0.0, MOST_FRICTION).max(0.0).into(),
        restitution: modified.restitution.clamp(0.0, 1.0).max(0.0).into(),
        tangent_velocity: modified.tangent_velocity,
        creep_speed: (f64::from(penalty.creep_speed) * unit).max(f64::MIN_POSITIVE),
        recovery_speed: (f64::from(penalty.recovery_speed) * unit)
            .min(f64::from(contact.candidate.size) / RECOVERY_TIME)
            .max(f64::MIN_POSITIVE),
        rebound_speed: REBOUND_SPEED * unit,
    }
}

/// Stiffness (N/m³) of a pair: the callback's, else the colliders' own, else the model's.
fn stiffness(world: &WorldParts<'_>, contact: &Contact, carried: f64, law: ContactLaw<'_>) -> f64 {
    let [collider_a, collider_b] = contact.candidate.colliders;
    let stiffness =
        law.stiffness.of_colliders([collider_a, collider_b]).unwrap_or_else(|| match law.penalty.stiffness {
            Stiffness::Automatic => automatic_stiffness(world, contact, carried),
            Stiffness::Uniform(stiffness) => valid(stiffness),
        });
    let parent = |collider| world.colliders.get(collider).and_then(Collider::parent);
    let stiffness = law.stiffness.of_pair(stiffness, |stiffness| StiffnessContext {
        bodies: world.bodies,
        colliders: world.colliders,
        collider_a,
        collider_b,
        body_a: parent(collider_a),
        body_b: parent(collider_b),
        volume: contact.samples.iter().map(|s| s.volume).sum(),
        stiffness,
    });
    let (dt, size) = (f64::from(world.integration_parameters.dt), f64::from(contact.candidate.size));
    stiffness.min(RIGID * lighter_mass(world, contact) / (dt * dt * size * size))
}

/// Stiffness (N/m³) at which the lighter body's weight makes it sink by a small share of the smaller body's size L:
/// weight = k A d, with the contact's cross-section A and depth d in units of L² and L.
fn automatic_stiffness(world: &WorldParts<'_>, contact: &Contact, carried: f64) -> f64 {
    let unit = f64::from(world.integration_parameters.length_unit);
    // Without gravity something must stop a body all the same: a metre per second squared, in units of length.
    let gravity = f64::from(world.gravity.length()).max(unit);
    let [a, b] = contact.candidate.colliders.map(|handle| size(world.colliders[handle].shape()));
    let weight = (lighter_mass(world, contact) * gravity).max(carried / HEAVY);
    let stiffness = RELATIVE_STIFFNESS * weight / a.min(b).powi(3);
    if stiffness.is_finite() { stiffness } else { 0.0 }
}

/// Size (m) of a shape: the longest side of its box, in its own frame, and less if it is slender.
fn size(shape: &dyn Shape) -> f64 {
    let longest = f64::from(longest_side(shape));
    thickness(shape, longest).map_or(longest, |thickness| longest.min(SLENDER * thickness))
}

/// Thickness (m) of the square bar that is as long as the longest side of the shape's box and has its volume; `None` for shapes
/// whose volume takes time in proportion to their size, or that have none.
fn thickness(shape: &dyn Shape, longest: f64) -> Option<f64> {
    let thickness = (volume(shape)? / longest).sqrt();
    (thickness > 0.0 && thickness.is_finite()).then_some(thickness)
}

/// Volume (m³) of a shape, where that is found at once.
fn volume(shape: &dyn Shape) -> Option<f64> {
    if let Some(solid) = shape.as_shape::<IstShape>() {
        return Some(solid.tree().solid().volume);
    }
    if let Some(compound) = shape.as_compound() {
        return compound.shapes().iter().map(|(_, part)| volume(&**part)).sum();
    }
    let is_simple = matches!(
        shape.shape_type(),
        ShapeType::Ball
            | ShapeType::Cuboid
            | ShapeType::Capsule
            | ShapeType::Cylinder
            | ShapeType::Cone
            | ShapeType::RoundCuboid
            | ShapeType::RoundCylinder
            | ShapeType::RoundCone
    );
    is_simple.then(|| shape.mass_properties(1.0).mass().into())
}

/// Mass (kg) of the lighter body of a pair that contacts move; infinite where they move none.
///
/// A body without mass, or held in all directions, carries like a fixed one, however light it is. Where both are held but can turn,
/// their masses count all the same: nothing else tells how strong wheels on fixed axles are.
fn lighter_mass(world: &WorldParts<'_>, contact: &Contact) -> f64 {
    let lightest = |counts: fn(&RigidBody) -> bool| {
        let body = |handle| world.bodies.get(world.colliders.get(handle)?.parent()?);
        let masses = contact.candidate.colliders.into_iter().filter_map(body);
        let masses = masses.filter(|body| body.is_dynamic() && body.mass() > 0.0 && counts(body));
        masses.map(|body| f64::from(body.mass())).fold(f64::INFINITY, f64::min)
    };
    let moved = lightest(|body| body.mass_properties().effective_inv_mass.max_element() > 0.0);
    if moved.is_finite() { moved } else { lightest(|_| true) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ist::{InnerSphere, SolidProperties, SpherePacking};
    use rapier3d::geometry::SharedShape;
    use rapier3d::math::{Pose, Vector};

    /// A solid of volume `volume` (m³) with two spheres 1 m apart at its ends.
    fn solid(volume: f64, radius: f32) -> IstShape {
        let ball = |x| InnerSphere::solid_ball(Vector::X * x, radius, Vector::Y);
        let spheres = vec![ball(radius - 0.5), ball(0.5 - radius)];
        let packing = SpherePacking::new(spheres, SolidProperties { volume, ..SolidProperties::ball(0.5) });
        IstShape::from_packing(&packing.expect("two balls apart are a packing"))
    }

    #[test]
    fn slender_shapes_are_as_stiff_as_they_are_thick() {
        let cuboid = SharedShape::cuboid;
        let bar = cuboid(0.5, 0.05, 0.05);
        // A table on four legs.
        let legs = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)]
            .map(|(x, z)| (Pose::translation(x, 0.0, z), cuboid(0.02, 0.4, 0.02)));
        let top = (Pose::translation(0.0, 0.4, 0.0), cuboid(1.0, 0.02, 1.0));
        let table = SharedShape::compound(legs.into_iter().chain([top]).collect());
        let volume = 4.0 * 0.04 * 0.8 * 0.04 + 2.0 * 0.04 * 2.0;
        for (shape, expected) in [
            (SharedShape::ball(0.5), 1.0),
            (cuboid(0.5, 0.5, 0.5), 1.0),
            (cuboid(0.5, 0.2, 0.2), 1.0),
            (bar.clone(), 4.5 * 0.1),
            (cuboid(0.05, 0.5, 0.05), 4.5 * 0.1),
            (cuboid(50.0, 0.5, 0.5), 4.5),
            (SharedShape::capsule_y(0.5, 1e-9), 0.0),
            (table, 4.5 * (volume / 2.04_f64).sqrt()),
            (SharedShape::new(solid(0.1, 0.1)), 1.0),
            (SharedShape::new(solid(0.01, 0.1)), 4.5 * 0.1),
            // Without a volume, or with one that takes time.
            (SharedShape::segment(Vector::ZERO, Vector::X), 1.0),
            (
                SharedShape::round_convex_hull(&[Vector::ZERO, Vector::X, Vector::Y, Vector::Z], 0.0)
                    .expect("a tetrahedron"),
                1.0,
            ),
        ] {
            let size = size(&*shape.0);
            assert!(
                (size - expected).abs() < 1e-3 * expected.max(1e-3),
                "{:?}: {size}, wanted {expected}",
                shape.shape_type()
            );
        }
        let twice = solid(0.01, 0.1).scaled(2.0).expect("a scale that f32 bears");
        assert!((size(&twice) - 2.0 * 4.5 * 0.1).abs() < 1e-3);
    }
}
