//! Bodies and colliders from bytes.

use crate::fuzzing::numbers::{below, finite_float, moderate, moderate_vector, pose, power_of_two, raw};
use crate::fuzzing::solids::packing;
use arbitrary::Unstructured;
use rapier_ist::IstShape;
use rapier3d::prelude::*;

/// Whether a scene has numbers of any size.
#[derive(Clone, Copy)]
pub(super) struct Extremes(pub(super) bool);

impl Extremes {
    /// A velocity or force.
    pub(super) fn vector(self, u: &mut Unstructured) -> Vector {
        if self.0 {
            return Vector::new(finite_float(u), finite_float(u), finite_float(u));
        }
        moderate_vector(u)
    }

    /// A positive number.
    fn positive(self, u: &mut Unstructured) -> Real {
        if self.0 { finite_float(u).abs() } else { power_of_two(u, 6) }
    }
}

pub(super) fn body_type(u: &mut Unstructured) -> RigidBodyType {
    match below(u, 8) {
        0 => RigidBodyType::Fixed,
        1 => RigidBodyType::KinematicPositionBased,
        2 => RigidBodyType::KinematicVelocityBased,
        _ => RigidBodyType::Dynamic,
    }
}

pub(super) fn body(u: &mut Unstructured, extremes: Extremes) -> RigidBodyBuilder {
    let body = RigidBodyBuilder::new(body_type(u)).pose(pose(u, 1.0)).ccd_enabled(below(u, 8) == 0);
    let body = body.linvel(extremes.vector(u)).angvel(extremes.vector(u));
    match below(u, 4) {
        0 => body.gravity_scale(moderate(u)).linear_damping(moderate(u).abs()),
        1 => body.locked_axes(LockedAxes::from_bits_truncate(raw(u))),
        2 => body.dominance_group(raw(u)).sleeping(raw(u)),
        _ => body,
    }
}

pub(super) fn collider(u: &mut Unstructured, extremes: Extremes) -> ColliderBuilder {
    let size = 0.1 + moderate(u).abs() * 0.25;
    let builder = match below(u, 12) {
        0 => ColliderBuilder::ball(size),
        1 => ColliderBuilder::cuboid(size, 0.5 * size, 2.0 * size),
        2 => ColliderBuilder::capsule_y(size, 0.5 * size),
        3 => ColliderBuilder::new(SharedShape::halfspace(Vector::Y)),
        4 => tetrahedron(size),
        5 => {
            let parts = [0.0, size].map(|x| (Pose::translation(x, 0.0, 0.0), SharedShape::ball(size)));
            ColliderBuilder::compound(parts.to_vec())
        }
        _ => tree(u, size, extremes),
    };
    let builder = match below(u, 4) {
        0 => builder.mass(extremes.positive(u)),
        _ => builder.density(100.0 * extremes.positive(u)),
    };
    let builder = match below(u, 6) {
        0 => builder.friction(moderate(u).abs()).restitution(moderate(u).abs() / 8.0),
        1 => builder.contact_skin(0.01 * moderate(u).abs()),
        2 => builder.sensor(true),
        3 => builder.position(pose(u, 0.5)),
        _ => builder,
    };
    if extremes.0 && below(u, 4) == 0 {
        return builder.friction(finite_float(u)).restitution(finite_float(u));
    }
    builder
}

/// A closed mesh of four triangles.
fn tetrahedron(size: Real) -> ColliderBuilder {
    let corners = [Vector::ZERO, Vector::X, Vector::Y, Vector::Z].map(|v| v * size);
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    match SharedShape::trimesh(corners.to_vec(), triangles) {
        Ok(mesh) => ColliderBuilder::new(mesh),
        Err(_) => ColliderBuilder::ball(size),
    }
}

/// A tree of about the given size.
fn tree(u: &mut Unstructured, size: Real, extremes: Extremes) -> ColliderBuilder {
    let shape = IstShape::from_packing(&packing(u));
    let (center, radius) = shape.tree().bounding_ball();
    // Packings have the mass of a ball about their frame's origin that reaches as far as they do: it may be that of a moon.
    if !extremes.0 && center.length() > 4.0 * radius {
        return ColliderBuilder::ball(size);
    }
    let scale = size / radius;
    shape.scaled(scale).unwrap_or(shape).into_collider()
}
