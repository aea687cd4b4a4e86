//! A chain that is pushed again and again.

use super::swing::{DENSITY, RINGS};
use super::{Chain, Ring};
use crate::figures::Summary;
use crate::run::{Body, Check, Simulation, Soak, Wanted};
use anyhow::Result;
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rapier_ist::IstPlugin;
use rapier3d::dynamics::RigidBodyHandle;
use rapier3d::pipeline::PhysicsWorld;

/// Steps between two pushes, at least and at most: some come while the chain still swings, others when it sleeps.
const PAUSE: [usize; 2] = [60, 1200];
/// Greatest speed (m/s) that a push gives along each axis to a ring and all below it.
///
/// A push alone then moves rings by less than half the thickness of their wire against each other in a step. A chain of rings of
/// 150 spheres, seed 1, holds for an hour, stretched by 6.7 % at most and as fast as 3.2 m/s; with twice as much it parted after
/// 900 s, at 5.1 m/s.
const PUSH: f32 = 1.0;

/// Greatest stretch (%) that passes, where links pull hardest after a push.
const MOST_STRETCH: f64 = 10.0;

/// The chain, and what was seen of it.
pub struct SoakedChain {
    chain: Chain,
    ring: Ring,
    random: Pcg64Mcg,
    /// Steps until the next push.
    pause: usize,
    pushes: usize,
    /// Links found apart, over all steps.
    unlinked: usize,
    /// Greatest length of the line through the centres (m).
    longest: f32,
    /// Greatest speed of a ring as long as all were linked (m/s).
    fastest: f32,
    steps: usize,
    /// When a link was first found apart (s).
    parted: Option<f64>,
}

impl SoakedChain {
    /// Packs a ring with `spheres` spheres, hangs twelve of it from a thirteenth and pushes them by `seed`.
    ///
    /// # Errors
    /// If `spheres` is zero.
    pub fn new(spheres: usize, seed: u64) -> Result<Self> {
        let ring = Ring::new(spheres)?;
        Ok(Self {
            chain: Chain::new(RINGS, &ring.shape(), DENSITY),
            ring,
            random: Pcg64Mcg::seed_from_u64(seed),
            pause: PAUSE[0],
            pushes: 0,
            unlinked: 0,
            longest: 0.0,
            fastest: 0.0,
            steps: 0,
            parted: None,
        })
    }

    fn push(&mut self) {
        let first = self.random.random_range(1..=RINGS);
        let push = Vec3::from_array(std::array::from_fn(|_| self.random.random_range(-PUSH..PUSH)));
        for &ring in &self.chain.rings[first..] {
            let body = &mut self.chain.world.bodies[ring];
            body.set_linvel(body.linvel() + push, true);
        }
        self.pushes += 1;
    }
}

impl Simulation for SoakedChain {
    fn title(&self) -> String {
        format!("chain of {RINGS} rings under a fixed one, pushed at random")
    }

    fn world(&self) -> &PhysicsWorld {
        &self.chain.world
    }

    fn plugin(&self) -> &IstPlugin {
        &self.chain.plugin
    }

    fn step(&mut self) {
        if self.pause == 0 {
            self.push();
            self.pause = self.random.random_range(PAUSE[0]..PAUSE[1]);
        }
        self.pause -= 1;
        self.chain.plugin.step(&mut self.chain.world);
        self.steps += 1;
        let lost = self.chain.lost_links();
        self.unlinked += lost;
        if lost > 0 && self.parted.is_none() {
            self.parted = Some(self.steps as f64 * f64::from(self.chain.world.integration_parameters.dt));
        }
        if self.parted.is_none() {
            let speed = |ring: &RigidBodyHandle| self.chain.world.bodies[*ring].linvel().length();
            self.fastest = self.chain.rings.iter().map(speed).fold(self.fastest, f32::max);
        }
        self.longest = self.longest.max(self.chain.length());
    }

    fn bodies(&self) -> Vec<Body<'_>> {
        self.chain.bodies(&self.ring)
    }

    fn checks(&self, _: &Summary) -> Vec<Check> {
        let taut = Chain::pitch() * RINGS as f32;
        let stretch = 100.0 * f64::from(self.longest / taut - 1.0);
        let parted = self.parted.map(|time| Check::new("first lost link", time, "s", Wanted::Reported));
        let checks = [
            Check::new("lost links, over all steps", self.unlinked as f64, "", Wanted::AtMost(0.0)),
            Check::new("greatest stretch", stretch, "%", Wanted::AtMost(MOST_STRETCH)),
            Check::new("greatest speed", f64::from(self.fastest), "m/s", Wanted::Reported),
        ];
        checks.into_iter().chain(parted).collect()
    }

    fn lost(&self) -> usize {
        self.chain.lost_links()
    }
}

impl Soak for SoakedChain {
    fn clear(&mut self) {
        for ring in self.chain.rings.drain(1..) {
            self.chain.world.remove_body(ring);
        }
        self.pause = usize::MAX;
    }

    fn changes(&self) -> usize {
        self.pushes
    }
}
