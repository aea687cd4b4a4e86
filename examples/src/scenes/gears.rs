//! Two spur gears: a motor turns the first, the first turns the second against a load.

use super::contact_wrench::contact_wrench;
use super::{Part, Turning};
use crate::figures::Summary;
use crate::palette;
use crate::run::{Body, Check, Simulation, View, Wanted};
use crate::shapes::SpurGear;
use anyhow::Result;
use glam::Vec3;
use rapier_ist::IstPlugin;
use rapier3d::dynamics::{MotorModel, RevoluteJointBuilder, RigidBodyBuilder, RigidBodyHandle};
use rapier3d::math::{Pose, Real};
use rapier3d::pipeline::PhysicsWorld;
use std::f64::consts::{PI, TAU};

/// Teeth of the driving gear and of the driven one. The tips of either stay on the other's involutes.
const TEETH: [u32; 2] = [14, 21];
/// Pitch diameter per tooth (m): pitch diameters of 0.7 m and 1.05 m.
const MODULE: f64 = 0.05;
/// Width of the gears and radius of their bores (m).
const WIDTH: f64 = 0.15;
const BORE: f64 = 0.08;
/// Play between the teeth along the pitch circle (m), an eighth of a tooth.
///
/// The balls of 3,000 spheres stand out of the flanks by up to some millimetres. With 4 mm of play teeth of either side touch
/// at once, and 71 % of the motor's work reaches the load; with 6, 8 and 10 mm 80, 86 and 90 % (3 rad/s, no friction).
const BACKLASH: f64 = 0.01;
/// Density of the gears (kg/m³).
const DENSITY: Real = 1000.0;
/// Coulomb friction of the teeth, as of greased steel. Joints have none.
const FRICTION: Real = 0.1;
/// Speed at which the motor gives no torque (rad/s), and torque per speed below it (N·m·s).
const MOTOR_SPEED: f64 = 2.0;
const MOTOR_DAMPING: f64 = 40.0;
/// Torque of the load per speed of the driven gear (N·m·s).
const LOAD_DAMPING: f64 = 20.0;
/// Steps until the speeds are steady: ten times the time in which the motor comes up to speed.
const START_UP: usize = 120;

/// The gears, and what has been measured of them since they came up to speed.
pub struct Gears {
    /// The Rapier world.
    pub world: PhysicsWorld,
    /// Steps it.
    pub plugin: IstPlugin,
    /// The driving gear and the driven one.
    pub gears: [RigidBodyHandle; 2],
    parts: [Part; 2],
    turnings: [Turning; 2],
    steps: usize,
    /// Angles at the end of the start-up (rad).
    steady: [f64; 2],
    /// Largest distance of the driven gear from where the driving one wants it (rad).
    deviation: f64,
    /// Work of the teeth on both gears after the start-up (J).
    work: [f64; 2],
}

impl Gears {
    /// Packs both gears with `spheres` spheres each and meshes them; axes are vertical.
    ///
    /// # Errors
    /// If `spheres` is zero.
    pub fn new(spheres: usize) -> Result<Self> {
        let shapes = TEETH.map(gear);
        let [first, second] = shapes.map(|shape| Part::new("gear", &shape.mesh(), spheres));
        let parts = [first?, second?];
        let mut world = PhysicsWorld::new();
        let plugin = IstPlugin::install(&mut world);
        let distance = shapes.iter().map(SpurGear::pitch_radius).sum::<f64>() as Real;
        // A tooth of the first gear points at the middle of a gap of the second.
        let second = Pose::new(Vec3::X * distance, Vec3::Y * (PI - PI / f64::from(TEETH[1])) as Real);
        let driving = insert(&mut world, &parts[0], Pose::IDENTITY, [MOTOR_SPEED, MOTOR_DAMPING]);
        let driven = insert(&mut world, &parts[1], second, [0.0, LOAD_DAMPING]);
        let gears = [driving, driven];
        let turnings = gears.map(|gear| Turning::new(world.bodies[gear].rotation()));
        Ok(Self {
            world,
            plugin,
            gears,
            parts,
            turnings,
            steps: 0,
            steady: [0.0; 2],
            deviation: 0.0,
            work: [0.0; 2],
        })
    }

