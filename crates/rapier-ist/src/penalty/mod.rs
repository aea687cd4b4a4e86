//! The linearly implicit volume penalty.
//!
//! Contact samples of body pair (a, b), with unit normals n (a→b) and volumes V, are measured at the poses that the
//! bodies would reach in a step of length h. The force at the *end* of the step is a function of the velocities there,
//! `f = k V (1 + h/2D n·(u* − u'))² (1 − δ (n·u' − s))`, with the relative velocities u' at the end of the step and u* that led to
//! the predicted poses, the part s of n·u' that is sliding over bumps, and the depth D of the patch that the sample belongs to (volume over
//! cross-section, see [`patch`] and [`sample`]). Rebounds of several steps have the force at the beginning ([`resolved`]). With
//! tangents of f and friction `μ f / max(|u_t|, u_creep)` across the normals the final velocities solve
//!
//! `(M + h Σ Jᵀ K J) v' = M v* + h Σ Jᵀ r`, `v* = v + h M⁻¹ (gravity and other forces)`,
//!
//! which is symmetric positive definite: stable at any stiffness and any time step, where the explicit penalty
//! explodes. A contact whose force would pull drops out; that, the tangents and the friction coefficient are found by a
//! few passes. Every island of touching bodies is solved by itself with preconditioned conjugate gradients.
//!
//! After D. Baraff and A. Witkin, *Large steps in cloth simulation* (SIGGRAPH 1998), for contact.

mod block;
mod block_matrix;
mod body;
mod conjugate_gradients;
mod damper_sum;
mod elimination;
mod friction;
mod impact;
mod island;
mod joint;
mod material;
mod pair;
mod pair_state;
mod patch;
mod patch_sum;
mod placement;
mod resolved;
mod sample;
mod system;
mod twist;

pub(crate) use body::{SolverBody, symmetric, way_to_next_position};
pub(crate) use impact::Impact;
pub(crate) use island::{IslandJoint, Members, islands};
pub(crate) use joint::{JointForces, JointRow, JointWrench, RowKind, compliance};
pub(crate) use material::Material;
pub(crate) use pair::PairContacts;
pub(crate) use system::Island;
pub(crate) use twist::Screw;

/// Most passes over contacts and friction.
const MAX_PASSES: usize = 8;

/// Passes end when the forces of no pair changed by more than this share of the sum of the normal ones, or of the load where that is
/// larger. Friction counts: where it does not, what slides is held by 2 to 5 % too little, and just beyond the angle of friction it moves at
/// an eighth of its speed; solves of a pile of 100 gears then take a quarter less.
const PASS_TOLERANCE: f64 = 1e-3;

/// Pairs that one task takes: some 20 µs. A choice.
#[cfg(feature = "parallel")]
const PAIRS_PER_TASK: usize = 16;

impl Island {
    /// Finds the velocities at the end of a step of `dt` seconds; contact wrenches are then those of
    /// [`PairContacts::wrench`] and [`PatchSum::wrench`](patch_sum::PatchSum::wrench) at [`Island::final_twists`].
    pub(crate) fn solve(&mut self, dt: f64) {
        for _ in 0..MAX_PASSES {
            self.for_each_pair(|pair, _| {
                pair.linearize();
                0.0
            });
            self.joints.iter_mut().for_each(JointForces::linearize);
            self.solve_linear(dt);
            let change = self.for_each_pair(PairContacts::update);
            if change.max(self.update_joints()) < PASS_TOLERANCE {
                break;
            }
        }
    }

    /// Calls `act` with every pair and its twist as last solved, in parallel where there are many, and returns the largest
    /// result.
    fn for_each_pair(&mut self, act: impl Fn(&mut PairContacts, Screw) -> f64 + Sync) -> f64 {
        let twists = self.final_twists();
        #[cfg(feature = "parallel")]
        {
            use rayon::prelude::*;
            let pairs = self.pairs.par_iter_mut().with_min_len(PAIRS_PER_TASK).zip(twists);
            pairs.map(|(pair, twist)| act(pair, twist)).reduce(|| 0.0, f64::max)
        }
        #[cfg(not(feature = "parallel"))]
        self.pairs.iter_mut().zip(twists).map(|(pair, twist)| act(pair, twist)).fold(0.0, f64::max)
    }
}
