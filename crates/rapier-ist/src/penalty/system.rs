//! The linear system of one island.
//!
//! With `M⁻¹ = L Lᵀ` and the change of velocity `Δ = L y` the implicit step reads
//! `(I + h Lᵀ S L) y = h Lᵀ r`, where `S = Σ Jᵀ K J` over the pairs. That form is well defined for locked axes and
//! bodies of infinite mass, whose rows of L are zero, and it is preconditioned by the mass already.

use super::block::Block;
use super::block_matrix::BlockMatrix;
use super::body::SolverBody;
use super::conjugate_gradients::{conjugate_gradients, dot};
use super::joint::{JointForces, JointWrench};
use super::pair::PairContacts;
use super::twist::{Screw, Symmetric6, cross_matrix};
use rapier3d::glamx::{DMat3, DVec3};

/// The iteration stops where the residual is this share of the solution: no eigenvalue of the system is below 1, so that the
/// residual bounds the error.
///
/// A share of the right-hand side bounds nothing. That holds what contacts would do at velocities at which they were
/// linearised, and stiff ones, seen from afar, cancel: with 1e-7 of it, bodies of 0.5 kg wedged in one of 0.5 m left a solve at
/// 1,000 m/s and the next at 1e6. Not tuned: piles under gravity stop by their load, and one of 20 bodies is the same to the last
/// bit with either.
const TOLERANCE: f64 = 1e-6;

/// Or this share of the right-hand side: some fifty roundings of f64, below which the residual need not fall. Not tuned.
const ROUNDING: f64 = 1e-14;

/// Or where that of every body is this share of what gravity and its own forces change in the step: 0.2 mm/s on Earth at 60 Hz.
///
/// A pile of 100 gears is asleep after 2.4 s with 1e-3 as with 1e-7 and solves take a third less; with 1e-2 it takes
/// 3.1 s.
const LOAD_TOLERANCE: f64 = 1e-3;

/// Bodies that touch, and their contacts.
#[derive(Debug)]
pub(crate) struct Island {
    pub(crate) bodies: Vec<SolverBody>,
    pub(crate) pairs: Vec<PairContacts>,
    pub(super) joints: Vec<JointForces>,
    /// First those of the pairs, then those of the joints.
    links: Vec<Link>,
    matrix: BlockMatrix,
    /// `y` of each body.
    state: Vec<[f64; 6]>,
    /// Whether the state solves the system as it is linearised now.
    is_solved: bool,
}

/// Where the contacts of a pair act, or a joint.
#[derive(Clone, Copy, Debug)]
struct Link {
    /// Indices of the bodies.
    bodies: [usize; 2],
    /// From the bodies' centres of mass to the origin of the pair, or to where the joint acts on them.
    arms: [DVec3; 2],
}

impl Link {
    /// Velocity of the second body relative to the first where they are linked.
    fn relative_twist(&self, twists: &[Screw]) -> Screw {
        let ([a, b], [arm_a, arm_b]) = (self.bodies, self.arms);
        twists[b].twist_at(arm_b) - twists[a].twist_at(arm_a)
    }

    /// Adds a wrench on the second body, and the opposite one on the first, both about where they are linked, to `sums` about their centres of mass.
    fn add(&self, wrench: Screw, sums: &mut [Screw]) {
        let ([a, b], [arm_a, arm_b]) = (self.bodies, self.arms);
        sums[b] += wrench.wrench_from(arm_b);
        sums[a] += -wrench.wrench_from(arm_a);
    }

    /// Whether both bodies can move, so that the pair couples them.
    fn couples(&self, bodies: &[SolverBody]) -> bool {
        self.bodies.iter().all(|&body| bodies[body].is_movable())
    }

