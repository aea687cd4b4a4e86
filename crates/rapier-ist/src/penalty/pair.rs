//! The contact of one pair of bodies inside the penalty solve.

use super::body::SolverBody;
use super::damper_sum::DamperSum;
use super::friction::{Friction, Rebound};
use super::impact::{Impact, ImpactStep};
use super::material::Material;
use super::pair_state::{PairState, SampleLaw};
use super::patch::patches;
use super::patch_sum::PatchSum;
use super::resolved::resolve;
use super::sample::Sample;
use super::twist::{Screw, Symmetric6};
use crate::memory::PairMemory;
use crate::query::Contact;
use rapier3d::glamx::DVec3;

/// Share of the lighter body's load below which a force is small. Not tuned.
const SMALL_SHARE: f64 = 0.1;

/// Time (s) in which a pair's stiffness follows its load. The thinnest of the chains of `HEAVY` in `contact_law.rs` is torn with 0.05, and holds
/// with 0.02 and at once. At rates above 60 Hz that delay keeps the steps of an impact from making it stiffer.
const LOAD_TIME: f64 = 0.02;

/// Contact samples between bodies `a` and `b` and the wrench they exert, linearised in the final velocity.
#[derive(Clone, Debug)]
pub(crate) struct PairContacts {
    /// Point of reference of `offset` and `damping`: the centroid of the overlap, world frame.
    pub(crate) origin: DVec3,
    /// Depth of the deepest patch (m).
    pub(crate) depth: f64,
    material: Material,
    samples: Vec<Sample>,
    /// In the order of the samples.
    pub(crate) patches: Vec<PatchSum>,
    impact: Impact,
    step: ImpactStep,
    /// Relative twist before the step.
    before: Screw,
    /// Impulse of the rebound on b about [`Self::origin`], in this step.
    rebound: Option<Rebound>,
    /// What bodies that turn as one seem to part by at the end of the step (m/s).
    pub(crate) turning: DVec3,
    dt: f64,
    /// Of what the solve found, see [`Self::make_passive`].
    share: f64,
    /// What the pair has carried before the step (N).
    carried: f64,
    /// The lesser of the forces besides contacts on those of the bodies that can move (N).
    load: f64,
    /// Wrench on b at zero relative velocity.
    offset: Screw,
    /// What a relative twist takes away from it.
    damping: Symmetric6,
}

impl PairContacts {
    /// From the samples of `contact`, measured at the predicted poses; `dt` is the time step (s).
    pub(crate) fn new(
        states: [&SolverBody; 2],
        (material, memory): (Material, PairMemory),
        contact: &Contact,
        dt: f64,
    ) -> Self {
        let pair = PairState::new(states, contact, dt);
        let memory = memory.about(pair.placement.origin);
        let patches = patches(&contact.samples);
        let step =
            ImpactStep { before: pair.opening(pair.before), free: pair.opening(pair.free), end: memory.end };
        let mut impact = memory.impact.approached(-step.before, material.rebound_speed);
        let dissipation = material.dissipation(impact);
        let law = SampleLaw { material: &material, dissipation, last_force: memory.force };
        let (mut samples, stiff) = pair.samples(&patches, &law);
        // Once stiff, to its end: what was stopped within a step does not come back by itself. Where nothing is to come back, what the
        // implicit force takes is welcome.
        impact.stiff |= stiff;
        if material.restitution > 0.0 && impact.speed > 0.0 && !impact.stiff {
            resolve(&mut samples, &impact, pair.free, dt, |along| pair.compliance(along));
        }
        let rebound = memory.rebound.or_else(|| {
            let along = memory.impulse * (1.0 / memory.impulse.linear.length());
            let speeds = [pair.before.dot(along), pair.free.dot(along)];
            let impulse = (memory.impulse, pair.compliance(along));
            (impact.stiff && impact.rebounds(&material, &step))
                .then(|| impact.rebound(&material, &step, impulse, speeds))
                .flatten()
        });
        if rebound.is_some() {
            // What is left of the overlap does not add to it.
            let dissipation = material.dissipation(Impact { rebounded: true, ..impact });
            for s in &mut samples {
                s.dissipation = dissipation;
                s.linearize_at(s.velocity);
            }
        }
        let arm = |point| pair.placement.arm(point);
        let patches: Vec<_> = patches.iter().map(|patch| PatchSum::of(patch, arm)).collect();
        Self {
            origin: pair.placement.origin,
            depth: patches.iter().map(|patch| patch.depth).fold(0.0, f64::max),
            material,
            samples,
            patches,
            impact,
            step,
            before: pair.before,
            rebound: rebound.map(|impulse| Rebound::new(impulse, pair.before)),
            turning: pair.turning(),
            dt,
            share: 1.0,
            carried: memory.carried,
            load: pair.load(),
            offset: Screw::ZERO,
            damping: Symmetric6::ZERO,
        }
    }

