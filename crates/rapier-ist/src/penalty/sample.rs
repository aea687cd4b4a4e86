//! The force law at one contact sample.

use super::twist::Screw;
use rapier3d::glamx::DVec3;

/// Most steps to the velocity of a given force: it is only where the next tangent is taken.
///
/// With 20 the force there is right to 1 % for forces from a thousandth of k V to thirty times it (test below). Few samples need
/// more than four; where the first step goes far beyond the root each of the next takes a third of the way back.
const NEWTON_STEPS: usize = 20;

/// Or until the root of the force is right to this share.
const NEWTON_TOLERANCE: f64 = 1e-3;

/// A contact sample with its force as a function of the normal velocity `u` at the end of the step.
///
/// `f(u) = k V x² (1 − δ (u − s))` with `x = 1 + h (u* − u) / 2D`, where V and D are the volume of the sample and the depth
/// of its patch at the poses that the velocity u* leads to: the volume of a shallow contact grows with the square of
/// its depth. `(1 − δ u)` is the dissipation of K. Hunt and F. Crossley, *Coefficient of restitution interpreted
/// as damping in vibroimpact* (1975). The force never pulls.
///
/// Where the patch slides, its samples go up and down the bumps that spheres are, with the normal velocities s. The patch as a whole
/// neither approaches nor separates by that, and nothing is dissipated: frictionless bodies would be braked by it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// From the origin of the pair (m).
    pub(crate) arm: DVec3,
    pub(crate) normal: DVec3,
    /// k V, the force at the predicted poses (N).
    pub(crate) push: f64,
    /// h/D (s/m); zero for a force that does not depend on where the step leads.
    pub(crate) rate: f64,
    /// Normal velocity that led to the predicted poses, u* (m/s).
    pub(crate) moved: f64,
    /// δ (s/m).
    pub(crate) dissipation: f64,
    /// Normal velocity that the sliding of the patch gives, s (m/s).
    pub(crate) sliding: f64,
    /// Velocity relative to the first body at which the force was last linearised (m/s).
    pub(crate) velocity: DVec3,
    /// Normal force at that velocity (N), and minus its derivative by the normal velocity (N·s/m).
    pub(crate) force: f64,
    pub(crate) damping: f64,
    /// Friction over slip, as last linearised (N·s/m).
    pub(crate) drag: f64,
}

impl Sample {
    /// Linearises the force at `velocity`.
    pub(crate) fn linearize_at(&mut self, velocity: DVec3) {
        self.velocity = velocity;
        (self.force, self.damping) = self.law(velocity.dot(self.normal));
    }

    /// Takes the force at the poses before the step instead, whatever the velocity at its end will be.
    pub(crate) fn take_force_before(&mut self) {
        let x = (1.0 + 0.5 * self.rate * self.moved).max(0.0);
        self.push *= x * x;
        self.rate = 0.0;
    }

    /// A force along the normal, about the origin of the pair.
    pub(crate) fn along_normal(&self, force: f64) -> Screw {
        let linear = self.normal * force;
        Screw { linear, angular: self.arm.cross(linear) }
    }

    /// Linearises the force anew after a solve that gave `velocity`. Returns the normal force that the last
    /// linearisation gives there, which may pull, and that of the law.
    ///
    /// Where it still pushes, the next tangent is taken where the law gives the solved force, and not at the solved
    /// velocity: loads are often known better than velocities, and Newton's method on x² halves x at each pass from far
    /// away.
    pub(crate) fn update(&mut self, velocity: DVec3) -> (f64, f64) {
        let u = velocity.dot(self.normal);
        let before = self.velocity.dot(self.normal);
        let solved = if self.force > 0.0 { self.force + self.damping * (before - u) } else { 0.0 };
        let (law, _) = self.law(u);
        let at = if solved > 0.0 { self.velocity_of(solved, u) } else { u };
        self.linearize_at(velocity + self.normal * (at - u));
        (solved, law)
    }

    /// Distance of the poses that `velocity` leads to from those at which the sample was measured, along the normal and
    /// in units of the depth.
    pub(crate) fn strain(&self, velocity: DVec3) -> f64 {
        self.rate * (self.moved - velocity.dot(self.normal)).abs()
    }

    /// Velocity across the normal.
    pub(crate) fn slip(&self) -> DVec3 {
        self.velocity - self.normal * self.velocity.dot(self.normal)
    }

