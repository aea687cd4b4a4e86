//! A hand puts a gear onto a shaft, so that its teeth mesh with those of another; then that one turns it.

use super::contact_wrench::contact_wrench;
use super::{Hand, Part, Turning};
use crate::figures::Summary;
use crate::palette;
use crate::run::{Body, Check, Simulation, View, Wanted};
use crate::shapes::{Shaft, SpurGear, cuboid};
use anyhow::Result;
use glam::{DVec3, Vec3};
use packer::TriangleMesh;
use rapier_ist::IstPlugin;
use rapier3d::dynamics::{
    ImpulseJointHandle, JointAxis, MotorModel, RevoluteJointBuilder, RigidBodyBuilder, RigidBodyHandle,
};
use rapier3d::geometry::{ColliderBuilder, SharedShape};
use rapier3d::math::{Pose, Real};
use rapier3d::pipeline::PhysicsWorld;
use std::f64::consts::{PI, TAU};

/// Teeth of the gear that is carried and of the one that drives it, and pitch diameter per tooth (m): diameters of 7 and 10 cm.
const TEETH: [u32; 2] = [18, 24];
const MODULE: f64 = 0.004;
/// Width of the gears and radius of their bores (m).
const WIDTH: f64 = 0.012;
const BORE: f64 = 0.008;
/// Play between the teeth along the pitch circle, and of the bore on the shaft (m).
const BACKLASH: f64 = 0.0012;
const PLAY: f64 = 0.0006;
/// What the balls of shoulder and gear may stand out by together (m): 0.3 to 0.8 mm with 3,000 to 500 spheres.
const BUMPS: f64 = 0.001;
/// Shaft: height of its shoulder (m), which is the plane of the gears' lower sides, and how far it looks out of the gear.
const SHOULDER: f64 = 0.02;
const SHAFT: Shaft =
    Shaft { foot: [0.014, SHOULDER], journal: [BORE - PLAY, WIDTH + 0.003], tip: [0.004, 0.008] };
/// Thickness, breadth and length of a finger (m). It reaches down to the lower side of the gear, but for a millimetre, and fits
/// between two teeth.
const FINGER: DVec3 = DVec3::new(0.008, 0.06, 0.003);
/// Distance of the fingers' axes from that of the hand, open and as far as the motors would bring them (m): the gear's root circle stops
/// them before, so that they press with some newtons and hold it in the middle. Motors that gave all that they can would hold it anywhere.
const OPEN: Real = 0.05;
const CLOSED: Real = 0.03;
/// Most that a motor presses with (N), which it does while it closes.
const GRIP: Real = 15.0;
/// Densities of gears and fingers, of polyoxymethylene and aluminium (kg/m³), and Coulomb friction.
const DENSITY: Real = 1400.0;
const FINGER_DENSITY: Real = 2700.0;
const FRICTION: Real = 0.3;
/// Where the gear lies at first, on the ground, by what it is displaced there from where the hand takes it (m), and turned (rad).
const LIES_AT: Vec3 = Vec3::new(-0.15, 0.5 * WIDTH as Real, 0.05);
const DISPLACED: Vec3 = Vec3::new(0.0015, 0.0, -0.001);
const TURNED: f64 = 0.04;
/// Way of the hand: seconds at which it is somewhere, and where (m). In between its acceleration is continuous.
const ABOVE: Real = 0.08;
const WAY: [(f64, Vec3); 8] = [
    (0.2, Vec3::new(LIES_AT.x, LIES_AT.y + ABOVE, LIES_AT.z)),
    (0.8, LIES_AT),
    (1.2, LIES_AT),
    (1.8, Vec3::new(LIES_AT.x, SEAT.y + ABOVE, LIES_AT.z)),
    (2.8, Vec3::new(SEAT.x, SEAT.y + ABOVE, SEAT.z)),
    (3.8, SEAT),
    (4.2, SEAT),
    (4.8, Vec3::new(SEAT.x, SEAT.y + ABOVE, SEAT.z)),
];
const SEAT: Vec3 = Vec3::new(0.0, (SHOULDER + 0.5 * WIDTH) as Real, 0.0);
/// When the fingers close, are closed, the hand has lifted the gear, stands over the shaft, opens, and the motor starts (s).
const CLOSES: f64 = 0.8;
const LIFTED: f64 = 1.8;
const OVER_SHAFT: f64 = 2.8;
const OPENS: f64 = 3.9;
const STARTS: f64 = 4.8;
/// Speed of the motor (rad/s) and its torque per speed (N·m·s).
const MOTOR_SPEED: f64 = 2.0;
const MOTOR_DAMPING: f64 = 0.1;
/// Seconds until the speeds are steady.
const START_UP: f64 = 0.5;