    /// Linearises the wrench about the velocities of the last pass.
    ///
    /// Per sample the force on b is `n (f + c_n n·(u_0 − u)) − c_t (u − n n·u)` with the tangent of the normal force at
    /// u_0 and the regularised Coulomb coefficient `c_t = μ f / max(|u_t|, u_creep)` there, with u_t relative to the wanted
    /// tangent velocity.
    pub(crate) fn linearize(&mut self) {
        (self.offset, self.damping) = (Screw::ZERO, Symmetric6::ZERO);
        let friction = self.friction();
        let mut samples = self.samples.iter_mut();
        for patch in &mut self.patches {
            let (mut offset, mut dampers) = (Screw::ZERO, DamperSum::ZERO);
            for s in samples.by_ref().take(patch.count) {
                if s.force <= 0.0 {
                    s.drag = 0.0;
                    continue;
                }
                let wanted = friction.wanted(s.normal);
                s.drag = friction.drag(s.force, (s.slip() - wanted).length());
                dampers.add(s.normal, s.arm, [s.damping, s.drag]);
                let force = s.normal * (s.force + s.damping * s.velocity.dot(s.normal)) + wanted * s.drag;
                offset += Screw { linear: force, angular: s.arm.cross(force) };
            }
            (patch.offset, patch.damping) = (offset, dampers.matrix());
            self.offset += patch.offset;
            self.damping += patch.damping;
        }
        if let Some(rebound) = &mut self.rebound {
            let (wrench, damping) = rebound.linearize(&friction, self.dt);
            self.offset += wrench;
            self.damping += damping;
            // Patches share it so that their wrenches add up to the pair's.
            let share = 1.0 / self.patches.len() as f64;
            for patch in &mut self.patches {
                patch.offset += wrench * share;
                patch.damping += damping * share;
            }
        }
    }

    /// Takes over the relative twist of a solve for the next linearisation. Returns how far the forces of the law, friction among
    /// them, are from those of the linearised system, relative to their sum or to what the lighter body bears besides contacts:
    /// contacts that hardly touch do not keep all others waiting.
    pub(crate) fn update(&mut self, twist: Screw) -> f64 {
        let (mut change, mut total) = (0.0, 0.0);
        let friction = self.friction();
        for s in &mut self.samples {
            let velocity = twist.twist_at(s.arm).linear;
            let slip = velocity.reject_from_normalized(s.normal) - friction.wanted(s.normal);
            let (solved, law) = s.update(velocity);
            let slip = slip.length();
            change += (solved - law).abs() + (friction.drag(law, slip) - s.drag).abs() * slip;
            total += solved.abs().max(law);
        }
        if let Some(rebound) = &mut self.rebound {
            let (changed, force) = rebound.update(twist, &friction, self.dt);
            change += changed;
            total += force;
        }
        if total > 0.0 { change / total.max(self.load) } else { 0.0 }
    }

    fn friction(&self) -> Friction {
        Friction::new(&self.material, self.grip(), self.turning)
    }

    /// Share of the friction that the pair has.
    ///
    /// Bodies that overlap are squeezed from all sides, which rigid bodies are not: what cancels must not hold them by
    /// friction where they are. All of it down to where the forces' sum is half of the sum of their sizes: the walls of a
    /// groove of 60°.
    fn grip(&self) -> f64 {
        let (mut sum, mut total) = (DVec3::ZERO, f64::MIN_POSITIVE);
        for s in &self.samples {
            sum += s.normal * s.force;
            total += s.force;
        }
        if self.rebound.is_some() && total <= f64::MIN_POSITIVE {
            // Nothing but the rebound pushes.
            return 1.0;
        }
        (2.0 * sum.length() / total).min(1.0)
    }