    /// `−h L_aᵀ X_aᵀ K X_b L_b`, with the matrices X that move the bodies' twists to where they are linked.
    fn coupling(&self, damping: &Symmetric6, bodies: &[SolverBody], dt: f64) -> Block {
        let [a, b] = self.bodies.map(|body| &bodies[body]);
        let [cross_a, cross_b] = self.arms.map(cross_matrix);
        let mixed = damping.mixed - damping.linear * cross_b;
        let mixed_transposed = damping.mixed.transpose();
        let angular = damping.angular - mixed_transposed * cross_b;
        let lower = cross_a * damping.linear + mixed_transposed;
        let lower_angular = cross_a * mixed + angular;
        let [linear_a, linear_b] = [a, b].map(|body| DMat3::from_diagonal(body.root_linear));
        let turned = a.root_angular.transpose() * -dt;
        Block::new([
            [linear_a * damping.linear * linear_b * -dt, linear_a * (mixed * b.root_angular) * -dt],
            [turned * lower * linear_b, turned * (lower_angular * b.root_angular)],
        ])
    }
}

impl Island {
    /// `pairs` and `joints` are between the bodies of the given indices, `state` the unknowns to start with.
    pub(crate) fn new(
        bodies: Vec<SolverBody>,
        pairs: Vec<([usize; 2], PairContacts)>,
        joints: Vec<([usize; 2], JointForces)>,
        state: Vec<Screw>,
    ) -> Self {
        let link = |([a, b], [place_a, place_b]): ([usize; 2], [DVec3; 2])| Link {
            bodies: [a, b],
            arms: [place_a - bodies[a].center_of_mass, place_b - bodies[b].center_of_mass],
        };
        let places = pairs.iter().map(|(indices, pair)| (*indices, [pair.origin; 2]));
        let places = places.chain(joints.iter().map(|(indices, joint)| (*indices, joint.anchors)));
        let links: Vec<Link> = places.map(link).collect();
        let couplings: Vec<[usize; 2]> =
            links.iter().filter(|link| link.couples(&bodies)).map(|link| link.bodies).collect();
        let matrix = BlockMatrix::new(bodies.len(), &couplings);
        let pairs = pairs.into_iter().map(|(_, pair)| pair).collect();
        let joints = joints.into_iter().map(|(_, joint)| joint).collect();
        let state = state.into_iter().map(Screw::to_array).collect();
        let mut island = Self { links, bodies, pairs, joints, matrix, state, is_solved: false };
        island.update_joints();
        island
    }

    /// Takes over the velocities as last solved for the joints. Returns the largest result.
    pub(super) fn update_joints(&mut self) -> f64 {
        let twists = self.twists();
        let joints = self.joints.iter_mut().zip(&self.links[self.pairs.len()..]);
        joints.map(|(joint, link)| joint.update(link.relative_twist(&twists))).fold(0.0, f64::max)
    }

    /// What all joints do to each body, as last solved.
    pub(crate) fn joint_wrenches(&self) -> Vec<JointWrench> {
        let twists = self.twists();
        let mut wrenches = [(); 3].map(|()| vec![Screw::ZERO; self.bodies.len()]);
        for (joint, link) in self.joints.iter().zip(&self.links[self.pairs.len()..]) {
            let [again, support] = joint.repeated_wrenches();
            let of_joint = [joint.wrench(link.relative_twist(&twists)), again, support];
            of_joint.into_iter().zip(&mut wrenches).for_each(|(wrench, sums)| link.add(wrench, sums));
        }
        let [solved, again, support] = &wrenches;
        (0..self.bodies.len())
            .map(|i| JointWrench { solved: solved[i], again: again[i], support: support[i] })
            .collect()
    }

    /// Twists of all bodies at the end of the step, as last solved.
    fn twists(&self) -> Vec<Screw> {
        (0..self.bodies.len()).map(|i| self.final_twist(i)).collect()
    }

    /// Contacts and joints, in the order in which they came.
    pub(crate) fn into_forces(self) -> (Vec<PairContacts>, Vec<JointForces>) {
        (self.pairs, self.joints)
    }

    /// Relative velocities of each pair at its origin, at the end of the step as last solved.
    pub(crate) fn final_twists(&self) -> Vec<Screw> {
        self.pair_twists(&self.twists())
    }

    /// The same before the step.
    pub(crate) fn twists_before(&self) -> Vec<Screw> {
        self.pair_twists(&self.bodies.iter().map(|body| body.velocity).collect::<Vec<_>>())
    }