/// The scene, and what has been measured.
pub struct Assembly {
    /// The Rapier world.
    pub world: PhysicsWorld,
    /// Steps it.
    pub plugin: IstPlugin,
    hand: Hand,
    /// The gear that is carried, and the one that drives it.
    gears: [RigidBodyHandle; 2],
    shaft: RigidBodyHandle,
    axle: ImpulseJointHandle,
    parts: Parts,
    steps: usize,
    turnings: [Turning; 2],
    /// Angles once the speeds are steady (rad).
    steady: [f64; 2],
    carried: Carried,
}

struct Parts {
    gears: [Part; 2],
    shaft: Part,
    finger: Part,
    palm: Part,
}

/// What was seen while the hand carried the gear over the ground.
#[derive(Clone, Copy, Debug, Default)]
struct Carried {
    /// The gear in the hand's frame when it was lifted, and the farthest from there since (m).
    lifted: Option<Pose>,
    slip: f64,
    /// Upward force of the fingers on it (N), added up over the steps.
    force: f64,
    steps: u32,
}

impl Assembly {
    /// Packs all parts, gears with `spheres` spheres each, and puts them where they are at first.
    ///
    /// # Errors
    /// If `spheres` is zero.
    pub fn new(spheres: usize) -> Result<Self> {
        let parts = Parts::new(spheres)?;
        let mut world = PhysicsWorld::new();
        let plugin = IstPlugin::install(&mut world);
        let ground = ColliderBuilder::new(SharedShape::halfspace(Vec3::Y)).friction(FRICTION);
        world.insert(RigidBodyBuilder::fixed(), ground);
        let collider =
            |part: &Part, density| part.shape().into_collider().density(density).friction(FRICTION);
        let (shaft, _) = world.insert(RigidBodyBuilder::fixed(), collider(&parts.shaft, 0.0));

        let lies = Pose::new(LIES_AT + DISPLACED, Vec3::Y * TURNED as Real);
        let body = RigidBodyBuilder::dynamic().pose(lies).can_sleep(false);
        let (gear, _) = world.insert(body, collider(&parts.gears[0], DENSITY));

        // A tooth of the carried gear points along x, at the middle of a gap of the driving one.
        let distance = TEETH.map(gear_of).iter().map(SpurGear::pitch_radius).sum::<f64>();
        let driving =
            Pose::new(SEAT + Vec3::X * distance as Real, Vec3::Y * (PI - PI / f64::from(TEETH[1])) as Real);
        let (driver, _) = world.insert(
            RigidBodyBuilder::dynamic().pose(driving).can_sleep(false),
            collider(&parts.gears[1], DENSITY),
        );
        let frame = world.insert_body(RigidBodyBuilder::fixed().pose(driving));
        let joint = RevoluteJointBuilder::new(Vec3::Y)
            .motor_model(MotorModel::ForceBased)
            .motor_velocity(0.0, MOTOR_DAMPING as Real);
        let axle = world.insert_impulse_joint(frame, driver, joint);

        // Fingers reach between teeth, half a tooth from where one points along x; two of them beside the driving gear.
        let gap = TAU / f64::from(TEETH[0]) * 3.5;
        let hand = Hand::new(
            &mut world,
            WAY[0].1,
            &collider(&parts.finger, FINGER_DENSITY),
            [OPEN, gap as Real],
            GRIP,
        );
        let gears = [gear, driver];
        let turnings = gears.map(|gear| Turning::new(world.bodies[gear].rotation()));
        Ok(Self {
            world,
            plugin,
            hand,
            gears,
            shaft,
            axle,
            parts,
            steps: 0,
            turnings,
            steady: [0.0; 2],
            carried: Carried::default(),
        })
    }

