//! One solve for all pairs of a step.

use crate::WorldParts;
use crate::bodies::{Bodies, SolverJoint};
use crate::candidates::Candidate;
use crate::contact_law::{ContactLaw, material};
use crate::lookahead::Displacement;
use crate::memory::{Memory, PairMemory};
use crate::penalty::{
    Island, IslandJoint, JointForces, JointWrench, Material, Members, PairContacts, Screw, SolverBody,
    islands,
};
use crate::query::Contact;
use rapier3d::glamx::DVec3;

/// The pairs after a solve, and the velocities of the bodies that it found.
pub(crate) struct Solution {
    /// The two bodies of each pair, as indices into [`Bodies::states`].
    pub(crate) pairs: Vec<[usize; 2]>,
    /// In the order of the pairs.
    pub(crate) solved: Vec<Solved>,
    /// The unknowns of all bodies, and whether they solve the systems of their islands.
    pub(crate) states: Vec<Screw>,
    pub(crate) is_solved: Vec<bool>,
    /// What joints do to all bodies.
    pub(crate) joint_wrenches: Vec<JointWrench>,
    /// Which bodies touch something, or are connected by joints with what does.
    pub(crate) touches: Vec<bool>,
    /// The joints between these, by their index.
    pub(crate) joints: Vec<(usize, JointForces)>,
}

/// A contact is measured again where it moved by more than this share of its depth from where it was measured. Not tuned.
const STALE: f64 = 0.25;

/// A pair that did not touch is looked at again where it moved by more than this share of its size, and how far it was apart, from where it
/// was. Not tuned.
///
/// That includes what gravity moves it by: contacts begin at the surface, and what lies on another at rest would part from it in every other
/// step.
const STALE_GAP: f64 = 1e-3;

/// Share of the forces of a pair from which on a patch has to be there in a new measurement.
///
/// Of 40 marbles in cups that are shaken at 3 to 6 Hz 25 get out without that, 7 with 0.3, 13 with 0.1: the last two differ by chance.
const NOTICEABLE: f64 = 0.1;

/// Cosine (of 60°) of the angle up to which a sample of it pushes as the patch did. Not tuned.
const SAME_WAY: f64 = 0.5;

impl Solution {
    /// Replaces what is remembered of all pairs.
    pub(crate) fn remember(&self, contacts: &[&Contact], memory: &mut Memory) {
        memory.clear();
        let known = |s: &Solved| (contacts[s.pair].candidate.colliders, s.contacts.memory(s.twist));
        memory.extend(self.solved.iter().map(known));
    }

    /// Makes pairs that touch nothing else passive, see [`PairContacts::make_passive`]; whether that changed one. The velocities stay those
    /// that the solve found.
    ///
    /// Among others, less of one force than was solved for is far too little: forces in stacks and piles cancel.
    pub(crate) fn make_passive(&mut self) -> bool {
        let alone = self.solved.iter_mut().filter(|solved| solved.is_alone);
        alone.map(|solved| solved.contacts.make_passive(solved.twist)).filter(|&changed| changed).count() > 0
    }

    /// Whether a pair has come to a stop so early that another solve should make it rebound.
    pub(crate) fn has_rebounds(&self) -> bool {
        self.solved.iter().any(Solved::should_rebound)
    }

    /// The pairs as they stand, one for each of the contacts that were solved; none for those that rebound.
    pub(crate) fn into_contacts(self) -> impl Iterator<Item = Option<PairContacts>> {
        self.solved.into_iter().map(|s| (!s.should_rebound()).then_some(s.contacts))
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
            strains[index] = solved.contacts.strain(solved.twist);
        }
        let mut stale = Vec::new();
        for (index, candidate) in candidates.iter_mut().enumerate() {
            let displacements = bodies.pair(world, candidate).map(displacement);
            let far = match found[index] {
                Some(_) => strains[index] > STALE,
                None => {
                    let [a, b] = [0, 1].map(|i| displacements[i] - candidate.displacements[i]);
                    let near = STALE_GAP * f64::from(candidate.size) + f64::from(candidate.clearance);
                    a.reach(&b, candidate.size) > near
                }
            };
            if far {
                candidate.is_distant = false;
                candidate.was_apart = found[index].is_none();
                candidate.displacements = displacements;
                stale.push(index);
            }
        }
        stale
    }
}

