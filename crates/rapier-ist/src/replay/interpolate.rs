//! Poses between two steps.

use rapier3d::math::{Pose, Real};

/// The pose a `share` of the way from one pose to the next: translation on a line, rotation at constant speed about one
/// axis, the shorter way round (K. Shoemake, *Animating rotation with quaternion curves*, SIGGRAPH 1985).
pub(super) fn interpolate(from: &Pose, to: &Pose, share: Real) -> Pose {
    let rotation = from.rotation.slerp(to.rotation, share).normalize();
    Pose::from_parts(from.translation.lerp(to.translation, share), rotation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rapier3d::math::{Rotation, Vector};

    #[test]
    fn turns_evenly_the_shorter_way() {
        let from = Pose::from_parts(Vector::ZERO, Rotation::from_rotation_y(0.2));
        let turned = Rotation::from_rotation_y(1.4);
        for to in [turned, -turned] {
            let to = Pose::from_parts(Vector::new(4.0, 0.0, 2.0), to);
            for share in [0.0, 0.25, 0.5, 1.0] {
                let pose = interpolate(&from, &to, share);
                let expected = Rotation::from_rotation_y(0.2 + 1.2 * share);
                assert!(pose.rotation.angle_between(expected) < 1e-3);
                assert!(pose.translation.distance(Vector::new(4.0, 0.0, 2.0) * share) < 1e-6);
            }
        }
    }
}