    /// Force at `u` and minus its derivative, which is never negative.
    fn law(&self, u: f64) -> (f64, f64) {
        let x = 1.0 + 0.5 * self.rate * (self.moved - u);
        let y = 1.0 - self.dissipation * (u - self.sliding);
        if x <= 0.0 || y <= 0.0 {
            return (0.0, 0.0);
        }
        (self.push * x * x * y, self.push * x * (self.rate * y + self.dissipation * x))
    }

    /// The normal velocity at which the law gives `force`, positive (N), looked for from `near` on.
    ///
    /// With `w = √(1 − δ (u − s))`, `g = √(f / k V)` and x linear in w² this is the root of the cubic `w (A + B w²) = g`,
    /// convex and rising where x is positive: Newton's method falls towards it after the first step. The root of x²
    /// alone where δ is zero; and where the force does not depend on the velocity, `near`.
    pub(crate) fn velocity_of(&self, force: f64, near: f64) -> f64 {
        if self.push <= 0.0 || self.rate <= 0.0 && self.dissipation <= 0.0 {
            return near;
        }
        let goal = (force / self.push).sqrt();
        if self.dissipation <= 0.0 {
            return self.moved + 2.0 * (1.0 - goal) / self.rate;
        }
        let b = 0.5 * self.rate / self.dissipation;
        let a = 1.0 + 0.5 * self.rate * (self.moved - self.sliding) - b;
        // From `near` on, if x is positive there; else from where nothing is dissipated, or from where x becomes positive.
        let least = -a / b;
        let square = 1.0 - self.dissipation * (near - self.sliding);
        let mut w = if square > least && square > 0.0 { square } else { least.max(1.0) }.sqrt();
        for _ in 0..NEWTON_STEPS {
            let square = w * w;
            let residual = w * (a + b * square) - goal;
            if residual.abs() <= NEWTON_TOLERANCE * goal {
                break;
            }
            w -= residual / (a + 3.0 * b * square);
        }
        self.sliding + (1.0 - w * w) / self.dissipation
    }

    /// The normal velocity at which the sample's patch alone would stop bodies whose normal velocity is `free`
    /// without contact: the root of `u − free = h k V x² / m`, with `gain = h k V / m` for the volume of the patch
    /// and the bodies' effective mass. A good place for the first tangent.
    pub(crate) fn guess(&self, gain: f64, free: f64) -> f64 {
        if self.rate <= 0.0 {
            return free;
        }
        // With u = u* + 2 (1 − x) / rate this is gain x² + 2 x / rate − c = 0.
        let c = self.moved + 2.0 / self.rate - free;
        if c <= 0.0 {
            return free;
        }
        let b = 1.0 / self.rate;
        let x = c / (b + (b * b + gain * c).sqrt());
        self.moved + 2.0 * (1.0 - x) / self.rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sample(rate: f64, moved: f64, dissipation: f64, sliding: f64) -> Sample {
        Sample {
            arm: DVec3::ZERO,
            normal: DVec3::Y,
            push: 7.0,
            rate,
            moved,
            dissipation,
            sliding,
            velocity: DVec3::ZERO,
            force: 0.0,
            damping: 0.0,
            drag: 0.0,
        }
    }

    proptest! {
        /// A pile of a hundred gears burst within a step: one sample had a damping of −190 N·s/m. And a gear went 2 cm into a nut
        /// without a force, as it arrived faster than the dissipation was made for.
        #[test]
        fn issue_faster_approach_never_takes_force_away(
            (rate, moved, dissipation) in (1e-2_f64..1e3, -5.0_f64..5.0, 0.0_f64..50.0), u in -50.0_f64..50.0,
            faster in 0.0_f64..50.0, sliding in -5.0_f64..5.0,
        ) {
            let sample = sample(rate, moved, dissipation, sliding);
            let ((force, damping), more) = (sample.law(u), sample.law(u - faster).0);
            prop_assert!(force >= 0.0 && damping >= 0.0, "{force} {damping}");
            prop_assert!(more >= force * (1.0 - 1e-12), "{more} after {force}");
        }

        #[test]
        fn the_velocity_of_a_force_has_that_force(
            (rate, moved, dissipation) in (1e-2_f64..1e3, -5.0_f64..5.0, 0.0_f64..50.0),
            share in 1e-3_f64..30.0, near in -20.0_f64..20.0, sliding in -5.0_f64..5.0,
        ) {
            let sample = sample(rate, moved, dissipation, sliding);
            let force = share * sample.push;
            let found = sample.law(sample.velocity_of(force, near)).0;
            prop_assert!((found / force - 1.0).abs() < 1e-2, "{found} instead of {force}");
        }
    }
}
