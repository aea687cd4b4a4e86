//! A pair of bodies before the solve, and its samples as the solve begins.

use super::body::SolverBody;
use super::material::Material;
use super::patch::Patch;
use super::placement::{Placement, sliding};
use super::sample::Sample;
use super::twist::Screw;
use crate::query::Contact;
use ist::ContactSample;
use rapier3d::glamx::DVec3;

/// Impacts that can stop the bodies within a step, `h² k A > STOPS_WITHIN_A_STEP · m`, have their whole rebound in the step
/// after. Softer ones take several steps ([`resolve`](super::resolved::resolve)).
const STOPS_WITHIN_A_STEP: f64 = 0.5;

/// How two bodies in contact move relative to each other, and how easily they are moved.
pub(super) struct PairState<'a> {
    bodies: [&'a SolverBody; 2],
    contact: &'a Contact,
    pub(super) placement: Placement,
    /// Twists of the second body relative to the first about the placement's origin: before the step, and at its end if nothing
    /// but loads acted.
    pub(super) before: Screw,
    pub(super) free: Screw,
    /// Time step (s).
    dt: f64,
}

/// What the forces of samples follow from besides the motion.
pub(super) struct SampleLaw<'a> {
    pub(super) material: &'a Material,
    /// δ (s/m).
    pub(super) dissipation: f64,
    /// Normal force of the pair in the last step (N).
    pub(super) last_force: f64,
}

impl<'a> PairState<'a> {
    pub(super) fn new(bodies: [&'a SolverBody; 2], contact: &'a Contact, dt: f64) -> Self {
        let placement = Placement::of(bodies, contact);
        let relative = |twist: fn(&SolverBody) -> Screw| {
            let [a, b] = bodies.map(|body| twist(body).twist_at(placement.origin - body.center_of_mass));
            b - a
        };
        let (before, free) = (relative(|body| body.velocity), relative(|body| body.predicted));
        Self { bodies, contact, placement, before, free, dt }
    }

    /// Velocity along an impulse of one unit about the origin (1/kg).
    pub(super) fn compliance(&self, along: Screw) -> f64 {
        self.bodies.iter().map(|body| body.compliance(self.placement.origin, along)).sum()
    }

    /// What bodies that turn as one seem to part by (m/s) at the end of the step; before it as much the other way.
    pub(super) fn turning(&self) -> DVec3 {
        self.placement.turning / self.dt
    }

    /// Mean normal velocity (m/s) of the surfaces at the relative twist `twist` before the step, weighted by volume.
    pub(super) fn opening(&self, twist: Screw) -> f64 {
        let part = |s: &ContactSample| {
            let velocity = twist.twist_at(self.placement.arm(s.point.as_dvec3())).linear + self.turning();
            (velocity.dot(s.normal.as_dvec3()) - sliding(s, velocity)) * f64::from(s.volume)
        };
        self.contact.samples.iter().map(part).sum::<f64>() / self.volume().max(f64::MIN_POSITIVE)
    }

    /// The lesser of the forces besides contacts on those of the bodies that can move (N).
    pub(super) fn load(&self) -> f64 {
        let movable = self.bodies.into_iter().filter(|body| body.is_movable());
        movable.map(|body| body.external.linear.length()).fold(f64::INFINITY, f64::min)
    }

    /// The samples of `patches`, in their order, linearised where the solve is expected to end; and whether one of them could stop
    /// the bodies within the step.
    pub(super) fn samples(&self, patches: &[Patch], law: &SampleLaw) -> (Vec<Sample>, bool) {
        let whole = law.material.stiffness * self.volume();
        let mut samples = Vec::with_capacity(self.contact.samples.len());
        let mut stiff = false;
        for patch in patches {
            let volume: f64 = patch.samples.iter().map(|s| f64::from(s.volume)).sum();
            for s in &patch.samples {
                let mut sample = self.sample(s, patch, law);
                let along = sample.along_normal(1.0);
                let gain = volume * law.material.stiffness * self.compliance(along) * self.dt;
                stiff |= gain * sample.rate > STOPS_WITHIN_A_STEP;
                let now = sample.velocity.dot(sample.normal);
                let guess = if law.last_force > 0.0 {
                    sample.velocity_of(law.last_force * sample.push / whole, now)
                } else {
                    sample.guess(gain, self.free.twist_at(sample.arm).linear.dot(sample.normal))
                };
                sample.linearize_at(sample.velocity + sample.normal * (guess - now));
                samples.push(sample);
            }
        }
        (samples, stiff)
    }

    /// One of them, at the velocity before the step and not linearised.
    fn sample(&self, s: &ContactSample, patch: &Patch, law: &SampleLaw) -> Sample {
        let arm = self.placement.arm(s.point.as_dvec3());
        let velocity = self.before.twist_at(arm).linear;
        Sample {
            arm,
            normal: s.normal.as_dvec3(),
            push: law.material.stiffness * f64::from(s.volume),
            rate: self.dt / patch.depth,
            moved: self.placement.moved(s) / self.dt,
            dissipation: law.dissipation,
            sliding: sliding(s, velocity) + self.turning().dot(s.normal.as_dvec3()),
            velocity,
            force: 0.0,
            damping: 0.0,
            drag: 0.0,
        }
    }

    fn volume(&self) -> f64 {
        self.contact.samples.iter().map(|s| f64::from(s.volume)).sum()
    }
}
