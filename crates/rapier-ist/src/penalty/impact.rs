//! How a contact began, and its rebound.
//!
//! A stiff contact stops the bodies within a step, at the place where they touch; they rebound in the next one, from there.
//! A rebound at once would begin up to a step's way above the surface, and end higher than it should.

use super::material::Material;

/// How a contact began.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Impact {
    /// Speed of approach (m/s); zero for bodies that began to overlap slowly.
    pub(crate) speed: f64,
    /// Whether the rebound of a stiff contact was given.
    pub(crate) rebounded: bool,
}

impl Impact {
    /// The same contact before a step with the mean speed of approach `approach`; impacts are faster than `least` (m/s).
    pub(crate) fn approached(self, approach: f64, least: f64) -> Self {
        if approach <= least {
            self
        } else if self.rebounded {
            Self { speed: approach, rebounded: false }
        } else {
            Self { speed: self.speed.max(approach), ..self }
        }
    }

    /// Least normal velocity at the end of a step of a contact that rebounds now, if it does.
    ///
    /// `normal_speeds` are the mean normal velocities before the step and at its end without contact, `end` the one at its
    /// end as last solved: bodies that were stopped in the step before, or early in this one, rebound. A body that moves
    /// through the step at its final velocity gains half a step's acceleration too much, which is taken off.
    pub(crate) fn rebound(&self, material: &Material, [before, free]: [f64; 2], end: f64) -> Option<f64> {
        let stopped = before > -0.5 * self.speed || end > -0.25 * self.speed;
        let speed = material.restitution * self.speed + 0.5 * (free - before);
        (self.speed > 0.0 && !self.rebounded && stopped && speed > 0.0).then_some(speed)
    }

    /// The same contact after a step that ends with the mean normal velocity `end`; `rebounds` where that was the rebound.
    pub(crate) fn after(self, [before, free]: [f64; 2], end: f64, rebounds: bool) -> Self {
        if self.speed <= 0.0 {
            return self;
        }
        // Stopped on the way, bodies touch after the share of the step that end/before says, and until then get faster.
        let arrives = -before >= self.speed && free < before;
        let share = if arrives { (end / before).clamp(0.0, 1.0) } else { 0.0 };
        Self { speed: self.speed + share * (before - free).max(0.0), rebounded: self.rebounded || rebounds }
    }
}
