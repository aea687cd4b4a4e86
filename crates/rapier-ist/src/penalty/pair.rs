//! The contact of one pair of bodies inside the penalty solve.

use super::body::SolverBody;
use super::patch::{Patch, patches};
use super::twist::{Screw, Symmetric6};
use crate::lookahead::Displacement;
use crate::query::Contact;
use rapier3d::glamx::{DMat3, DVec3};

/// Material of a pair of colliders, after Rapier's combine rules.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Material {
    /// Force per overlap volume (N/m³).
    pub(crate) stiffness: f64,
    /// Hunt–Crossley dissipation (s/m).
    pub(crate) dissipation: f64,
    pub(crate) friction: f64,
    pub(crate) restitution: f64,
    /// Slip speed under which friction is viscous (m/s).
    pub(crate) creep_speed: f64,
    /// Fastest that overlap alone may push bodies apart (m/s), positive.
    pub(crate) recovery_speed: f64,
    /// Approach speed from which on a contact rebounds (m/s).
    pub(crate) rebound_speed: f64,
}

/// Contact samples between bodies `a` and `b` and the wrench they exert, linearised in the final velocity.
#[derive(Clone, Debug)]
pub(crate) struct PairContacts {
    /// Indices into the solver's bodies.
    pub(crate) bodies: [usize; 2],
    /// Point of reference of `offset` and `damping`: the centroid of the overlap, world frame.
    pub(crate) origin: DVec3,
    /// Depth of the deepest patch (m).
    pub(crate) depth: f64,
    material: Material,
    samples: Vec<Sample>,
    /// In the order of the samples.
    pub(crate) patches: Vec<PatchSum>,
    /// Wrench on b at zero relative velocity.
    offset: Screw,
    /// What a relative twist takes away from it.
    damping: Symmetric6,
}

/// What a patch contributes to the wrench of its pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PatchSum {
    /// Number of its samples.
    count: usize,
    pub(crate) volume: f64,
    pub(crate) depth: f64,
    /// From the origin of the pair to the centroid of the patch.
    pub(crate) arm: DVec3,
    offset: Screw,
    damping: Symmetric6,
}

impl PatchSum {
    /// Without a wrench yet; `arm` leads from the pair's origin to where a point of the predicted contact acts.
    fn of(patch: &Patch<'_>, arm: impl Fn(DVec3) -> DVec3) -> Self {
        let volume: f64 = patch.samples.iter().map(|s| f64::from(s.volume)).sum();
        let moment: DVec3 = patch.samples.iter().map(|s| s.point.as_dvec3() * f64::from(s.volume)).sum();
        Self {
            count: patch.samples.len(),
            volume,
            depth: patch.depth,
            arm: arm(moment / volume.max(f64::MIN_POSITIVE)),
            offset: Screw::ZERO,
            damping: Symmetric6::ZERO,
        }
    }

    /// Wrench on b about the origin of the pair at the given relative twist.
    pub(crate) fn wrench(&self, twist: Screw) -> Screw {
        self.offset - self.damping * twist
    }
}

#[derive(Clone, Copy, Debug)]
struct Sample {
    /// From the origin of the pair.
    arm: DVec3,
    normal: DVec3,
    /// k V (h/D + δ), with the depth D of the patch.
    damping: f64,
    /// Final normal velocity (m/s) at which the force is zero.
    free_speed: f64,
    /// Normal force at the end of the step as last computed; zero where the contact lets go.
    force: f64,
    slip: f64,
}

impl PairContacts {
    /// From the samples of `contact`, measured at the predicted poses; `dt` is the time step (s).
    pub(crate) fn new(
        bodies: [usize; 2],
        states: [&SolverBody; 2],
        material: Material,
        contact: &Contact,
        dt: f64,
    ) -> Self {
        let volume: f64 = contact.samples.iter().map(|s| f64::from(s.volume)).sum();
        let moment: DVec3 = contact.samples.iter().map(|s| s.point.as_dvec3() * f64::from(s.volume)).sum();
        let [displacement_a, displacement_b] = contact.displacements;
        let back = backtracking(states, contact.displacements);
        let origin = moment / volume.max(f64::MIN_POSITIVE);
        let origin = origin - back(origin);
        let before = relative_twist(states, origin);
        let patches = patches(&contact.samples);
        let depth = patches.iter().map(|patch| patch.depth).fold(0.0, f64::max);
        let samples = patches.iter().flat_map(|patch| patch.samples.iter().map(|&s| (s, patch.depth)));
        let samples = samples.map(|(s, depth)| {
            let point = s.point.as_dvec3();
            let arm = point - back(point) - origin;
            let normal = s.normal.as_dvec3();
            let velocity = before.twist_at(arm).linear;
            let approach = velocity.dot(normal);
            let (spring, rate) = (dt / depth, dt / depth + material.dissipation);
            let moved = (displacement_b.at(point) - displacement_a.at(point)).dot(normal) / dt;
            let rebounds = material.restitution > 0.0 && approach < -material.rebound_speed;
            let rebound = if rebounds { -material.restitution * approach } else { f64::NEG_INFINITY };
            // What would push faster than the recovery speed is damped more, with the same force at rest.
            // Dissipation acts on the velocity itself, not on what it differs from the predicted one.
            let at_rest = material.stiffness * f64::from(s.volume) * (1.0 + spring * moved);
            let free_speed = ((1.0 + spring * moved) / rate).min(material.recovery_speed);
            let damping = (at_rest / free_speed).max(material.stiffness * f64::from(s.volume) * rate);
            let free_speed = free_speed.max(rebound);
            let force = (damping * (free_speed - approach)).max(0.0);
            Sample { arm, normal, damping, free_speed, force, slip: slip(velocity, normal) }
        });
        let samples: Vec<Sample> = samples.collect();
        let patches = patches.iter().map(|patch| PatchSum::of(patch, |point| point - back(point) - origin));
        let patches = patches.collect();
        let (offset, damping) = (Screw::ZERO, Symmetric6::ZERO);
        Self { bodies, origin, depth, material, samples, patches, offset, damping }
    }