    /// Steps the world once and measures.
    pub fn step(&mut self) {
        let dt = f64::from(self.world.integration_parameters.dt);
        let end = (self.steps + 1) as f64 * dt;
        self.hand.move_to(&mut self.world, place_at(end));
        let closed = (CLOSES..OPENS).contains(&end);
        self.hand.spread(&mut self.world, if closed { CLOSED } else { OPEN });
        if end >= STARTS
            && let Some(joint) = self.world.impulse_joints.get_mut(self.axle, true)
        {
            joint.data.set_motor_velocity(JointAxis::AngX, MOTOR_SPEED as Real, MOTOR_DAMPING as Real);
        }
        self.plugin.step(&mut self.world);
        self.steps += 1;
        for (turning, gear) in self.turnings.iter_mut().zip(self.gears) {
            turning.update(self.world.bodies[gear].rotation());
        }
        if end < STARTS + START_UP {
            self.steady = self.turnings.map(|turning| turning.angle());
        }
        if (LIFTED..OVER_SHAFT).contains(&end) {
            self.measure_carried();
        }
    }

    fn measure_carried(&mut self) {
        let held = self.world.bodies[self.hand.palm].position().inverse()
            * *self.world.bodies[self.gears[0]].position();
        let lifted = *self.carried.lifted.get_or_insert(held);
        self.carried.slip = self.carried.slip.max(held.translation.distance(lifted.translation).into());
        self.carried.force += contact_wrench(&self.world, &self.plugin, self.gears[0]).0.y;
        self.carried.steps += 1;
    }

    /// Seconds that have passed.
    fn time(&self) -> f64 {
        self.steps as f64 * f64::from(self.world.integration_parameters.dt)
    }

    /// Turns of the carried gear and of the driving one since the speeds are steady, positive about the upward axis.
    #[must_use]
    pub fn turns(&self) -> [f64; 2] {
        [0, 1].map(|i| (self.turnings[i].angle() - self.steady[i]) / TAU)
    }
}

impl Parts {
    fn new(spheres: usize) -> Result<Self> {
        let [carried, driving] = TEETH.map(|teeth| Part::new("gear", &gear_of(teeth).mesh(), spheres));
        // The hand's frame is that of the gear in its grip.
        let finger = raised(cuboid(FINGER * 0.5), 0.5 * (FINGER.y - WIDTH) + 0.001);
        let palm = Shaft { foot: [0.055, 0.006], journal: [0.018, 0.06], tip: [0.017, 0.001] };
        Ok(Self {
            gears: [carried?, driving?],
            shaft: Part::new("shaft", &SHAFT.mesh(64), spheres)?,
            finger: Part::new("finger", &finger, spheres)?,
            palm: Part::new("palm", &raised(palm.mesh(64), FINGER.y - 0.5 * WIDTH + 0.001), 1)?,
        })
    }
}

/// `mesh`, higher by `height` (m).
fn raised(mut mesh: TriangleMesh, height: f64) -> TriangleMesh {
    mesh.vertices.iter_mut().for_each(|vertex| vertex.y += height);
    mesh
}

fn gear_of(teeth: u32) -> SpurGear {
    let pressure_angle = 20_f64.to_radians();
    SpurGear { module: MODULE, teeth, pressure_angle, backlash: BACKLASH, width: WIDTH, bore: BORE }
}

