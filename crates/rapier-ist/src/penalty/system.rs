//! The linear system of one island, and conjugate gradients on it.
//!
//! With `M⁻¹ = L Lᵀ` and the change of velocity `Δ = L y` the implicit step reads
//! `(I + h Lᵀ S L) y = h Lᵀ r`, where `S = Σ Jᵀ K J` over the pairs. That form is well defined for locked axes and
//! bodies of infinite mass, whose rows of L are zero, and it is preconditioned by the mass already.

use super::body::SolverBody;
use super::pair::PairContacts;
use super::twist::{Screw, Symmetric6};
use rapier3d::glamx::{DMat3, DVec3};

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
    links: Vec<Link>,
    /// `y` of each body.
    state: Vec<Screw>,
}

/// Where the contacts of a pair act.
#[derive(Clone, Copy, Debug)]
struct Link {
    /// Indices of the bodies.
    bodies: [usize; 2],
    /// From the bodies' centres of mass to the pair's origin.
    arms: [DVec3; 2],
}

impl Link {
    /// Velocity of the second body relative to the first at the pair's origin.
    fn relative_twist(&self, twists: &[Screw]) -> Screw {
        let ([a, b], [arm_a, arm_b]) = (self.bodies, self.arms);
        twists[b].twist_at(arm_b) - twists[a].twist_at(arm_a)
    }
}

impl Island {
    /// `pairs` are the contacts between the bodies of the given indices, `state` the unknowns to start with.
    pub(crate) fn new(
        bodies: Vec<SolverBody>,
        pairs: Vec<([usize; 2], PairContacts)>,
        state: Vec<Screw>,
    ) -> Self {
        let link = |(indices, pair): &([usize; 2], PairContacts)| Link {
            bodies: *indices,
            arms: indices.map(|body| pair.origin - bodies[body].center_of_mass),
        };
        let links = pairs.iter().map(link).collect();
        Self { links, bodies, pairs: pairs.into_iter().map(|(_, pair)| pair).collect(), state }
    }

    /// The contacts, in the order in which they came.
    pub(crate) fn into_contacts(self) -> Vec<PairContacts> {
        self.pairs
    }

    /// Relative velocities of each pair at its origin, at the end of the step as last solved.
    pub(crate) fn final_twists(&self) -> Vec<Screw> {
        let twists: Vec<Screw> = (0..self.bodies.len()).map(|i| self.final_twist(i)).collect();
        self.links.iter().map(|link| link.relative_twist(&twists)).collect()
    }

    /// The same before the step.
    pub(crate) fn twists_before(&self) -> Vec<Screw> {
        let twists: Vec<Screw> = self.bodies.iter().map(|body| body.velocity).collect();
        self.links.iter().map(|link| link.relative_twist(&twists)).collect()
    }

    /// `y` of body `i`, as last solved.
    pub(crate) fn state(&self, i: usize) -> Screw {
        self.state[i]
    }

    /// Twist of body `i` at the end of the step, as last solved.
    fn final_twist(&self, i: usize) -> Screw {
        self.bodies[i].predicted + self.bodies[i].root_times(self.state[i])
    }

    /// Solves with the pairs as they are linearised now, starting from the present state.
    ///
    /// Solving only to a tenth of the first residual in passes that are not the last saves nothing: stiff contacts make
    /// large forces of small residuals, and a pile of gears explodes.
    pub(crate) fn solve_linear(&mut self, dt: f64) {
        let preconditioner = self.preconditioner(dt);
        let rhs = self.right_hand_side(dt);
        let image = self.image(&self.state, dt);
        let mut residual: Vec<Screw> = rhs.iter().zip(&image).map(|(rhs, image)| *rhs - *image).collect();
        let goal = TOLERANCE * TOLERANCE * dot(&rhs, &rhs);
        let mut z = vec![Screw::ZERO; residual.len()];
        apply(&preconditioner, &residual, &mut z);
        let mut direction = z.clone();
        let mut rz = dot(&residual, &z);
        for _ in 0..MAX_ITERATIONS {
            if self.is_small(&residual) || dot(&residual, &residual) <= goal {
                break;
            }
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
            apply(&preconditioner, &residual, &mut z);
            let next = dot(&residual, &z);
            let turn = next / rz;
            rz = next;
            for (d, z) in direction.iter_mut().zip(&z) {
                *d = *z + *d * turn;
            }
        }
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
        let twists: Vec<Screw> = self.bodies.iter().map(|body| body.predicted).collect();
        let mut out = self.wrenches(&twists, PairContacts::wrench);
        for (out, body) in out.iter_mut().zip(&self.bodies) {
            *out = body.root_transpose_times(*out) * dt;
        }
        out
    }

    /// `(I + h Lᵀ S L) y`.
    fn image(&self, y: &[Screw], dt: f64) -> Vec<Screw> {
        let twists: Vec<Screw> = self.bodies.iter().zip(y).map(|(body, y)| body.root_times(*y)).collect();
        let mut out = self.wrenches(&twists, |pair, twist| *pair.damping() * twist);
        for ((out, body), y) in out.iter_mut().zip(&self.bodies).zip(y) {
            *out = *y + body.root_transpose_times(*out) * dt;
        }
        out
    }

    /// Sum of the wrenches on every body about its centre of mass; `wrench` tells that on b for the relative twist of
    /// a pair, which has the opposite on a.
    fn wrenches(&self, twists: &[Screw], wrench: impl Fn(&PairContacts, Screw) -> Screw) -> Vec<Screw> {
        let mut out = vec![Screw::ZERO; self.bodies.len()];
        for (pair, link) in self.pairs.iter().zip(&self.links) {
            let wrench = wrench(pair, link.relative_twist(twists));
            let ([a, b], [arm_a, arm_b]) = (link.bodies, link.arms);
            out[b] += wrench.wrench_from(arm_b);
            out[a] += -wrench.wrench_from(arm_a);
        }
        out
    }

    /// Inverse diagonal blocks.
    fn preconditioner(&self, dt: f64) -> Vec<Symmetric6> {
        let mut blocks = vec![Symmetric6::ZERO; self.bodies.len()];
        for (pair, link) in self.pairs.iter().zip(&self.links) {
            for (body, arm) in link.bodies.into_iter().zip(link.arms) {
                blocks[body] += pair.damping().moved(arm);
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

fn apply(blocks: &[Symmetric6], v: &[Screw], out: &mut [Screw]) {
    for ((block, v), out) in blocks.iter().zip(v).zip(out) {
        *out = *block * *v;
    }
}

fn dot(a: &[Screw], b: &[Screw]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}