    /// What to remember of the pair after a step at the relative twist `twist`. What it has carried is the size of the sum of
    /// the normal forces, over the last [`LOAD_TIME`].
    pub(crate) fn memory(&self, twist: Screw) -> PairMemory {
        let (mut force, mut power, wrench) = (0.0, 0.0, self.push());
        let twist = self.before + (twist - self.before) * self.share;
        for s in &self.samples {
            force += s.force;
            power += s.force * (twist.twist_at(s.arm).linear.dot(s.normal) - s.sliding);
        }
        let end = if force > 0.0 { power / force } else { self.step.end.max(0.0) };
        // Walls that squeeze a body from both sides carry nothing by that.
        let share = (self.dt / LOAD_TIME).min(1.0);
        let carried = self.carried + (wrench.linear.length() - self.carried) * share;
        // What is no number is forgotten.
        let carried = carried.max(0.0);
        let impulse = wrench * self.dt;
        let step = ImpactStep { end, ..self.step };
        let lost = -(impulse + self.rebound_impulse()).dot((self.before + twist) * 0.5);
        let after = self.impact.after(&step, (impulse, lost), self.rebound.is_some());
        PairMemory {
            force,
            carried,
            end,
            origin: self.origin,
            impulse: self.impact.impulse + impulse,
            rebound: self.rebound.map(|rebound| rebound.impulse),
            impact: after,
        }
    }

    /// Whether the pair has come to a stop in the step so early that it should rebound in the same step.
    pub(crate) fn should_rebound(&self, twist: Screw) -> bool {
        // The memory is a sum over all samples, and most pairs have no impact.
        let rebounds = || {
            let PairMemory { end, .. } = self.memory(twist);
            self.impact.rebounds(&self.material, &ImpactStep { end, ..self.step })
        };
        self.rebound.is_none()
            && self.impact.may_rebound(&self.material)
            && self.impact.stiff
            && self.samples.iter().any(|s| s.force > 0.0)
            && rebounds()
    }

    /// Scales all that the contact does in a step at the relative twist `twist` down until it gives back no more energy than its impact
    /// took. Returns whether there was too much.
    ///
    /// A rebound gives back what the bodies had along its impulse, but what is left of the overlap pushes along other normals besides, and
    /// spheres that slide past each other push along theirs. Of 1,000 pairs of jacks that are thrown at each other without friction,
    /// e = 1, 61 made up to 9.8 % of energy without this, 4 up to 1.8 % with it: those touched slowly, for which nothing is counted.
    pub(crate) fn make_passive(&mut self, twist: Screw) -> bool {
        if self.material.restitution <= 0.0 || !self.impact.is_under_way() {
            return false;
        }
        let impulse = self.push() * self.dt + self.rebound_impulse();
        let work = [impulse.dot(self.before), impulse.dot((twist - self.before) * 0.5)];
        self.share = self.impact.share_of_lost(work);
        if self.share >= 1.0 {
            return false;
        }
        for s in &mut self.samples {
            s.force *= self.share;
        }
        for (offset, damping) in self.patches.iter_mut().map(|patch| (&mut patch.offset, &mut patch.damping))
        {
            (*offset, *damping) = (*offset * self.share, *damping * self.share);
        }
        (self.offset, self.damping) = (self.offset * self.share, self.damping * self.share);
        if let Some(rebound) = &mut self.rebound {
            rebound.impulse = rebound.impulse * self.share;
        }
        true
    }

    /// Normal forces of all samples on b (N).
    fn push(&self) -> Screw {
        self.samples.iter().fold(Screw::ZERO, |sum, s| sum + s.along_normal(s.force))
    }

    fn rebound_impulse(&self) -> Screw {
        self.rebound.map_or(Screw::ZERO, |rebound| rebound.impulse)
    }

    /// Whether the bodies part by restitution, or are about to.
    pub(crate) fn is_rebounding(&self) -> bool {
        self.rebound.is_some() || self.impact.rebounded || self.impact.may_rebound(&self.material)
    }

    /// What each patch pushes the second body with, besides friction (N).
    pub(crate) fn pushes(&self) -> impl Iterator<Item = DVec3> {
        let mut samples = self.samples.iter();
        self.patches
            .iter()
            .map(move |patch| samples.by_ref().take(patch.count).map(|s| s.normal * s.force).sum())
    }

    /// How far from the poses at which it was measured the contact is after a step at the relative twist `twist`, in units of
    /// the depth: a mean weighted by force, or less where the force is a small share of what the lighter body bears besides
    /// contacts. Contacts that hardly touch move by many times their depth, and nothing depends on them.
    pub(crate) fn strain(&self, twist: Screw) -> f64 {
        let (mut strain, mut force) = (0.0, f64::MIN_POSITIVE);
        for s in &self.samples {
            strain += s.force * s.strain(twist.twist_at(s.arm).linear);
            force += s.force;
        }
        strain / force.max(SMALL_SHARE * self.load)
    }

    /// Wrench on b about [`Self::origin`] at the given relative twist.
    pub(crate) fn wrench(&self, twist: Screw) -> Screw {
        self.offset - self.damping * twist
    }

    pub(crate) fn damping(&self) -> &Symmetric6 {
        &self.damping
    }
}