    fn pair_twists(&self, twists: &[Screw]) -> Vec<Screw> {
        self.links[..self.pairs.len()].iter().map(|link| link.relative_twist(twists)).collect()
    }

    /// `y` of body `i`, as last solved.
    pub(crate) fn state(&self, i: usize) -> Screw {
        Screw::from_array(self.state[i])
    }

    /// Whether the last solve went as far as it should.
    pub(crate) fn is_solved(&self) -> bool {
        self.is_solved
    }

    /// Twist of body `i` at the end of the step, as last solved.
    fn final_twist(&self, i: usize) -> Screw {
        self.bodies[i].predicted + self.bodies[i].root_times(self.state(i))
    }

    /// Solves with the pairs as they are linearised now, starting from the present state.
    ///
    /// Solving only to a tenth of the first residual in passes that are not the last saves nothing: stiff contacts make
    /// large forces of small residuals, and a pile of gears explodes.
    pub(crate) fn solve_linear(&mut self, dt: f64) {
        self.assemble(dt);
        let rhs = self.right_hand_side(dt);
        let Self { matrix, state, bodies, is_solved, .. } = self;
        let is_accurate = accuracy(&rhs);
        matrix.prepare();
        *is_solved = conjugate_gradients(matrix, &rhs, state, |residual, state| {
            is_small(residual, bodies) || is_accurate(residual, state)
        });
    }

    /// `h Lᵀ r`, where r are the wrenches at the predicted twists.
    fn right_hand_side(&self, dt: f64) -> Vec<[f64; 6]> {
        let twists: Vec<Screw> = self.bodies.iter().map(|body| body.predicted).collect();
        let mut wrenches = vec![Screw::ZERO; self.bodies.len()];
        let (of_pairs, of_joints) = self.links.split_at(self.pairs.len());
        for (pair, link) in self.pairs.iter().zip(of_pairs) {
            link.add(pair.wrench(link.relative_twist(&twists)), &mut wrenches);
        }
        for (joint, link) in self.joints.iter().zip(of_joints) {
            link.add(joint.wrench(link.relative_twist(&twists)), &mut wrenches);
        }
        let change =
            |(body, wrench): (&SolverBody, Screw)| (body.root_transpose_times(wrench) * dt).to_array();
        self.bodies.iter().zip(wrenches).map(change).collect()
    }

    /// Sets the matrix, `I + h Lᵀ S L`.
    fn assemble(&mut self, dt: f64) {
        let Self { pairs, joints, links, bodies, matrix, .. } = self;
        let mut diagonal = vec![Symmetric6::ZERO; bodies.len()];
        let mut couplings = 0;
        let dampings = pairs.iter().map(PairContacts::damping).chain(joints.iter().map(JointForces::damping));
        for (damping, link) in dampings.zip(links.iter()) {
            for (body, arm) in link.bodies.into_iter().zip(link.arms) {
                diagonal[body] += damping.moved(arm);
            }
            if link.couples(bodies) {
                matrix.set_coupling(couplings, link.coupling(damping, bodies, dt));
                couplings += 1;
            }
        }
        for (index, (block, body)) in diagonal.iter().zip(bodies.iter()).enumerate() {
            let mut block = block.scaled_by(body.root_linear, body.root_angular) * dt;
            block.linear += DMat3::IDENTITY;
            block.angular += DMat3::IDENTITY;
            matrix.set_diagonal(index, Block::from(&block));
        }
    }
}

/// Whether the residual bounds the error of the solution by [`TOLERANCE`], or cannot fall further.
fn accuracy(rhs: &[[f64; 6]]) -> impl Fn(&[[f64; 6]], &[[f64; 6]]) -> bool {
    let least = ROUNDING * ROUNDING * dot(rhs, rhs);
    move |residual, state| dot(residual, residual) <= least.max(TOLERANCE * TOLERANCE * dot(state, state))
}

