//! A chain of rings, pushed: it swings.

use super::{Chain, Ring};
use crate::figures::Summary;
use crate::run::{Body, Check, Simulation, View, Wanted};
use anyhow::Result;
use glam::Vec3;
use rapier_ist::IstPlugin;
use rapier3d::pipeline::PhysicsWorld;

/// Rings that hang from the fixed one.
pub(super) const RINGS: usize = 12;
/// Density of the rings (kg/m³).
pub(super) const DENSITY: f32 = 1000.0;
/// Steps that the chain has to come to hang, before the push.
const HANGS_AFTER: usize = 120;
/// Speed that the push gives to the lower half (m/s).
const PUSH: f32 = 2.0;
/// Whole swings from which a period is taken.
const SWINGS: usize = 3;

/// The chain and what was seen of it.
pub struct Swing {
    chain: Chain,
    ring: Ring,
    steps: usize,
    /// Pairs of neighbours found apart, steps times pairs.
    unlinked: usize,
    /// Length before the push (m).
    hanging: f32,
    /// Least kinetic and potential energy since the push (J).
    least_energy: f64,
    /// Most that there was over the least before it (J): a chain that only loses energy has none.
    energy_gain: f64,
    /// Kinetic energy that the push gave (J).
    pushed: f64,
    /// When the last ring passed below the first in the direction of the push (s).
    passages: Vec<f64>,
    /// Greatest sideways distance of the last ring (m).
    farthest: f32,
}

impl Swing {
    /// Packs a ring with `spheres` spheres and hangs twelve of it from a thirteenth.
    ///
    /// # Errors
    /// If `spheres` is zero.
    pub fn new(spheres: usize) -> Result<Self> {
        let ring = Ring::new(spheres)?;
        let chain = Chain::new(RINGS, &ring.shape(), DENSITY);
        Ok(Self {
            chain,
            ring,
            steps: 0,
            unlinked: 0,
            hanging: f32::NAN,
            least_energy: f64::NAN,
            energy_gain: 0.0,
            pushed: f64::NAN,
            passages: Vec::new(),
            farthest: 0.0,
        })
    }

    /// Gives the lower half a push, and notes what the chain is like before it.
    fn push(&mut self) {
        self.hanging = self.chain.length();
        let before = self.energy();
        for &ring in &self.chain.rings[RINGS / 2 + 1..] {
            let body = &mut self.chain.world.bodies[ring];
            body.set_linvel(body.linvel() + Vec3::X * PUSH, true);
        }
        self.least_energy = self.energy();
        self.pushed = self.least_energy - before;
    }

    /// Kinetic and potential energy of all rings (J).
    fn energy(&self) -> f64 {
        let world = &self.chain.world;
        let energy = |body: &rapier3d::dynamics::RigidBody| {
            let height = -f64::from(world.gravity.dot(body.center_of_mass()));
            f64::from(body.kinetic_energy()) + f64::from(body.mass()) * height
        };
        self.chain.rings.iter().map(|&ring| &world.bodies[ring]).filter(|b| b.is_dynamic()).map(energy).sum()
    }

    fn last_ring(&self) -> Vec3 {
        self.chain.world.bodies[self.chain.rings[RINGS]].translation()
    }

    /// Mean time of a whole swing (s), if there were enough.
    fn period(&self) -> Option<f64> {
        let (first, last) = (self.passages.first()?, self.passages.last()?);
        (self.passages.len() > SWINGS).then(|| (last - first) / (self.passages.len() - 1) as f64)
    }

    /// Period of the first mode of a uniform chain of this length (s): 2 π / ω with ω = j / 2 √(g / l) and j = 2.4048
    /// the first zero of the Bessel function J₀ (Daniel Bernoulli, 1733). For small swings, and links much smaller than
    /// the chain.
    fn uniform_period(&self) -> f64 {
        const FIRST_ZERO: f64 = 2.404_825_557_695_773;
        let gravity = f64::from(self.chain.world.gravity.length());
        let length = f64::from(Chain::pitch()) * RINGS as f64;
        4.0 * std::f64::consts::PI / FIRST_ZERO * (length / gravity).sqrt()
    }
}

impl Simulation for Swing {
    fn title(&self) -> String {
        format!("chain of {RINGS} rings under a fixed one")
    }

    fn world(&self) -> &PhysicsWorld {
        &self.chain.world
    }

    fn plugin(&self) -> &IstPlugin {
        &self.chain.plugin
    }

    fn step(&mut self) {
        if self.steps == HANGS_AFTER {
            self.push();
        }
        let before = self.last_ring().x;
        self.chain.plugin.step(&mut self.chain.world);
        self.steps += 1;
        self.unlinked += usize::from(!self.chain.is_linked());
        if self.steps > HANGS_AFTER {
            let after = self.last_ring().x;
            self.farthest = self.farthest.max(after.abs());
            let energy = self.energy();
            self.energy_gain = self.energy_gain.max(energy - self.least_energy);
            self.least_energy = self.least_energy.min(energy);
            if before < 0.0 && after >= 0.0 {
                let dt = f64::from(self.chain.world.integration_parameters.dt);
                let since = f64::from(after / (after - before));
                self.passages.push((self.steps as f64 - since) * dt);
            }
        }
    }

    fn bodies(&self) -> Vec<Body<'_>> {
        self.chain.bodies(&self.ring)
    }

    fn checks(&self, _: &Summary) -> Vec<Check> {
        let mut checks =
            vec![Check::new("steps with a lost link", self.unlinked as f64, "", Wanted::AtMost(0.0))];
        if self.steps <= HANGS_AFTER {
            return checks;
        }
        checks.push(Check::new(
            "most energy gained back",
            100.0 * self.energy_gain / self.pushed,
            "% of the push",
            Wanted::AtMost(2.0),
        ));
        let drift = 100.0 * f64::from(self.chain.length() / self.hanging - 1.0).abs();
        checks.push(Check::new("change of length", drift, "%", Wanted::AtMost(1.0)));
        checks.push(Check::new("swing", f64::from(self.farthest), "m", Wanted::AtLeast(0.3)));
        if let Some(period) = self.period() {
            let wanted = Wanted::Near { value: self.uniform_period(), tolerance: 0.05 };
            checks.push(Check::new("period of a swing", period, "s", wanted));
        }
        checks
    }

    fn view(&self) -> View {
        View { from: Vec3::new(0.35, 0.12, 1.0), ..View::default() }
    }

    fn metadata(&self) -> Vec<(&'static str, String)> {
        vec![("example", "chain".to_owned())]
    }

    /// Rings that are no longer in their neighbours.
    fn lost(&self) -> usize {
        self.chain.lost_links()
    }
}
