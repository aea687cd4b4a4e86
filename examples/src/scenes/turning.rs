//! How far a body has turned about the y axis.

use rapier3d::math::Rotation;
use std::f64::consts::{PI, TAU};

/// Adds up the turns of a body that turns by less than half a turn per step.
#[derive(Clone, Copy, Debug)]
pub struct Turning {
    last: f64,
    total: f64,
}

impl Turning {
    /// Begins to count at `rotation`.
    #[must_use]
    pub fn new(rotation: &Rotation) -> Self {
        Self { last: angle(rotation), total: 0.0 }
    }

    /// The body now has `rotation`.
    pub fn update(&mut self, rotation: &Rotation) {
        let now = angle(rotation);
        self.total += (now - self.last + PI).rem_euclid(TAU) - PI;
        self.last = now;
    }

    /// Angle since the beginning (rad), right-handed about y.
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.total
    }
}

/// The angle about y of a rotation split into one about an axis across y and then one about y (rad).
fn angle(rotation: &Rotation) -> f64 {
    2.0 * f64::from(rotation.y).atan2(f64::from(rotation.w))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn turns_add_up_either_way_and_tilt_does_not_matter() {
        for step in [-2.9_f32, -0.3, 0.0, 0.7, 3.0] {
            for tilt in [0.0, 0.05] {
                let rotation =
                    |i: u16| Quat::from_rotation_y(1.0 + step * f32::from(i)) * Quat::from_rotation_x(tilt);
                let mut turning = Turning::new(&rotation(0));
                (1..=40).for_each(|i| turning.update(&rotation(i)));
                let error = turning.angle() - f64::from(step) * 40.0;
                assert!(error.abs() < 1e-3, "{step} {tilt}: {error}");
            }
        }
    }
}
