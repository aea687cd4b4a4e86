//! A pile to which bodies come and from which they go.

use super::{Pile, PileOptions};
use crate::figures::Summary;
use crate::run::{Body, Check, Simulation, Soak, Wanted};
use anyhow::{Result, ensure};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rapier_ist::IstPlugin;
use rapier3d::pipeline::PhysicsWorld;

/// Steps between two changes, at least and at most: some come while the last body is still in the air, others when all sleep.
const PAUSE: [usize; 2] = [10, 240];
/// Bodies that come or go at once, at most.
const AT_ONCE: usize = 3;
/// Fewest bodies, as a share of those that there are to begin with; these are the most.
const FEWEST: f32 = 0.6;
/// Where new bodies begin to fall: height over the centre of the bowl's sphere (m), which is 0.3 m above its rim …
const HEIGHT: f32 = 0.3;
/// … and greatest distance from its axis (m).
const ASIDE: f32 = 0.8;
/// Distance of a new body's centre from all others (m): the largest bodies lie in balls of this diameter.
const FREE: f32 = 0.7;

/// The pile, and who should be in it.
pub struct SoakedPile {
    pile: Pile,
    random: Pcg64Mcg,
    most: usize,
    /// Steps until the next change.
    pause: usize,
    changes: usize,
    /// Bodies that should be there.
    expected: usize,
    /// Bodies out of the bowl, over all steps.
    out: usize,
    /// Steps after which a body or collider was there that should not be, or the other way round.
    miscounted: usize,
}

impl SoakedPile {
    /// Builds the pile of `options` and makes changes by `seed`.
    ///
    /// # Errors
    /// As [`Pile::new`], and for less than two bodies.
    pub fn new(options: &PileOptions, seed: u64, progress: impl FnMut(&str)) -> Result<Self> {
        ensure!(
            options.bodies > 1,
            "a pile of {} bodies has nothing to change; ask for more (--bodies)",
            options.bodies
        );
        Ok(Self {
            pile: Pile::new(options, progress)?,
            random: Pcg64Mcg::seed_from_u64(seed),
            most: options.bodies,
            pause: PAUSE[1],
            changes: 0,
            expected: options.bodies,
            out: 0,
            miscounted: 0,
        })
    }

    /// Lets some bodies come, or go.
    fn change(&mut self) {
        let fewest = (FEWEST * self.most as f32) as usize;
        let count = self.random.random_range(1..=AT_ONCE);
        let come = match self.expected {
            few if few <= fewest => true,
            many if many >= self.most => false,
            _ => self.random.random_range(0..2) == 0,
        };
        for _ in 0..count {
            if come && self.expected < self.most {
                self.let_come();
            } else if !come && self.expected > 1 {
                let index = self.random.random_range(0..self.pile.bodies.len());
                self.pile.remove(index);
                self.expected -= 1;
                self.changes += 1;
            }
        }
    }

    /// Adds a body where there is room; where there is none, nobody comes.
    fn let_come(&mut self) {
        let [x, z]: [f32; 2] = std::array::from_fn(|_| self.random.random_range(-ASIDE..ASIDE));
        let position = Vec3::new(x, HEIGHT, z);
        let near = |body: &super::PileBody| {
            self.pile.world.bodies[body.handle].translation().distance(position) < FREE
        };
        if self.pile.bodies.iter().any(near) {
            return;
        }
        let model = self.random.random_range(0..self.pile.models.len());
        // Scaling fails for sizes that are none only, and these are not.
        if self.pile.add(position, model, &mut self.random).is_ok() {
            self.expected += 1;
            self.changes += 1;
        }
    }
}

impl Simulation for SoakedPile {
    fn title(&self) -> String {
        format!("{} of up to {} bodies that come and go", self.pile.title(), self.most)
    }

    fn world(&self) -> &PhysicsWorld {
        &self.pile.world
    }

    fn plugin(&self) -> &IstPlugin {
        &self.pile.plugin
    }

    fn step(&mut self) {
        if self.pause == 0 {
            self.change();
            self.pause = self.random.random_range(PAUSE[0]..PAUSE[1]);
        }
        self.pause -= 1;
        self.pile.step();
        self.out += self.pile.lost();
        // And the bowl.
        let wanted = self.expected + 1;
        let there =
            [self.pile.world.bodies.len(), self.pile.world.colliders.len(), self.pile.bodies.len() + 1];
        self.miscounted += usize::from(there != [wanted; 3]);
    }

    fn bodies(&self) -> Vec<Body<'_>> {
        self.pile.bodies()
    }

    fn checks(&self, _: &Summary) -> Vec<Check> {
        let none = Wanted::AtMost(0.0);
        vec![
            Check::new("bodies out of the bowl, over all steps", self.out as f64, "", none),
            Check::new("steps with a body too few or too many", self.miscounted as f64, "", none),
        ]
    }

    fn lost(&self) -> usize {
        self.pile.lost()
    }
}

impl Soak for SoakedPile {
    fn clear(&mut self) {
        while !self.pile.bodies.is_empty() {
            self.pile.remove(0);
        }
        (self.expected, self.pause) = (0, usize::MAX);
    }

    fn changes(&self) -> usize {
        self.changes
    }
}
