//! One solve for all pairs of a step.

use crate::WorldParts;
use crate::bodies::Bodies;
use crate::candidates::Candidate;
use crate::contact_law::{ContactLaw, material};
use crate::lookahead::Displacement;
use crate::memory::{Memory, PairMemory};
use crate::penalty::{Island, Material, PairContacts, PatchSum, Screw, SolverBody, islands};
use crate::query::Contact;
use rapier3d::glamx::DVec3;

/// The pairs after a solve, and the velocities of the bodies that it found.
pub(crate) struct Solution {
    /// The two bodies of each pair, as indices into [`Bodies::states`].
    pub(crate) pairs: Vec<[usize; 2]>,
    /// In the order of the pairs.
    pub(crate) solved: Vec<Solved>,
    /// The unknowns of all bodies.
    pub(crate) states: Vec<Screw>,
}

/// A contact is measured again where it moved by more than this share of its depth from where it was measured. Not tuned.
const STALE: f64 = 0.25;

/// A pair that did not touch is looked at again where it moved by more than this share of its size from where it was.
/// Not tuned.
const STALE_GAP: f64 = 1e-3;

impl Solution {
    /// Replaces what is remembered of all pairs.
    pub(crate) fn remember(&self, contacts: &[&Contact], memory: &mut Memory) {
        memory.clear();
        memory.extend(self.solved.iter().map(|s| (contacts[s.pair].candidate.colliders, s.memory)));
    }

    /// Candidates that do not end up near the poses at which they were measured; moves them there.
    pub(crate) fn stale(
        &self,
        world: &WorldParts<'_>,
        bodies: &Bodies,
        candidates: &mut [Candidate],
        found: &[Option<Contact>],
    ) -> Vec<usize> {
        let dt = f64::from(world.integration_parameters.dt);
        let displacement = |body: usize| {
            let body = bodies.real(body);
            let state = &bodies.states[body];
            Displacement::new(
                state.center_of_mass,
                (state.predicted + state.root_times(self.states[body])) * dt,
            )
        };
        let mut strains = vec![0.0; candidates.len()];
        let touching = (0..found.len()).filter(|&index| found[index].is_some());
        for (solved, index) in self.solved.iter().zip(touching) {
            strains[index] = solved.strain;
        }
        let mut stale = Vec::new();
        for (index, candidate) in candidates.iter_mut().enumerate() {
            let displacements = bodies.pair(world, candidate).map(displacement);
            let far = match found[index] {
                Some(_) => strains[index] > STALE,
                None => {
                    let [a, b] = [0, 1].map(|i| displacements[i] - candidate.displacements[i]);
                    a.reach(&b, candidate.size) > STALE_GAP * f64::from(candidate.size)
                }
            };
            if far {
                candidate.displacements = displacements;
                stale.push(index);
            }
        }
        stale
    }
}

/// Solves all pairs of `contacts`, in parallel by islands, beginning with the unknowns `start`.
pub(crate) fn solve(
    world: &WorldParts<'_>,
    (bodies, start): (&Bodies, &[Screw]),
    (contacts, before, memory): (&[&Contact], &Memory, &Memory),
    law: ContactLaw<'_>,
) -> Solution {
    let dt = f64::from(world.integration_parameters.dt);
    let pairs: Vec<[usize; 2]> =
        contacts.iter().map(|contact| bodies.pair(world, &contact.candidate)).collect();
    let movable: Vec<bool> = bodies.states.iter().map(SolverBody::is_movable).collect();
    let inputs: Vec<(Material, PairMemory)> = contacts
        .iter()
        .map(|contact| {
            let of = |memory: &Memory| memory.get(&contact.candidate.colliders).copied().unwrap_or_default();
            let memory = PairMemory { impact: of(before).impact, ..of(memory) };
            (material(world, contact, law), memory)
        })
        .collect();
    let islands = islands(&pairs, &movable);
    let solve =
        |members: &Vec<usize>| solve_island((bodies, start), members, &pairs, (contacts, &inputs), dt);
    #[cfg(feature = "parallel")]
    let solved: Vec<_> = {
        use rayon::prelude::*;
        islands.par_iter().map(solve).collect()
    };
    #[cfg(not(feature = "parallel"))]
    let solved: Vec<_> = islands.iter().map(solve).collect();
    let mut states: Vec<Screw> = vec![Screw::ZERO; bodies.states.len()];
    let mut all = Vec::with_capacity(pairs.len());
    for (pairs, island) in solved {
        all.extend(pairs);
        for (body, state) in island {
            states[body] = state;
        }
    }
    all.sort_unstable_by_key(|solved| solved.pair);
    Solution { pairs, solved: all, states }
}

/// One pair after the solve: its index, its point of reference and the wrench on its second body about that.
pub(crate) struct Solved {
    pub(crate) pair: usize,
    pub(crate) origin: DVec3,
    pub(crate) depth: f64,
    pub(crate) wrench: Screw,
    pub(crate) relative_velocity: Screw,
    /// With the wrenches on the second body about the pair's origin.
    pub(crate) patches: Vec<(PatchSum, Screw)>,
    memory: PairMemory,
    pub(crate) should_rebound: bool,
    /// How far from where it was measured the contact ends up, in units of its depth.
    strain: f64,
}

fn solve_island(
    (bodies, start): (&Bodies, &[Screw]),
    members: &[usize],
    pairs: &[[usize; 2]],
    (contacts, inputs): (&[&Contact], &[(Material, PairMemory)]),
    dt: f64,
) -> (Vec<Solved>, Vec<(usize, Screw)>) {
    let mut used: Vec<usize> = members.iter().flat_map(|&pair| pairs[pair]).collect();
    used.sort_unstable();
    used.dedup();
    let local = |body: usize| used.binary_search(&body).unwrap_or(0);
    let contacts = members.iter().map(|&pair| {
        let states = pairs[pair].map(|body| &bodies.states[body]);
        PairContacts::new(pairs[pair].map(local), states, inputs[pair], contacts[pair], dt)
    });
    let contacts = contacts.collect();
    let mut island = Island::new(
        used.iter().map(|&body| bodies.states[body]).collect(),
        contacts,
        used.iter().map(|&body| start[body]).collect(),
    );
    island.solve(dt);
    let solved = members.iter().enumerate().map(|(index, &pair)| {
        let (contacts, twist) = (&island.pairs[index], island.pair_twist(index));
        Solved {
            pair,
            origin: contacts.origin,
            depth: contacts.depth,
            wrench: contacts.wrench(twist),
            patches: contacts.patches.iter().map(|patch| (*patch, patch.wrench(twist))).collect(),
            memory: contacts.memory(twist),
            should_rebound: contacts.should_rebound(twist),
            strain: contacts.strain(twist),
            relative_velocity: contacts.relative_twist(&island.bodies, |i| island.bodies[i].velocity),
        }
    });
    let solved = solved.collect();
    (solved, used.iter().enumerate().map(|(i, &body)| (body, island.state(i))).collect())
}
