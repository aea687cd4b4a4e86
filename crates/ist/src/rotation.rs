//! Rotations by IEEE operations in a fixed order, which every platform rounds alike.
//!
//! glam adds up the components of an f32 quaternion in the order that suits the processor's vectors, and takes sine and
//! cosine from the platform's library.

use glam::{DQuat, DVec3};
use glamx::Rot3;

/// A unit quaternion from one that is near unit length, as an integrated rotation is; `None` otherwise.
pub(crate) fn unit(rotation: Rot3) -> Option<Rot3> {
    let [x, y, z, w] = rotation.to_array();
    let length = libm::sqrtf(x * x + y * y + z * z + w * w);
    // False for NaN as well.
    let near = length > 0.5 && length < 2.0;
    near.then(|| Rot3::from_xyzw(x / length, y / length, z / length, w / length))
}

/// As [`unit`], in f64.
pub(crate) fn unit_f64(rotation: Rot3) -> Option<DQuat> {
    unit(rotation).map(|_| rotation.as_dquat().normalize())
}

/// The rotation about `v` by its length (rad).
pub(crate) fn about(v: DVec3) -> DQuat {
    let angle = v.length();
    let (sin, cos) = libm::sincos(0.5 * angle);
    // Also right for an angle whose square is too small for f64.
    let axis = if angle > 0.0 { v * (sin / angle) } else { 0.5 * v };
    DQuat::from_xyzw(axis.x, axis.y, axis.z, cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn far_from_unit_length_there_is_no_rotation() {
        for length in [0.0, 0.5, 2.0, f32::INFINITY, f32::NAN] {
            assert_eq!(unit(Rot3::from_xyzw(0.0, length, 0.0, 0.0)), None, "{length}");
        }
        assert_eq!(unit(Rot3::from_xyzw(0.0, 0.0, 1.5, 0.0)), Some(Rot3::from_xyzw(0.0, 0.0, 1.0, 0.0)));
    }

    #[test]
    fn small_turns_are_not_lost() {
        for angle in [0.0, 1e-300, 1e-160, 1e-20] {
            assert_eq!(about(DVec3::Y * angle), DQuat::from_xyzw(0.0, 0.5 * angle, 0.0, 1.0), "{angle}");
        }
    }

    proptest! {
        #[test]
        fn rotations_are_those_of_glam(v in prop::array::uniform3(-9.0_f64..9.0), stretch in 0.6_f32..1.6) {
            let v = DVec3::from_array(v);
            let expected = DQuat::from_scaled_axis(v);
            prop_assert!((about(v) - expected).length() < 1e-15);
            let expected = expected.as_quat();
            prop_assert!((unit(expected * stretch).unwrap() - expected).length() < 3e-7);
            prop_assert!((unit_f64(expected * stretch).unwrap() - expected.as_dquat()).length() < 3e-7);
        }
    }
}
