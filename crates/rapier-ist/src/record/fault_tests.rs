//! Recording where things go wrong, or there is very much of them.

use super::test_scene::{Fall, STEPS, recording};
use super::*;
use crate::StepReport;
use crate::replay::{Replay, ReplayEnd};
use rapier3d::prelude::*;
use std::io::{self, Cursor, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex};

/// A disk with room for so many bytes. Clones are the same disk.
#[derive(Clone)]
struct SmallDisk {
    content: Arc<Mutex<Cursor<Vec<u8>>>>,
    room: u64,
}

impl SmallDisk {
    fn new(room: u64) -> Self {
        Self { content: Arc::default(), room }
    }

    fn bytes(&self) -> Vec<u8> {
        self.content.lock().unwrap().get_ref().clone()
    }
}

impl Write for SmallDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut content = self.content.lock().unwrap();
        let free = (self.room - content.position().min(self.room)) as usize;
        if free == 0 && !bytes.is_empty() {
            return Err(io::Error::new(io::ErrorKind::StorageFull, "no room on the small disk"));
        }
        content.write(&bytes[..free.min(bytes.len())])
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for SmallDisk {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.content.lock().unwrap().seek(to)
    }
}

fn options() -> RecordOptions {
    RecordOptions::everything().chunk_size(2000)
}

/// Records the fall onto `disk` and steps on whatever the recorder says; returns the world and the errors.
fn record_onto(disk: &SmallDisk, options: RecordOptions) -> (PhysicsWorld, Vec<RecordError>) {
    let mut fall = Fall::new();
    let mut errors = Vec::new();
    let mut recorder = match Recorder::new_send(disk.clone(), options) {
        Ok(recorder) => Some(recorder),
        Err(error) => {
            errors.push(error);
            None
        }
    };
    if let Some(recorder) = &mut recorder {
        errors.extend(fall.describe(recorder).err());
        errors.extend(recorder.record_start(&fall.world).err());
    }
    for _ in 0..STEPS {
        fall.world.step();
        if let Some(recorder) = &mut recorder {
            errors.extend(recorder.record(&fall.world, &fall.report()).err());
        }
    }
    errors.extend(recorder.and_then(|recorder| recorder.finish().err()));
    (fall.world, errors)
}

fn poses(world: &PhysicsWorld) -> Vec<Pose> {
    world.bodies.iter().map(|(_, body)| *body.position()).collect()
}

#[test]
fn a_disk_that_fills_up_at_any_byte_is_named_and_disturbs_nothing() {
    let (undisturbed, errors) = record_onto(&SmallDisk::new(u64::MAX), options());
    assert!(errors.is_empty());
    let whole = SmallDisk::new(u64::MAX);
    record_onto(&whole, options());
    let whole = whole.bytes();
    let all = Replay::from_bytes(&whole).unwrap();
    assert_eq!(all.end(), &ReplayEnd::Complete);
    for background in [false, true] {
        let mut last = 0;
        for room in (0..whole.len() as u64).step_by(53) {
            let disk = SmallDisk::new(room);
            let (world, errors) = record_onto(&disk, options().background(background));
            assert_eq!(poses(&world), poses(&undisturbed));
            assert!(!errors.is_empty(), "{room} bytes are not enough");
            for error in &errors {
                let text = error.to_string();
                assert!(text.contains("the given writer") && text.contains("small disk"), "{text}");
            }
            let written = disk.bytes();
            assert!(whole.starts_with(&written), "what is there is the beginning of the recording");
            let replay = Replay::from_bytes(&written).unwrap();
            assert!(last <= replay.step_count() && replay.step_count() <= all.step_count());
            last = replay.step_count();
        }
        assert!(last > 0);
    }
}

#[test]
fn a_thread_of_its_own_writes_the_same_bytes() {
    for compression in [ChunkCompression::None, ChunkCompression::Lz4, ChunkCompression::Zstd] {
        let record = |background| {
            let disk = SmallDisk::new(u64::MAX);
            let (_, errors) = record_onto(&disk, options().compression(compression).background(background));
            assert!(errors.is_empty());
            disk.bytes()
        };
        assert_eq!(record(false), record(true), "{compression:?}");
    }
}