/// Whether the residual of every body is a small share of its own load: a light body counts as much as a heavy one.
fn is_small(residual: &[[f64; 6]], bodies: &[SolverBody]) -> bool {
    let limit = LOAD_TOLERANCE * LOAD_TOLERANCE;
    let small = |(r, body): (&[f64; 6], &SolverBody)| {
        let r = Screw::from_array(*r);
        !body.is_movable() || r.dot(r) <= limit * body.unchanged.dot(body.unchanged)
    };
    residual.iter().zip(bodies).all(small)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Couplings of bodies in a row, each with the next.
    fn row(bodies: usize) -> Vec<[usize; 2]> {
        (1..bodies).map(|i| [i - 1, i]).collect()
    }

    /// Couplings of all with all.
    fn all(bodies: usize) -> Vec<[usize; 2]> {
        (1..bodies).flat_map(|i| (0..i).map(move |j| [j, i])).collect()
    }

    /// `I + h Lᵀ S L` of bodies that dampers hold to each other, and one that holds the first body. Each weighs as much against the
    /// masses as its number says.
    fn damped(
        bodies: usize,
        couplings: &[[usize; 2]],
        gains: impl Fn(usize) -> f64,
        first: f64,
    ) -> BlockMatrix {
        let mut matrix = BlockMatrix::new(bodies, couplings);
        let mut diagonal = vec![1.0; bodies];
        diagonal[0] += first;
        for (index, pair) in couplings.iter().enumerate() {
            pair.iter().for_each(|&body| diagonal[body] += gains(index));
            let coupling = DMat3::IDENTITY * -gains(index);
            matrix.set_coupling(index, Block::new([[coupling, DMat3::ZERO], [DMat3::ZERO, coupling]]));
        }
        for (i, diagonal) in diagonal.into_iter().enumerate() {
            let diagonal = DMat3::IDENTITY * diagonal;
            let block = Symmetric6 { linear: diagonal, mixed: DMat3::ZERO, angular: diagonal };
            matrix.set_diagonal(i, Block::from(&block));
        }
        matrix.prepare();
        matrix
    }

    /// What a matrix makes of some numbers, and these.
    fn problem(matrix: &BlockMatrix, bodies: usize) -> (Vec<[f64; 6]>, Vec<[f64; 6]>) {
        let solution: Vec<[f64; 6]> =
            (0..bodies).map(|i| std::array::from_fn(|k| libm::sin((7 * i + k) as f64))).collect();
        let mut rhs = vec![[0.0; 6]; bodies];
        matrix.times(&solution, &mut rhs);
        (rhs, solution)
    }

    /// How far `found` is from `expected`, as a share of that.
    fn error(found: &[[f64; 6]], expected: &[[f64; 6]]) -> f64 {
        let difference = |(a, b): (&[f64; 6], &[f64; 6])| std::array::from_fn(|k| a[k] - b[k]);
        let error: Vec<[f64; 6]> = found.iter().zip(expected).map(difference).collect();
        (dot(&error, &error) / dot(expected, expected)).sqrt()
    }

    #[test]
    fn issue_stiff_contacts_that_cancel_do_not_end_the_solve_early() {
        // The first is factored, the second too expensive for that.
        for (bodies, couplings) in [(24, row(24)), (40, all(40))] {
            for gain in [1e0, 1e2, 1e4, 1e6] {
                let matrix = damped(bodies, &couplings, |i| gain * [1e-2, 1e-4, 1.0][i % 3], 0.0);
                let (rhs, expected) = problem(&matrix, bodies);
                let mut solved = vec![[0.0; 6]; bodies];
                assert!(conjugate_gradients(&matrix, &rhs, &mut solved, accuracy(&rhs)));
                let share = error(&solved, &expected);
                assert!(share < 1.1 * TOLERANCE, "gain {gain}: an error of {share} of the solution");
            }
        }
    }

    /// Bodies that hang from a fixed one in a row, numbered as it came: a force has to go through all of them.
    #[test]
    fn long_chains_are_solved() {
        const BODIES: usize = 2000;
        let row: Vec<[usize; 2]> = row(BODIES).iter().map(|pair| pair.map(|i| 7 * i % BODIES)).collect();
        let matrix = damped(BODIES, &row, |_| 1e6, 1e6);
        let rhs = vec![[1.0; 6]; BODIES];
        let mut solved = vec![[0.0; 6]; BODIES];
        assert!(conjugate_gradients(&matrix, &rhs, &mut solved, accuracy(&rhs)));
    }
}
