//! How a contact began, and its rebound.
//!
//! A stiff contact stops the bodies within a step, at the place where they touch; they rebound from there, in the next step or, if
//! they stop early in this one, by one more solve. A rebound at once would begin up to a step's way above the surface, and end
//! higher than it should.
//!
//! The impulse of the rebound is the restitution times the one that stopped the bodies (Poisson's hypothesis, W. J. Stronge,
//! *Impact Mechanics*, 2000, section 3.1), which makes no energy where a contact has many places and directions.

use super::material::Material;
use super::twist::Screw;

/// Share of the step's acceleration that a rebound starts with.
///
/// It moves through the step at its final velocity, and after it in Rapier's substeps. A ball with e = 0.5 dropped from 0.3 m
/// rises 5 % too high with 0.5 and 8 % too low with 1; from 1 m on either is within 4 %.
const ACCELERATION: f64 = 0.7;

/// Steps after which an impact that left overlap behind counts as over.
///
/// With 3 the kinetic energy of jacks that hit each other (e = 0) rises by 0.17 % of what it was in a step, with 10 by 0.02 %.
const IMPACT_STEPS: u32 = 10;

/// How a contact began.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Impact {
    /// Speed of approach (m/s); zero for bodies that began to overlap slowly.
    pub(crate) speed: f64,
    /// Normal impulse on the second body since then (N·s, N·m·s about the contact's origin).
    pub(crate) impulse: Screw,
    /// Energy that it took from the bodies (J).
    pub(crate) lost: f64,
    /// Whether it could stop the bodies within a step, in any step so far.
    pub(crate) stiff: bool,
    /// Whether the rebound of a stiff contact was given.
    pub(crate) rebounded: bool,
    /// Steps since the fastest approach.
    pub(crate) steps: u32,
}

/// A contact in a step, as far as rebounds are concerned.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImpactStep {
    /// Mean normal velocity before the step, and at its end without contact (m/s).
    pub(crate) before: f64,
    pub(crate) free: f64,
    /// Mean normal velocity at the end as last solved (m/s), negative infinity where it is not known.
    pub(crate) end: f64,
}

impl Impact {
    /// The same contact before a step with the mean speed of approach `approach`; impacts are faster than `least` (m/s).
    pub(crate) fn approached(self, approach: f64, least: f64) -> Self {
        if approach <= least {
            self
        } else if self.rebounded || approach > self.speed {
            Self { speed: approach, ..Self::default() }
        } else {
            self
        }
    }

    /// Whether the contact rebounds in a step: bodies that were stopped before it, and those that are stopped early in it.
    pub(crate) fn rebounds(&self, material: &Material, step: &ImpactStep) -> bool {
        let stopped = self.was_stopped(step) || step.end > -0.25 * self.speed;
        self.may_rebound(material) && stopped
    }

    /// Whether the contact rebounds once it is stopped.
    pub(crate) fn may_rebound(&self, material: &Material) -> bool {
        material.restitution > 0.0 && self.speed > 0.0 && !self.rebounded
    }

    /// The impulse of the rebound. `impulse` is what stopped the bodies including this step, as last solved; `compliance`
    /// (1/kg) the velocity along it that a unit impulse along it gives, and `[before, free]` the velocity along it before
    /// the step and at its end without contact.
    pub(crate) fn rebound(
        &self,
        material: &Material,
        step: &ImpactStep,
        (impulse, compliance): (Screw, f64),
        [before, free]: [f64; 2],
    ) -> Option<Screw> {
        let size = impulse.linear.length();
        // Along the impulse, bodies that give back no more than they had make no energy.
        let approach = if self.was_stopped(step) {
            // The impulse also carried weight while it stopped the bodies.
            (size * compliance).min(self.speed)
        } else {
            // What the impact was, where part of it was stopped in the step before.
            self.speed * before / step.before
        };
        let speed = material.restitution * approach + ACCELERATION * (free - before);
        let change = (speed - free).min(self.most(compliance, free));
        let rebound = impulse * ((change / compliance).max(0.0) / size);
        rebound.is_finite().then_some(rebound)
    }

    /// The greatest change of the velocity along an impulse that gives back no more than the energy that the impact took so far, whatever
    /// its parts were (m/s); the arguments as in [`Self::rebound`].
    pub(crate) fn most(&self, compliance: f64, free: f64) -> f64 {
        (free * free + 2.0 * compliance * self.lost.max(0.0)).sqrt() - free
    }

    /// The greatest share of an impulse, at most all of it, that gives back no more than the energy that the impact took so far: a share s
    /// gives `linear s + square s²` (J).
    pub(crate) fn share_of_lost(&self, [linear, square]: [f64; 2]) -> f64 {
        let (lost, given) = (self.lost.max(0.0), linear + square);
        if given <= lost || given.is_nan() {
            return 1.0;
        }
        let root = (linear * linear + 4.0 * square * lost).max(0.0).sqrt();
        // The form of the root that does not cancel.
        let share =
            if linear < 0.0 { (root - linear) / (2.0 * square) } else { 2.0 * lost / (linear + root) };
        // NaN where nothing was taken and nothing had to be.
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Whether it began with an impact a few steps ago at most.
    pub(crate) fn is_under_way(&self) -> bool {
        self.speed > 0.0 && self.steps <= IMPACT_STEPS
    }

    fn was_stopped(&self, step: &ImpactStep) -> bool {
        step.before > -0.1 * self.speed
    }

    /// The same contact after a step in which its normal forces had the impulse `impulse` and took the energy `lost`;
    /// `rebounds` where that was the rebound.
    pub(crate) fn after(self, step: &ImpactStep, (impulse, lost): (Screw, f64), rebounds: bool) -> Self {
        if self.speed <= 0.0 {
            return self;
        }
        // Stopped on the way, bodies touch after the share of the step that end/before says, and until then get faster.
        let arrives = -step.before >= self.speed && step.free < step.before;
        let share = if arrives { (step.end / step.before).clamp(0.0, 1.0) } else { 0.0 };
        Self {
            speed: self.speed + share * (step.before - step.free).max(0.0),
            impulse: self.impulse + impulse,
            lost: self.lost + lost,
            stiff: self.stiff,
            rebounded: self.rebounded || rebounds,
            steps: self.steps.saturating_add(1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_more_is_given_back_than_was_taken(
            linear in -10.0_f64..10.0, square in -10.0_f64..10.0, lost in -1.0_f64..10.0, zero in 0_u8..8,
        ) {
            let or_zero = |value: f64, bit: u8| if zero >> bit & 1 == 1 { 0.0 } else { value };
            let (linear, square, lost) = (or_zero(linear, 0), or_zero(square, 1), or_zero(lost, 2));
            let share = Impact { lost, ..Impact::default() }.share_of_lost([linear, square]);
            let given = |share: f64| share * (linear + square * share);
            let lost = lost.max(0.0);
            prop_assert!((0.0..=1.0).contains(&share));
            prop_assert!(given(share) <= lost + 1e-9, "{share} gives {} of {lost}", given(share));
            // And it is the greatest.
            if share < 1.0 {
                prop_assert!(given(share + 1e-6 * (1.0 + share)) > lost - 1e-9, "{share} is too little");
            }
        }
    }

    #[test]
    fn what_is_no_number_is_left_alone() {
        assert_eq!(Impact::default().share_of_lost([f64::NAN, 1.0]), 1.0);
    }
}
