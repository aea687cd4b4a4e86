//! Rapier's numbers as Foxglove's.

use foxglove::messages::{Color, Point3, Pose, Quaternion, Timestamp, Vector3};
use rapier3d::math::{Rotation, Vector};

const NANOSECONDS: u64 = 1_000_000_000;

/// A time since the start (ns).
pub(super) fn timestamp(nanoseconds: u64) -> Timestamp {
    let seconds = u32::try_from(nanoseconds / NANOSECONDS).unwrap_or(u32::MAX);
    Timestamp::new(seconds, (nanoseconds % NANOSECONDS) as u32)
}

pub(super) fn vector(v: Vector) -> Vector3 {
    Vector3 { x: v.x.into(), y: v.y.into(), z: v.z.into() }
}

pub(super) fn point(v: Vector) -> Point3 {
    Point3 { x: v.x.into(), y: v.y.into(), z: v.z.into() }
}

/// Normalised in double precision: the solver's quaternions are unit to single precision only.
pub(super) fn quaternion(rotation: Rotation) -> Quaternion {
    let q = rotation.as_dquat().normalize();
    Quaternion { x: q.x, y: q.y, z: q.z, w: q.w }
}

pub(super) fn identity() -> Pose {
    Pose { position: Some(Vector3::default()), orientation: Some(quaternion(Rotation::IDENTITY)) }
}

pub(super) fn color([r, g, b, a]: [f32; 4]) -> Color {
    Color { r: r.into(), g: g.into(), b: b.into(), a: a.into() }
}