    /// Steps the world once and measures.
    pub fn step(&mut self) {
        self.plugin.step(&mut self.world);
        let before = self.turnings.map(|turning| turning.angle());
        for (turning, gear) in self.turnings.iter_mut().zip(self.gears) {
            turning.update(self.world.bodies[gear].rotation());
        }
        self.steps += 1;
        let [driving, driven] = self.turnings.map(|turning| turning.angle());
        self.deviation = self.deviation.max((driven + driving * ratio()).abs());
        if self.steps <= START_UP {
            self.steady = [driving, driven];
            return;
        }
        let torques = self.torques();
        for i in [0, 1] {
            self.work[i] += torques[i] * (self.turnings[i].angle() - before[i]);
        }
    }

    /// Torques that the teeth exerted on the two gears in the last step, about their axles (N·m).
    fn torques(&self) -> [f64; 2] {
        self.gears.map(|gear| contact_wrench(&self.world, &self.plugin, gear).1.y)
    }

    /// Turns of both gears since the start-up, positive about the upward axis.
    #[must_use]
    pub fn turns(&self) -> [f64; 2] {
        [0, 1].map(|i| (self.turnings[i].angle() - self.steady[i]) / TAU)
    }

    /// How far the driven gear has been from where the driving one wants it, in units of half a tooth; from 1 on the gears may
    /// have skipped a tooth.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        self.deviation / (PI / f64::from(TEETH[1]))
    }

    /// Share of the work taken from the driving gear since the start-up that the driven gear has got; the rest went into
    /// friction and damping between the teeth.
    #[must_use]
    pub fn efficiency(&self) -> f64 {
        -self.work[1] / self.work[0]
    }
}

/// Turns of the driven gear per turn of the driving one.
fn ratio() -> f64 {
    f64::from(TEETH[0]) / f64::from(TEETH[1])
}

fn gear(teeth: u32) -> SpurGear {
    let pressure_angle = 20_f64.to_radians();
    SpurGear { module: MODULE, teeth, pressure_angle, backlash: BACKLASH, width: WIDTH, bore: BORE }
}

/// A gear on a fixed axle; `[speed, damping]` are those of the motor in its joint, which works towards the speed.
fn insert(world: &mut PhysicsWorld, part: &Part, pose: Pose, [speed, damping]: [f64; 2]) -> RigidBodyHandle {
    let axle = world.insert_body(RigidBodyBuilder::fixed().pose(pose));
    let collider = part.shape().into_collider().density(DENSITY).friction(FRICTION);
    let (gear, _) = world.insert(RigidBodyBuilder::dynamic().pose(pose).can_sleep(false), collider);
    let joint = RevoluteJointBuilder::new(Vec3::Y)
        .motor_model(MotorModel::ForceBased)
        .motor_velocity(speed as Real, damping as Real);
    world.insert_impulse_joint(axle, gear, joint);
    gear
}

impl Simulation for Gears {
    fn title(&self) -> String {
        format!("gears, {} and {} teeth", TEETH[0], TEETH[1])
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
        let names = ["driving_gear", "driven_gear"];
        let body = |i: usize| {
            let part = &self.parts[i];
            Body::new(self.gears[i], names[i], &part.solid).packing(&part.packing).color(palette::color(i))
        };
        vec![body(0), body(1)]
    }

    fn checks(&self, _: &Summary) -> Vec<Check> {
        let [driving, driven] = self.turns();
        let mut checks = vec![Check::new(
            "largest distance from the ideal angle",
            100.0 * self.deviation(),
            "% of half a tooth",
            Wanted::AtMost(20.0),
        )];
        if self.steps >= 4 * START_UP {
            let near = Wanted::Near { value: -ratio(), tolerance: 0.01 };
            checks.extend([
                Check::new("turns of the driving gear", driving, "", Wanted::AtLeast(1.0)),
                Check::new(
                    "turns of the driven gear per turn of the driving one",
                    driven / driving,
                    "",
                    near,
                ),
                Check::new(
                    "work that the driven gear gets",
                    100.0 * self.efficiency(),
                    "%",
                    Wanted::AtLeast(80.0),
                ),
            ]);
        }
        checks
    }

    fn view(&self) -> View {
        View { from: Vec3::new(-0.1, 1.0, 0.55), ground: Some((-0.5 * WIDTH) as f32), ..View::default() }
    }

    fn metadata(&self) -> Vec<(&'static str, String)> {
        vec![("example", "gears".to_owned()), ("teeth", format!("{} {}", TEETH[0], TEETH[1]))]
    }
}
