//! A nut that turns down a bolt by its weight.

use super::{Part, Turning};
use crate::figures::Summary;
use crate::palette;
use crate::render::{CutPlane, Section};
use crate::run::{Body, Check, Simulation, View, Wanted};
use crate::shapes::ScrewThread;
use anyhow::Result;
use glam::Vec3;
use rapier_ist::IstPlugin;
use rapier3d::dynamics::{RigidBodyBuilder, RigidBodyHandle};
use rapier3d::math::{Pose, Real};
use rapier3d::pipeline::PhysicsWorld;
use std::f64::consts::TAU;

/// Coarse: 9.1° of lead at the mean radius (m).
const THREAD: ScrewThread = ScrewThread { radius: 0.1, depth: 0.05, pitch: 0.1, facets: [48, 24] };
/// The nut's thread is wider by this radius (m). The balls of 5,000 spheres stand out of the flanks by some millimetres: with
/// 8 mm the nut would touch both flanks at once, and normal forces at rest add up to 38 times its weight; with 16 mm to 1.24
/// times, as on one flank. With 13 mm a nut of 1,000 spheres is stuck.
const PLAY: f64 = 0.016;
/// Contact skin of both (m): about what the balls do not reach of the crests.
const SKIN: Real = 0.002;
/// Width across flats of head and nut, height of the head, of the thread and of the nut (m).
const ACROSS_FLATS: f64 = 0.36;
const HEAD: f64 = 0.1;
const LENGTH: f64 = 0.8;
const HEIGHT: f64 = 0.2;
/// Density of the nut (kg/m³).
const DENSITY: Real = 1000.0;
/// Where the nut's weight has settled on the thread, below the middle of the play (m).
const SETTLED: f64 = 0.0025;
/// Coulomb friction by default: an oiled thread.
const FRICTION: f64 = 0.02;
/// The advance is measured from here on (turns): the nut has then settled on its flank.
const SETTLING: f64 = 0.25;
/// The acceleration is measured between these (turns).
const TIMED: [f64; 2] = [0.5, 2.0];
/// How far the acceleration may be from that of the closed form: it is 0.98 of it without friction and 0.92 with 0.02 (5,000
/// spheres).
const ACCELERATION_TOLERANCE: f64 = 0.1;
/// Steps after which a nut that turns must have turned twice.
const TWO_TURNS_AFTER: usize = 170;

/// Bolt and nut, and what has been measured.
pub struct Bolt {
    /// The Rapier world.
    pub world: PhysicsWorld,
    /// Steps it.
    pub plugin: IstPlugin,
    /// The nut.
    pub nut: RigidBodyHandle,
    bolt: RigidBodyHandle,
    parts: [Part; 2],
    friction: f64,
    turning: Turning,
    /// Turns down the thread and height (m) at the end of each step; until the nut is near the head.
    path: Vec<[f64; 2]>,
    tilt: f64,
    offset: f64,
}

impl Bolt {
    /// Packs bolt and nut with `spheres` spheres each and puts the nut on the upper end of the thread; `friction` is
    /// Coulomb's coefficient.
    ///
    /// # Errors
    /// If `spheres` is zero.
    pub fn new(spheres: usize, friction: f64) -> Result<Self> {
        let bolt = Part::new("bolt", &THREAD.bolt(ACROSS_FLATS, HEAD, LENGTH), spheres)?;
        let nut = Part::new("nut", &THREAD.widened(PLAY).nut(ACROSS_FLATS, HEIGHT), spheres)?;
        let mut world = PhysicsWorld::new();
        let plugin = IstPlugin::install(&mut world);
        let collider =
            |part: &Part| part.shape().into_collider().friction(friction as Real).contact_skin(SKIN);
        let (standing, _) = world.insert(RigidBodyBuilder::fixed(), collider(&bolt));
        // All of the nut on the full thread. Its own thread begins at its underside, the bolt's at the head.
        let lift = LENGTH - HEIGHT - 0.5 * THREAD.pitch;
        let turn = TAU * (lift / THREAD.pitch).rem_euclid(1.0);
        let center = Vec3::Y * (HEAD + lift + 0.5 * HEIGHT - SETTLED) as Real;
        let body =
            RigidBodyBuilder::dynamic().pose(Pose::new(center, Vec3::Y * turn as Real)).can_sleep(false);
        let (handle, _) = world.insert(body, collider(&nut).density(DENSITY));
        let turning = Turning::new(world.bodies[handle].rotation());
        Ok(Self {
            world,
            plugin,
            nut: handle,
            bolt: standing,
            parts: [bolt, nut],
            friction,
            turning,
            path: Vec::new(),
            tilt: 0.0,
            offset: 0.0,
        })
    }

    /// Steps the world once and measures.
    pub fn step(&mut self) {
        self.plugin.step(&mut self.world);
        let nut = &self.world.bodies[self.nut];
        self.turning.update(nut.rotation());
        let place = nut.translation().as_dvec3();
        if place.y - 0.5 * HEIGHT < HEAD + 0.6 * THREAD.pitch {
            return;
        }
        self.path.push([-self.turning.angle() / TAU, place.y]);
        self.tilt = self.tilt.max((*nut.rotation() * Vec3::Y).angle_between(Vec3::Y).into());
        self.offset = self.offset.max(place.x.hypot(place.z));
    }

    /// Turns down the thread.
    #[must_use]
    pub fn turns(&self) -> f64 {
        self.path.last().map_or(0.0, |[turns, _]| *turns)
    }

    /// Way down per turn (m), after the nut has settled; `None` before.
    #[must_use]
    pub fn advance_per_turn(&self) -> Option<f64> {
        let [first, before] = *self.path.iter().find(|[turns, _]| *turns >= SETTLING)?;
        let [last, after] = *self.path.last()?;
        (last > first).then(|| (before - after) / (last - first))
    }

