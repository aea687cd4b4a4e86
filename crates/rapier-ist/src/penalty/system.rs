//! The linear system of one island, and conjugate gradients on it.
//!
//! With `M⁻¹ = L Lᵀ` and the change of velocity `Δ = L y` the implicit step reads
//! `(I + h Lᵀ S L) y = h Lᵀ r`, where `S = Σ Jᵀ K J` over the pairs. That form is well defined for locked axes and
//! bodies of infinite mass, whose rows of L are zero, and it is preconditioned by the mass already.

use super::body::SolverBody;
use super::pair::PairContacts;
use super::twist::{Screw, Symmetric6};
use rapier3d::glamx::DMat3;

/// Relative residual at which the iteration stops. Forces are then right to about 1e-6, well under the rounding of
/// the poses they act on.
const TOLERANCE: f64 = 1e-7;

/// Or where that of every body is this share of what gravity and its own forces change in the step: 0.2 mm/s on Earth at 60 Hz.
///
/// A pile of 100 gears is asleep after 2.4 s with 1e-3 as with 1e-7 and solves take a third less; with 1e-2 it takes
/// 3.1 s.
const LOAD_TOLERANCE: f64 = 1e-3;

/// Most iterations; an island of n bodies needs no more than 6 n in exact arithmetic.
const MAX_ITERATIONS: usize = 400;

/// Bodies that touch, and their contacts.
#[derive(Debug)]
pub(crate) struct Island {
    pub(crate) bodies: Vec<SolverBody>,
    pub(crate) pairs: Vec<PairContacts>,
    /// `y` of each body.
    state: Vec<Screw>,
}

impl Island {
    pub(crate) fn new(bodies: Vec<SolverBody>, pairs: Vec<PairContacts>, state: Vec<Screw>) -> Self {
        Self { bodies, pairs, state }
    }

    /// `y` of body `i`, as last solved.
    pub(crate) fn state(&self, i: usize) -> Screw {
        self.state[i]
    }

    /// Twist of body `i` at the end of the step, as last solved.
    pub(crate) fn final_twist(&self, i: usize) -> Screw {
        self.bodies[i].predicted + self.bodies[i].root_times(self.state[i])
    }

    /// Solves with the pairs as they are linearised now, starting from the present state. Returns the number of
    /// iterations.
    pub(crate) fn solve_linear(&mut self, dt: f64) -> usize {
        let preconditioner = self.preconditioner(dt);
        let rhs = self.right_hand_side(dt);
        let image = self.image(&self.state, dt);
        let mut residual: Vec<Screw> = rhs.iter().zip(&image).map(|(rhs, image)| *rhs - *image).collect();
        let goal = TOLERANCE * TOLERANCE * dot(&rhs, &rhs);
        let mut z = apply(&preconditioner, &residual);
        let mut direction = z.clone();
        let mut rz = dot(&residual, &z);
        let mut iterations = 0;
        while iterations < MAX_ITERATIONS && !self.is_small(&residual) && dot(&residual, &residual) > goal {
            let image = self.image(&direction, dt);
            let curvature = dot(&direction, &image);
            if !(curvature > 0.0 && curvature.is_finite()) {
                break;
            }
            let step = rz / curvature;
            for i in 0..self.state.len() {
                self.state[i] += direction[i] * step;
                residual[i] = residual[i] - image[i] * step;
            }
            z = apply(&preconditioner, &residual);
            let next = dot(&residual, &z);
            let turn = next / rz;
            rz = next;
            for (d, z) in direction.iter_mut().zip(&z) {
                *d = *z + *d * turn;
            }
            iterations += 1;
        }
        iterations
    }

    /// Whether the residual of every body is a small share of its own load: a light body counts as much as a heavy one.
    fn is_small(&self, residual: &[Screw]) -> bool {
        let limit = LOAD_TOLERANCE * LOAD_TOLERANCE;
        let small = |(r, body): (&Screw, &SolverBody)| {
            !body.is_movable() || r.dot(*r) <= limit * body.unchanged.dot(body.unchanged)
        };
        residual.iter().zip(&self.bodies).all(small)
    }

    /// `h Lᵀ r`, where r are the wrenches at the predicted twists.
    fn right_hand_side(&self, dt: f64) -> Vec<Screw> {
        let mut out = vec![Screw::ZERO; self.bodies.len()];
        for pair in &self.pairs {
            let twist = pair.relative_twist(&self.bodies, |i| self.bodies[i].predicted);
            self.scatter(pair, pair.wrench(twist), &mut out);
        }
        for (out, body) in out.iter_mut().zip(&self.bodies) {
            *out = body.root_transpose_times(*out) * dt;
        }
        out
    }

    /// `(I + h Lᵀ S L) y`.
    fn image(&self, y: &[Screw], dt: f64) -> Vec<Screw> {
        let mut out = vec![Screw::ZERO; y.len()];
        for pair in &self.pairs {
            let twist = pair.relative_twist(&self.bodies, |i| self.bodies[i].root_times(y[i]));
            self.scatter(pair, *pair.damping() * twist, &mut out);
        }
        for (i, body) in self.bodies.iter().enumerate() {
            out[i] = y[i] + body.root_transpose_times(out[i]) * dt;
        }
        out
    }

    /// Adds the wrench that `pair` exerts on b, and its opposite on a, to the bodies' wrenches.
    fn scatter(&self, pair: &PairContacts, wrench: Screw, out: &mut [Screw]) {
        let [a, b] = pair.bodies;
        out[b] += wrench.wrench_from(pair.origin - self.bodies[b].center_of_mass);
        out[a] += -wrench.wrench_from(pair.origin - self.bodies[a].center_of_mass);
    }

    /// Inverse diagonal blocks.
    fn preconditioner(&self, dt: f64) -> Vec<Symmetric6> {
        let mut blocks = vec![Symmetric6::ZERO; self.bodies.len()];
        for pair in &self.pairs {
            for i in pair.bodies {
                blocks[i] += pair.damping().moved(pair.origin - self.bodies[i].center_of_mass);
            }
        }
        let inverse = |(block, body): (&Symmetric6, &SolverBody)| {
            let mut block = block.scaled_by(body.root_linear, body.root_angular) * dt;
            block.linear += DMat3::IDENTITY;
            block.angular += DMat3::IDENTITY;
            block.inverse()
        };
        blocks.iter().zip(&self.bodies).map(inverse).collect()
    }
}

fn apply(blocks: &[Symmetric6], v: &[Screw]) -> Vec<Screw> {
    blocks.iter().zip(v).map(|(block, v)| *block * *v).collect()
}

fn dot(a: &[Screw], b: &[Screw]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}
