//! Coulomb friction, and that of rebounds.

use super::damper_sum::DamperSum;
use super::material::Material;
use super::twist::{Screw, Symmetric6};
use rapier3d::glamx::DVec3;

/// Regularised Coulomb friction of a pair: below the creep speed it is viscous.
pub(super) struct Friction {
    coefficient: f64,
    /// See [`Material`].
    creep_speed: f64,
    tangent_velocity: DVec3,
}

impl Friction {
    /// That of `material`, of which the pair has the share `grip`, between bodies that seem to part by `turning` (m/s) where they turn
    /// as one.
    pub(super) fn new(material: &Material, grip: f64, turning: DVec3) -> Self {
        let Material { friction, creep_speed, tangent_velocity, .. } = *material;
        Self { coefficient: friction * grip, creep_speed, tangent_velocity: tangent_velocity + turning }
    }

    /// The slip that friction works towards, across the unit vector `normal` (m/s).
    pub(super) fn wanted(&self, normal: DVec3) -> DVec3 {
        self.tangent_velocity.reject_from_normalized(normal)
    }

    /// Friction over slip (N·s/m) under the normal force `force` (N) at a slip of the given size (m/s).
    pub(super) fn drag(&self, force: f64, slip: f64) -> f64 {
        self.coefficient * force / slip.max(self.creep_speed)
    }
}

/// The impulse of a rebound, with the friction under it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rebound {
    /// On the second body, about the origin of the pair.
    pub(super) impulse: Screw,
    /// Direction of the impulse, or zero, and from the origin to the nearest point of its line of action.
    normal: DVec3,
    arm: DVec3,
    /// Slip as last solved (m/s).
    slip: DVec3,
    /// Friction over slip as last linearised (N·s/m).
    drag: f64,
}

impl Rebound {
    /// Of bodies that approach each other with the twist `before`.
    pub(super) fn new(impulse: Screw, before: Screw) -> Self {
        let normal = impulse.linear.normalize_or_zero();
        let arm = impulse.linear.cross(impulse.angular) / impulse.linear.length_squared();
        let arm = if arm.is_finite() { arm } else { DVec3::ZERO };
        let rebound = Self { impulse, normal, arm, slip: DVec3::ZERO, drag: 0.0 };
        Self { slip: rebound.slip(before), ..rebound }
    }

    fn slip(&self, twist: Screw) -> DVec3 {
        twist.twist_at(self.arm).linear.reject_from_normalized(self.normal)
    }

    /// Mean force in a step of `dt` seconds (N).
    fn force(&self, dt: f64) -> f64 {
        self.impulse.linear.length() / dt
    }

    /// Wrench on the second body at zero relative velocity, and what a relative twist takes away from it.
    pub(super) fn linearize(&mut self, friction: &Friction, dt: f64) -> (Screw, Symmetric6) {
        let wanted = friction.wanted(self.normal);
        self.drag = friction.drag(self.force(dt), (self.slip - wanted).length());
        let mut damper = DamperSum::ZERO;
        damper.add(self.normal, self.arm, [0.0, self.drag]);
        let dragged = wanted * self.drag;
        let wrench = self.impulse * (1.0 / dt) + Screw { linear: dragged, angular: self.arm.cross(dragged) };
        (wrench, damper.matrix())
    }

    /// Takes over the relative twist of a solve. Returns how far the friction of the law is from that of the linearised system, and
    /// the normal force (N).
    pub(super) fn update(&mut self, twist: Screw, friction: &Friction, dt: f64) -> (f64, f64) {
        self.slip = self.slip(twist);
        let slip = (self.slip - friction.wanted(self.normal)).length();
        let force = self.force(dt);
        ((friction.drag(force, slip) - self.drag).abs() * slip, force)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slip that is no number would hide from the end of passes what else changes.
    #[test]
    fn a_rebound_of_nothing_has_a_slip() {
        let approach = Screw { linear: DVec3::new(0.3, -2.0, 0.0), angular: DVec3::Z };
        let rebound = Rebound::new(Screw::ZERO, approach);
        assert!(rebound.slip.is_finite() && rebound.arm == DVec3::ZERO, "{rebound:?}");
    }
}