    /// Acceleration of the nut along the axis (m/s²), positive downwards; `None` before two turns.
    ///
    /// A nut that starts from rest at any time has turned by α (t − t₀)² / 2: roots of angles grow evenly.
    #[must_use]
    pub fn acceleration(&self) -> Option<f64> {
        let [start, end] = TIMED;
        let rate = (end.sqrt() - start.sqrt()) / (self.time_of(end)? - self.time_of(start)?);
        Some(2.0 * rate * rate * THREAD.pitch)
    }

    /// When the nut had turned so far (s).
    fn time_of(&self, turns: f64) -> Option<f64> {
        let after = self.path.iter().position(|[now, _]| *now >= turns).filter(|&after| after > 0)?;
        let [before, now] = [after - 1, after].map(|i| self.path[i][0]);
        let dt = f64::from(self.world.integration_parameters.dt);
        // The first place is that after a step.
        Some((after as f64 + (turns - before) / (now - before)) * dt)
    }

    /// What the acceleration would be on a smooth, rigid thread (m/s²); negative where friction holds the nut.
    ///
    /// At the mean radius R, with the lead tan λ = p / 2πR and the flank tan β, the normal n of the flank has the axial part
    /// `n_a = 1 / √(1 + tan² λ + tan² β)` and the part `n_t = n_a tan λ` along the circumference. The force N along it and
    /// friction μN along the helix give `m a = m g − N (n_a + μ sin λ)` and `I α = N R (n_t − μ cos λ)`, with
    /// `α = a / (R tan λ)`: the equations of power screws in any textbook, with inertia.
    #[must_use]
    pub fn ideal_acceleration(&self) -> f64 {
        let mass = self.world.bodies[self.nut].mass_properties().local_mprops;
        let inertia = f64::from(mass.reconstruct_inertia_matrix().y_axis.y);
        let (lead, flank) = (THREAD.lead(), THREAD.flank());
        let axial = (1.0 + lead * lead + flank * flank).sqrt().recip();
        let along = (1.0 + lead * lead).sqrt().recip();
        let lifting = axial + self.friction * lead * along;
        let turning = axial * lead - self.friction * along;
        let gravity = f64::from(self.world.gravity.length());
        let radius = THREAD.radius;
        let ratio = inertia / (f64::from(mass.mass()) * radius * radius * lead);
        gravity / (1.0 + ratio * lifting / turning)
    }

    /// Largest lean of the nut's axis (rad).
    #[must_use]
    pub fn tilt(&self) -> f64 {
        self.tilt
    }

    /// Largest distance of the nut's centre from the bolt's axis (m).
    #[must_use]
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// Pitch of the thread (m).
    #[must_use]
    pub fn pitch() -> f64 {
        THREAD.pitch
    }

    /// Friction that the example has by default.
    #[must_use]
    pub fn default_friction() -> f64 {
        FRICTION
    }
}

impl Simulation for Bolt {
    fn title(&self) -> String {
        format!("bolt, friction {}", self.friction)
    }

    fn world(&self) -> &PhysicsWorld {
        &self.world
    }

    fn plugin(&self) -> &IstPlugin {
        &self.plugin
    }

    fn step(&mut self) {
        Self::step(self);
    }

    fn bodies(&self) -> Vec<Body<'_>> {
        let [bolt, nut] = &self.parts;
        vec![
            Body::new(self.bolt, "bolt", &bolt.solid).packing(&bolt.packing),
            Body::new(self.nut, "nut", &nut.solid)
                .packing(&nut.packing)
                .color(palette::color(1))
                .section(Section::Capped),
        ]
    }

    fn checks(&self, summary: &Summary) -> Vec<Check> {
        let ideal = self.ideal_acceleration();
        let mut checks = vec![
            Check::new("largest tilt of the nut", self.tilt().to_degrees(), "°", Wanted::AtMost(3.0)),
            Check::new("largest offset of the nut", 1e3 * self.offset(), "mm", Wanted::AtMost(1e3 * PLAY)),
        ];
        if summary.steps < TWO_TURNS_AFTER {
            return checks;
        }
        if ideal <= 0.0 {
            checks.push(Check::new(
                "turns of a nut that friction holds",
                self.turns(),
                "",
                Wanted::AtMost(0.02),
            ));
            return checks;
        }
        let near = |value, tolerance| Wanted::Near { value, tolerance };
        let advance = |a| Check::new("advance per turn", a, "m", near(THREAD.pitch, 0.05));
        let acceleration = |a| Check::new("acceleration", a, "m/s²", near(ideal, ACCELERATION_TOLERANCE));
        let turns = Check::new("turns", self.turns(), "", Wanted::AtLeast(2.0));
        if self.friction <= FRICTION {
            checks.push(advance(self.advance_per_turn().unwrap_or(f64::NAN)));
            checks.extend([turns, acceleration(self.acceleration().unwrap_or(f64::NAN))]);
        } else {
            // Next to the friction that holds the nut it may stop, and its acceleration is the small difference of large forces.
            checks.extend(self.advance_per_turn().map(advance));
            checks.push(turns.reported());
            checks.extend(self.acceleration().map(|a| acceleration(a).reported()));
        }
        checks
    }

    fn view(&self) -> View {
        let cut = CutPlane { point: Vec3::ZERO, normal: Vec3::new(0.25, 0.0, 1.0).normalize() };
        View { from: Vec3::new(0.25, 0.35, 1.0), ground: Some(0.0), cut: Some(cut) }
    }

    fn metadata(&self) -> Vec<(&'static str, String)> {
        vec![("example", "bolt".to_owned()), ("friction", self.friction.to_string())]
    }
}