#[test]
fn a_dropped_background_recorder_leaves_a_complete_file() {
    let disk = SmallDisk::new(u64::MAX);
    let mut fall = Fall::new();
    let mut recorder = Recorder::new_send(disk.clone(), options().background(true)).unwrap();
    fall.describe(&mut recorder).unwrap();
    fall.run(&mut recorder, 5).unwrap();
    drop(recorder);
    let replay = Replay::from_bytes(&disk.bytes()).unwrap();
    assert_eq!((replay.step_count(), replay.end()), (5, &ReplayEnd::Complete));
}

#[test]
fn what_was_recorded_at_the_start_is_there_at_once() {
    let disk = SmallDisk::new(u64::MAX);
    let fall = Fall::new();
    let mut recorder = Recorder::new_send(disk.clone(), RecordOptions::everything()).unwrap();
    fall.describe(&mut recorder).unwrap();
    recorder.record_start(&fall.world).unwrap();
    let replay = Replay::from_bytes(&disk.bytes()).unwrap();
    assert_eq!((replay.bodies().len(), replay.step_count()), (2, 1));
    assert!(replay.bodies().iter().all(|body| body.mesh.is_some() && body.packing.is_some()));
}

#[test]
fn ten_thousand_bodies_of_one_odd_name() {
    const COUNT: usize = 10_000;
    let fall = Fall::new();
    let mut world = PhysicsWorld::new();
    for index in 0..COUNT {
        let body = RigidBodyBuilder::dynamic().translation(Vector::X * index as f32).additional_mass(1.0);
        world.insert_body(body);
    }
    let mut bytes = Cursor::new(Vec::new());
    let mut recorder = Recorder::new(&mut bytes, RecordOptions::everything()).unwrap();
    let described = recorder
        .add_bodies(&world, |handle, _| Some(BodyDescription::new(handle, "Ж/\n\"").spheres(&fall.packing)));
    assert_eq!(described.unwrap(), COUNT);
    assert_eq!(recorder.add_bodies(&world, |_, _| unreachable!()).unwrap(), 0, "all are known");
    for _ in 0..3 {
        world.step();
        recorder.record(&world, &StepReport::default()).unwrap();
    }
    recorder.finish().unwrap();
    let replay = Replay::from_bytes(bytes.get_ref()).unwrap();
    assert_eq!((replay.bodies().len(), replay.step_count()), (COUNT, 3));
    assert_eq!(replay.body_index("____"), Some(0));
    let last = replay.body_index(&format!("_____{COUNT}")).unwrap();
    let expected = world.bodies.iter().last().unwrap().1.translation();
    assert_eq!(replay.step(2).unwrap().pose(last).unwrap().translation, expected);
    assert!(replay.defects().is_empty());
}

#[test]
fn bodies_are_described_by_a_callback_and_may_be_left_out() {
    let mut fall = Fall::new();
    let mut bytes = Cursor::new(Vec::new());
    let mut recorder = Recorder::new(&mut bytes, RecordOptions::poses()).unwrap();
    let [_, upper] = fall.bodies;
    let described = recorder.add_bodies(&fall.world, |handle, body| {
        (handle == upper).then(|| BodyDescription::new(handle, format!("at {} m", body.translation().y)))
    });
    assert_eq!(described.unwrap(), 1);
    fall.run(&mut recorder, 2).unwrap();
    fall.world.insert_body(RigidBodyBuilder::fixed());
    let described = recorder.add_bodies(&fall.world, |handle, _| Some(BodyDescription::new(handle, "late")));
    assert_eq!(described.unwrap(), 2);
    fall.run(&mut recorder, 1).unwrap();
    recorder.finish().unwrap();
    let replay = Replay::from_bytes(bytes.get_ref()).unwrap();
    let names: Vec<_> = replay.bodies().iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["at_1.5_m", "late", "late_2"]);
    let counts: Vec<_> = replay.steps().map(|step| step.poses().len()).collect();
    assert_eq!(counts, [1, 1, 3]);
}

#[test]
fn a_chunk_size_of_any_value_is_borne() {
    for size in [0, 1, u64::MAX] {
        let (bytes, _) = recording(RecordOptions::poses().chunk_size(size));
        assert_eq!(Replay::from_bytes(&bytes).unwrap().step_count(), STEPS as usize + 1);
    }
}
