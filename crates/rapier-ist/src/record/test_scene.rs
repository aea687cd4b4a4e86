//! A small scene to record, for the tests of recordings and replays.

use super::{BodyDescription, RecordError, RecordOptions, RecordStatistics, Recorder};
use crate::{ContactState, PairContact, PatchContact, StepReport};
use ist::{InnerSphere, SolidProperties, SpherePacking};
use rapier3d::prelude::*;
use std::io::{Cursor, Seek, Write};

pub(crate) const TRIANGLE: ([Vector; 3], [[u32; 3]; 1]) = ([Vector::ZERO, Vector::X, Vector::Y], [[0, 1, 2]]);
pub(crate) const STEPS: u32 = 30;

/// Two described balls, one above the other, falling.
pub(crate) struct Fall {
    pub(crate) world: PhysicsWorld,
    pub(crate) bodies: [RigidBodyHandle; 2],
    pub(crate) colliders: [ColliderHandle; 2],
    pub(crate) packing: SpherePacking,
}

impl Fall {
    pub(crate) fn new() -> Self {
        let mut world = PhysicsWorld::new();
        let inserted = [0.0, 1.5].map(|y| {
            let body =
                RigidBodyBuilder::dynamic().translation(Vector::Y * y).angvel(Vector::new(1.0, 2.0, 3.0));
            world.insert(body, ColliderBuilder::ball(1.0).sensor(true))
        });
        let ball = InnerSphere::solid_ball(Vector::new(0.0, 0.25, 0.0), 0.5, Vector::X);
        let packing = SpherePacking::new(vec![ball], SolidProperties::ball(0.5)).unwrap();
        Self { world, bodies: inserted.map(|i| i.0), colliders: inserted.map(|i| i.1), packing }
    }

    pub(crate) fn describe<W: Write + Seek>(&self, recorder: &mut Recorder<W>) -> Result<(), RecordError> {
        for body in self.bodies {
            let (vertices, triangles) = &TRIANGLE;
            let description = BodyDescription::new(body, "ball").mesh(vertices, triangles);
            recorder.add_body(&description.spheres(&self.packing).scale(2.0).color([1.0, 0.5, 0.0, 1.0]))?;
        }
        Ok(())
    }

    /// A report with one contact of two patches between the two.
    pub(crate) fn report(&self) -> StepReport {
        let contact = PairContact {
            collider_a: self.colliders[0],
            collider_b: self.colliders[1],
            state: ContactState::Started,
            volume: 0.25,
            depth: 0.5,
            centroid: Vector::Y,
            force: Vector::Y * 8.0,
            torque: Vector::ZERO,
            relative_velocity: Vector::ZERO,
        };
        let patch = |depth| PatchContact {
            pair: 0,
            volume: 0.125,
            depth,
            centroid: Vector::X,
            normal: Vector::Y,
            force: Vector::Y * 4.0,
            torque: Vector::Z,
            relative_velocity: Vector::NEG_X,
        };
        let patches = vec![patch(0.5), patch(0.25)];
        StepReport { contacts: vec![contact], patches, query_seconds: 0.125, ..StepReport::default() }
    }

    pub(crate) fn run<W: Write + Seek>(
        &mut self,
        recorder: &mut Recorder<W>,
        steps: u32,
    ) -> Result<(), RecordError> {
        for _ in 0..steps {
            self.world.step();
            recorder.record(&self.world, &self.report())?;
        }
        Ok(())
    }
}

/// A whole recording of the fall.
pub(crate) fn recording(options: RecordOptions) -> (Vec<u8>, RecordStatistics) {
    let mut bytes = Vec::new();
    let mut fall = Fall::new();
    let mut recorder = Recorder::new(Cursor::new(&mut bytes), options).unwrap();
    fall.describe(&mut recorder).unwrap();
    recorder.record_start(&fall.world).unwrap();
    fall.run(&mut recorder, STEPS).unwrap();
    let statistics = recorder.finish().unwrap();
    (bytes, statistics)
}