/// What a solve starts from.
pub(crate) struct Start<'a> {
    /// The unknowns of all bodies.
    pub(crate) states: &'a [Screw],
    /// Pairs that were solved before and have not been measured since.
    pub(crate) known: Vec<Option<PairContacts>>,
    /// What is remembered from the step before, and from the last solve.
    pub(crate) memories: [&'a Memory; 2],
}

/// Solves all pairs of `contacts`, in parallel by islands.
pub(crate) fn solve(
    world: &WorldParts<'_>,
    bodies: &Bodies,
    contacts: &[&Contact],
    start: Start<'_>,
    law: ContactLaw<'_>,
) -> Solution {
    let dt = f64::from(world.integration_parameters.dt);
    let pairs: Vec<[usize; 2]> =
        contacts.iter().map(|contact| bodies.pair(world, &contact.candidate)).collect();
    let movable: Vec<bool> = bodies.states.iter().map(SolverBody::is_movable).collect();
    let [before, last] = start.memories;
    let island_joint =
        |joint: &SolverJoint| IslandJoint { bodies: joint.bodies, is_driven: joint.forces.is_driven() };
    let joints: Vec<IslandJoint> = bodies.joints.iter().map(island_joint).collect();
    let islands = islands(&pairs, &joints, &movable);
    let most = most_loads(bodies, &islands, &pairs);
    let of = |index: usize, memory: &Memory| {
        let contact: &Contact = contacts[index];
        memory.get(&contact.candidate.colliders).copied().unwrap_or_default()
    };
    // The user's law is asked about one pair after the other.
    let materials: Vec<Option<Material>> = (0..contacts.len())
        .map(|index| {
            let carried = || of(index, before).carried.min(most[index]);
            start.known[index].is_none().then(|| material(world, contacts[index], carried(), law))
        })
        .collect();
    let new = |index: usize, material: Material| {
        let contact = contacts[index];
        let last = of(index, last);
        let PairMemory { impact, carried, .. } = of(index, before).about(last.origin);
        let memory = PairMemory { impact, carried, ..last };
        let states = pairs[index].map(|body| &bodies.states[body]);
        PairContacts::new(states, (material, memory), contact, dt)
    };
    let or_new =
        |(index, known): (usize, Option<PairContacts>)| known.or_else(|| Some(new(index, materials[index]?)));
    #[cfg(feature = "parallel")]
    let mut pair_contacts: Vec<Option<PairContacts>> = {
        use rayon::prelude::*;
        start.known.into_par_iter().enumerate().map(or_new).collect()
    };
    #[cfg(not(feature = "parallel"))]
    let mut pair_contacts: Vec<Option<PairContacts>> =
        start.known.into_iter().enumerate().map(or_new).collect();
    let islands: Vec<(Members, Vec<PairContacts>)> = islands
        .into_iter()
        .map(|members| {
            let contacts = members.pairs.iter().filter_map(|&pair| pair_contacts[pair].take()).collect();
            (members, contacts)
        })
        .collect();
    let solve = |(members, contacts)| solve_island((bodies, start.states), (members, contacts), &pairs, dt);
    #[cfg(feature = "parallel")]
    let solved: Vec<_> = {
        use rayon::prelude::*;
        islands.into_par_iter().map(solve).collect()
    };
    #[cfg(not(feature = "parallel"))]
    let solved: Vec<_> = islands.into_iter().map(solve).collect();
    let mut states: Vec<Screw> = vec![Screw::ZERO; bodies.states.len()];
    let mut is_solved = vec![true; bodies.states.len()];
    let mut touches = vec![false; bodies.states.len()];
    let mut joint_wrenches = vec![JointWrench::ZERO; bodies.states.len()];
    let mut all = Vec::with_capacity(pairs.len());
    let mut joints = Vec::new();
    for SolvedIsland { pairs, bodies, joints: of_island } in solved {
        joints.extend(of_island);
        all.extend(pairs);
        for SolvedBody { body, state, is_solved: solved, joints, touches: touching } in bodies {
            (states[body], is_solved[body], joint_wrenches[body]) = (state, solved, joints);
            touches[body] = touching;
        }
    }
    all.sort_unstable_by_key(|solved| solved.pair);
    joints.sort_unstable_by_key(|(joint, _)| *joint);
    Solution { pairs, solved: all, states, is_solved, joint_wrenches, touches, joints }
}

