//! The linearly implicit volume penalty.
//!
//! Contact samples of body pair (a, b), with unit normals n (a→b) and volumes V, are measured at the poses that the
//! bodies would reach in a step of length h. The force at the *end* of the step is a function of the velocities there,
//! `f = k V (1 + h/2D n·(u* − u'))² (1 − δ n·u')`, with the relative velocities u' at the end of the step and u* that led to
//! the predicted poses, and the depth D of the patch that the sample belongs to (volume over cross-section, see
//! [`patch`] and [`sample`]). With tangents of f and friction `μ f / max(|u_t|, u_creep)` across the normals the final
//! velocities solve
//!
//! `(M + h Σ Jᵀ K J) v' = M v* + h Σ Jᵀ r`, `v* = v + h M⁻¹ (gravity and other forces)`,
//!
//! which is symmetric positive definite: stable at any stiffness and any time step, where the explicit penalty
//! explodes. A contact whose force would pull drops out; that, the tangents and the friction coefficient are found by a
//! few passes. Every island of touching bodies is solved by itself with preconditioned conjugate gradients.
//!
//! After D. Baraff and A. Witkin, *Large steps in cloth simulation* (SIGGRAPH 1998), for contact.

mod body;
mod impact;
mod island;
mod material;
mod pair;
mod patch;
mod patch_sum;
mod sample;
mod system;
mod twist;

pub(crate) use body::SolverBody;
pub(crate) use impact::Impact;
pub(crate) use island::islands;
pub(crate) use material::Material;
pub(crate) use pair::PairContacts;
pub(crate) use system::Island;
pub(crate) use twist::Screw;

/// Most passes over contacts and friction.
const MAX_PASSES: usize = 8;

/// Passes end when the normal forces of no pair changed by more than this share of their sum.
const PASS_TOLERANCE: f64 = 1e-3;

impl Island {
    /// Finds the velocities at the end of a step of `dt` seconds; contact wrenches are then those of
    /// [`PairContacts::wrench`] and [`PatchSum::wrench`](patch_sum::PatchSum::wrench) at [`Island::final_twists`].
    pub(crate) fn solve(&mut self, dt: f64) {
        for _ in 0..MAX_PASSES {
            self.pairs.iter_mut().for_each(PairContacts::linearize);
            self.solve_linear(dt);
            let twists = self.final_twists();
            let change = |(pair, twist): (&mut PairContacts, Screw)| pair.update(twist);
            if self.pairs.iter_mut().zip(twists).map(change).fold(0.0, f64::max) < PASS_TOLERANCE {
                break;
            }
        }
    }
}