/// Where the hand is at a time (s). From one place to the next it moves with the least jerk (Flash and Hogan, 1985).
fn place_at(time: f64) -> Vec3 {
    let Some(next) = WAY.iter().position(|(at, _)| *at > time) else { return WAY[WAY.len() - 1].1 };
    let Some(last) = next.checked_sub(1) else { return WAY[0].1 };
    let [(start, from), (end, to)] = [WAY[last], WAY[next]];
    let x = (time - start) / (end - start);
    from.lerp(to, (x * x * x * (10.0 + x * (6.0 * x - 15.0))) as Real)
}

impl Simulation for Assembly {
    fn title(&self) -> String {
        format!("assembly of gears with {} and {} teeth", TEETH[0], TEETH[1])
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
        fn body(handle: RigidBodyHandle, name: impl Into<String>, part: &Part) -> Body<'_> {
            Body::new(handle, name, &part.solid).packing(&part.packing)
        }
        let Parts { gears, shaft, finger, palm } = &self.parts;
        let mut bodies = vec![
            body(self.gears[0], "carried_gear", &gears[0]).color(palette::color(0)),
            body(self.gears[1], "driving_gear", &gears[1]).color(palette::color(1)),
            body(self.shaft, "shaft", shaft),
            body(self.hand.palm, "palm", palm),
        ];
        for (i, &handle) in self.hand.fingers.iter().enumerate() {
            bodies.push(body(handle, format!("finger_{i}"), finger).color(palette::color(2)));
        }
        bodies
    }

    fn checks(&self, _: &Summary) -> Vec<Check> {
        let mut checks = Vec::new();
        if self.carried.steps > 0 {
            let gear = &self.world.bodies[self.gears[0]];
            let weight = f64::from(gear.mass() * self.world.gravity.length());
            let force = self.carried.force / f64::from(self.carried.steps);
            let near = Wanted::Near { value: weight, tolerance: 0.02 };
            checks.push(Check::new("slip in the hand", 1e3 * self.carried.slip, "mm", Wanted::AtMost(0.5)));
            checks.push(Check::new("mean upward force of the fingers on the gear", force, "N", near));
        }
        if self.time() >= STARTS {
            let pose = self.world.bodies[self.gears[0]].position();
            let above = f64::from(pose.translation.y - SEAT.y);
            let tilt = f64::from((pose.rotation * Vec3::Y).angle_between(Vec3::Y));
            checks.push(Check::new(
                "height of the gear over the shoulder",
                1e3 * above.abs(),
                "mm",
                Wanted::AtMost(1e3 * BUMPS),
            ));
            checks.push(Check::new("tilt of the gear", tilt.to_degrees(), "°", Wanted::AtMost(1.0)));
        }
        let [carried, driving] = self.turns();
        if driving > 0.5 {
            let ratio = f64::from(TEETH[1]) / f64::from(TEETH[0]);
            let near = Wanted::Near { value: -ratio, tolerance: 0.01 };
            checks.push(Check::new(
                "turns of the carried gear per turn of the driving one",
                carried / driving,
                "",
                near,
            ));
        }
        checks
    }

    fn view(&self) -> View {
        View { from: Vec3::new(-0.35, 0.6, 1.0), ground: Some(0.0), ..View::default() }
    }

    fn metadata(&self) -> Vec<(&'static str, String)> {
        vec![("example", "assembly".to_owned()), ("teeth", format!("{} {}", TEETH[0], TEETH[1]))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hand_goes_its_way_without_a_jump() {
        for (time, place) in WAY {
            assert!(place_at(time).distance(place) < 1e-6, "{time}");
        }
        let dt = 1e-3;
        let places: Vec<Vec3> = (0..6000).map(|i| place_at(f64::from(i) * dt)).collect();
        // Least jerk has at most 1.875 of the mean speed: half a metre per second on 0.26 m in a second.
        let fastest = places.windows(2).map(|p| p[0].distance(p[1])).fold(0.0, Real::max);
        assert!(fastest < 0.5e-3, "{fastest}");
    }
}