/// What each of `pairs` can be asked to carry at most (N): all that acts on the bodies of its island besides contacts.
fn most_loads(bodies: &Bodies, islands: &[Members], pairs: &[[usize; 2]]) -> Vec<f64> {
    let mut most = vec![0.0; pairs.len()];
    for members in islands {
        let used = bodies_of(bodies, members, pairs);
        let load: f64 = used.iter().map(|&body| bodies.states[body].external.linear.length()).sum();
        let drive = |&joint: &usize| {
            let joint = &bodies.joints[joint];
            joint.forces.drive(joint.bodies.map(|body| &bodies.states[body]))
        };
        let drive: f64 = members.joints.iter().map(drive).sum();
        for &pair in &members.pairs {
            most[pair] = load + drive;
        }
    }
    most
}

/// One pair after the solve.
pub(crate) struct Solved {
    /// Its index.
    pub(crate) pair: usize,
    pub(crate) contacts: PairContacts,
    /// At the end of the step, at the origin of the contacts.
    pub(crate) twist: Screw,
    /// The same before the step.
    pub(crate) relative_velocity: Screw,
    /// Whether its bodies are connected with nothing else.
    is_alone: bool,
}

impl Solved {
    /// Whether all that pushes noticeably still overlaps in `next`, the contact measured anew.
    pub(crate) fn still_pushes(&self, next: &Contact) -> bool {
        let sum: f64 = self.contacts.pushes().map(DVec3::length).sum();
        self.contacts
            .pushes()
            .filter(|push| push.length() > NOTICEABLE * sum)
            .all(|push| next.samples.iter().any(|s| s.normal.as_dvec3().dot(push) > SAME_WAY * push.length()))
    }

    /// Whether it parts by restitution, or is about to.
    pub(crate) fn is_rebounding(&self) -> bool {
        self.contacts.is_rebounding()
    }

    fn should_rebound(&self) -> bool {
        self.contacts.should_rebound(self.twist)
    }
}

/// One body after the solve.
struct SolvedBody {
    body: usize,
    state: Screw,
    is_solved: bool,
    joints: JointWrench,
    /// Whether it touches something, or joints connect it with what does.
    touches: bool,
}

struct SolvedIsland {
    pairs: Vec<Solved>,
    bodies: Vec<SolvedBody>,
    /// With their indices; none where nothing touches.
    joints: Vec<(usize, JointForces)>,
}

/// The bodies of an island, in order.
fn bodies_of(bodies: &Bodies, members: &Members, pairs: &[[usize; 2]]) -> Vec<usize> {
    let of_pairs = members.pairs.iter().flat_map(|&pair| pairs[pair]);
    let of_joints = members.joints.iter().flat_map(|&joint| bodies.joints[joint].bodies);
    let mut used: Vec<usize> = of_pairs.chain(of_joints).collect();
    used.sort_unstable();
    used.dedup();
    used
}

fn solve_island(
    (bodies, start): (&Bodies, &[Screw]),
    (members, contacts): (Members, Vec<PairContacts>),
    pairs: &[[usize; 2]],
    dt: f64,
) -> SolvedIsland {
    let used = bodies_of(bodies, &members, pairs);
    let local = |body: usize| used.binary_search(&body).unwrap_or(0);
    let joint = |&joint: &usize| {
        let joint: &SolverJoint = &bodies.joints[joint];
        (joint.bodies.map(local), joint.forces.clone())
    };
    let mut island = Island::new(
        used.iter().map(|&body| bodies.states[body]).collect(),
        members.pairs.iter().map(|&pair| pairs[pair].map(local)).zip(contacts).collect(),
        members.joints.iter().map(joint).collect(),
        used.iter().map(|&body| start[body]).collect(),
    );
    island.solve(dt);
    let is_solved = island.is_solved();
    let touches = !members.pairs.is_empty();
    let is_alone = members.pairs.len() == 1 && members.joints.is_empty();
    let solved_body =
        |((i, &body), joints)| SolvedBody { body, state: island.state(i), is_solved, joints, touches };
    let states = used.iter().enumerate().zip(island.joint_wrenches()).map(solved_body).collect();
    let twists = island.twists_before().into_iter().zip(island.final_twists());
    let (contacts, joints) = island.into_forces();
    let solved = members.pairs.into_iter().zip(contacts).zip(twists);
    let solved = solved.map(|((pair, contacts), (relative_velocity, twist))| Solved {
        pair,
        contacts,
        twist,
        relative_velocity,
        is_alone,
    });
    let joints = members.joints.into_iter().zip(joints).filter(|_| touches);
    SolvedIsland { pairs: solved.collect(), bodies: states, joints: joints.collect() }
}