    /// Linearises the wrench about the forces and slips of the last pass.
    ///
    /// Per sample the force on b is `n c_n (u_0 − n·u) − c_t (u − n n·u)` with `c_n = k V (h/D + δ)` and the
    /// regularised Coulomb coefficient `c_t = μ f / max(|u_t|, u_creep)` of the last pass.
    pub(crate) fn linearize(&mut self) {
        (self.offset, self.damping) = (Screw::ZERO, Symmetric6::ZERO);
        let mut samples = self.samples.iter();
        for patch in &mut self.patches {
            (patch.offset, patch.damping) = (Screw::ZERO, Symmetric6::ZERO);
            for s in samples.by_ref().take(patch.count).filter(|s| s.force > 0.0) {
                let tangential = self.material.friction * s.force / s.slip.max(self.material.creep_speed);
                let outer =
                    DMat3::from_cols(s.normal * s.normal.x, s.normal * s.normal.y, s.normal * s.normal.z);
                let damper =
                    outer * (s.damping - tangential) + DMat3::from_diagonal(DVec3::splat(tangential));
                patch.damping.add_damper(damper, s.arm);
                let force = s.normal * (s.damping * s.free_speed);
                patch.offset += Screw { linear: force, angular: s.arm.cross(force) };
            }
            self.offset += patch.offset;
            self.damping += patch.damping;
        }
    }

    /// Takes over the relative twist of a solve for the next linearisation: normal forces, contacts that let go or take
    /// hold, slip. Returns how much the normal forces changed, relative to their sum.
    pub(crate) fn update(&mut self, twist: Screw) -> f64 {
        let (mut change, mut total) = (0.0, 0.0);
        for s in &mut self.samples {
            let velocity = twist.twist_at(s.arm).linear;
            let force = (s.damping * (s.free_speed - velocity.dot(s.normal))).max(0.0);
            change += (force - s.force).abs();
            total += force.max(s.force);
            s.force = force;
            s.slip = slip(velocity, s.normal);
        }
        if total > 0.0 { change / total } else { 0.0 }
    }

    /// Wrench on b about [`Self::origin`] at the given relative twist.
    pub(crate) fn wrench(&self, twist: Screw) -> Screw {
        self.offset - self.damping * twist
    }

    /// Velocity of b relative to a at [`Self::origin`].
    pub(crate) fn relative_twist(&self, bodies: &[SolverBody], of: impl Fn(usize) -> Screw) -> Screw {
        let [a, b] = self.bodies;
        of(b).twist_at(self.origin - bodies[b].center_of_mass)
            - of(a).twist_at(self.origin - bodies[a].center_of_mass)
    }

    pub(crate) fn damping(&self) -> &Symmetric6 {
        &self.damping
    }
}

/// How far a point of the predicted contact lies from where the wrench acts on the bodies as they are now.
///
/// The point has moved with both bodies. Where only one of them can move its motion counts, for two the mean: both
/// feel the wrench at one point, so that momentum and angular momentum are kept exactly.
fn backtracking(states: [&SolverBody; 2], displacements: [Displacement; 2]) -> impl Fn(DVec3) -> DVec3 {
    let weights = match states.map(SolverBody::is_movable) {
        [true, false] => [1.0, 0.0],
        [false, true] => [0.0, 1.0],
        _ => [0.5, 0.5],
    };
    move |point| displacements[0].at(point) * weights[0] + displacements[1].at(point) * weights[1]
}

/// Velocity of the second body relative to the first at `at`, before the step.
fn relative_twist(states: [&SolverBody; 2], at: DVec3) -> Screw {
    let [a, b] = states.map(|body| body.velocity.twist_at(at - body.center_of_mass));
    b - a
}

fn slip(velocity: DVec3, normal: DVec3) -> f64 {
    (velocity - normal * velocity.dot(normal)).length()
}
