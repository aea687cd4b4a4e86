//! Recordings are read back with the mcap crate's own reader and decoded from their bytes.

use super::messages::{Contacts, Metrics};
use super::test_scene::{Fall, STEPS, TRIANGLE, recording};
use super::*;
use foxglove::messages::{FrameTransforms, Log, PointCloud, SceneUpdate};
use prost::Message;
use rapier3d::prelude::*;
use std::io::Cursor;

/// Log times and messages of `topic`, decoded.
fn read<M: Message + Default>(bytes: &[u8], topic: &str) -> Vec<(u64, M)> {
    let messages = mcap::MessageStream::new(bytes).unwrap().map_while(Result::ok);
    let of_topic = messages.filter(|message| message.channel.topic == topic);
    of_topic.map(|message| (message.log_time, M::decode(message.data.as_ref()).unwrap())).collect()
}

#[test]
fn every_topic_reads_back() {
    let (bytes, statistics) = recording(RecordOptions::everything());
    assert_eq!(statistics.bytes, bytes.len() as u64);
    assert_eq!(statistics.steps, u64::from(STEPS));

    let poses = read::<FrameTransforms>(&bytes, "/tf");
    assert_eq!(poses.len(), STEPS as usize + 1);
    let dt = u64::from(16_666_668_u32);
    for (step, (time, message)) in (0..).zip(&poses) {
        assert_eq!(*time, step * dt);
        let frames: Vec<_> = message.transforms.iter().map(|t| t.child_frame_id.as_str()).collect();
        assert_eq!(frames, ["world", "ball", "ball_2"]);
    }
    let height = poses[STEPS as usize].1.transforms[2].translation.unwrap().y;
    assert!(height < 1.0, "it fell: {height}");

    let scene = read::<SceneUpdate>(&bytes, "/scene");
    assert_eq!(scene.len(), 1);
    let entity = &scene[0].1.entities[1];
    assert!(entity.frame_locked && entity.frame_id == "ball_2");
    assert_eq!(entity.triangles[0].points[1].x, 2.0, "scaled");

    let (_, cloud) = &read::<PointCloud>(&bytes, "/ball/spheres")[0];
    let numbers: Vec<f32> = cloud.data.chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(numbers, [0.0, 0.5, 0.0, 1.0]);

    let (_, contacts) = &read::<Contacts>(&bytes, "/contacts")[0];
    assert_eq!((contacts.contacts[0].body_a.as_str(), contacts.contacts[0].volume), ("ball", 0.25));
    let (_, metrics) = &read::<Metrics>(&bytes, "/metrics")[0];
    assert_eq!((metrics.step, metrics.deepest_overlap, metrics.contact_count), (1, 0.5, 1));
    assert!(metrics.kinetic_energy > 0.0 && metrics.timings.is_none());

    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    assert_eq!(summary.stats.unwrap().message_count, statistics.messages);
    assert_eq!(summary.attachment_indexes.len(), 1, "equal packings are attached once");
}

/// A body could have the name that a collider without a description got.
#[test]
fn issue_undescribed_colliders_have_names_of_their_own() {
    let index = Fall::new().colliders[0].into_raw_parts().0;
    for name in [format!("collider_{index}"), format!("collider:{index}")] {
        let mut fall = Fall::new();
        let mut bytes = Cursor::new(Vec::new());
        let mut recorder = Recorder::new(&mut bytes, RecordOptions::contacts()).unwrap();
        recorder.add_body(&BodyDescription::new(fall.bodies[1], &name)).unwrap();
        fall.run(&mut recorder, 1).unwrap();
        recorder.finish().unwrap();
        let (_, contacts) = &read::<Contacts>(bytes.get_ref(), "/contacts")[0];
        let contact = &contacts.contacts[0];
        assert_ne!(contact.body_a, contact.body_b);
    }
}

#[test]
fn arrows_point_along_the_force_and_keep_one_name() {
    let (bytes, _) = recording(RecordOptions::contacts().arrow_length_per_newton(0.5));
    let updates = read::<SceneUpdate>(&bytes, "/scene/contacts");
    assert_eq!(updates.len(), STEPS as usize);
    assert!(updates.iter().all(|(_, update)| update.entities[0].id == updates[0].1.entities[0].id));
    let arrow = &updates[0].1.entities[0].arrows[0];
    assert!((arrow.shaft_length + arrow.head_length - 4.0).abs() < 1e-9, "8 N at 0.5 m/N");
    let q = arrow.pose.unwrap().orientation.unwrap();
    let tip = Rotation::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32) * Vector::X;
    assert!(tip.distance(Vector::Y) < 1e-6, "{tip}");
}

#[test]
fn issue_what_cannot_fall_does_not_scale_the_arrows() {
    let arrow = |fixed: bool| {
        let mut bytes = Vec::new();
        let mut fall = Fall::new();
        if fixed {
            fall.world
                .insert(RigidBodyBuilder::fixed(), ColliderBuilder::cuboid(50.0, 1.0, 50.0).sensor(true));
        }
        let mut recorder = Recorder::new(Cursor::new(&mut bytes), RecordOptions::contacts()).unwrap();
        fall.describe(&mut recorder).unwrap();
        recorder.record_start(&fall.world).unwrap();
        fall.run(&mut recorder, 1).unwrap();
        recorder.finish().unwrap();
        let (_, update) = &read::<SceneUpdate>(&bytes, "/scene/contacts")[0];
        update.entities[0].arrows[0].shaft_length
    };
    assert_eq!(arrow(false), arrow(true));
}

#[test]
fn equal_runs_give_equal_bytes() {
    for compression in [ChunkCompression::None, ChunkCompression::Lz4, ChunkCompression::Zstd] {
        let options =
            || RecordOptions::everything().chunk_size(4096).compression(compression).metadata("seed", 7);
        assert_eq!(recording(options()).0, recording(options()).0, "{compression:?}");
    }
}

#[test]
fn wall_times_are_written_when_asked_for() {
    let (bytes, _) = recording(RecordOptions::contacts().timings(true));
    let (_, metrics) = &read::<Metrics>(&bytes, "/metrics")[0];
    assert_eq!(metrics.timings.as_ref().unwrap().query_ms, 125.0);
}

#[test]
fn every_third_step() {
    let (bytes, statistics) = recording(RecordOptions::poses().every(3));
    let poses = read::<FrameTransforms>(&bytes, "/tf");
    assert_eq!(poses.len(), 1 + STEPS as usize / 3);
    assert_eq!(statistics.steps, u64::from(STEPS));
    assert!(read::<Contacts>(&bytes, "/contacts").is_empty());
}

#[test]
fn a_truncated_file_reads_up_to_the_cut() {
    let (bytes, _) = recording(RecordOptions::poses().chunk_size(1024));
    let all = read::<FrameTransforms>(&bytes, "/tf").len();
    let mut last = 0;
    for length in (0..bytes.len()).step_by(97).filter(|&length| length > 64) {
        let readable = read::<FrameTransforms>(&bytes[..length], "/tf").len();
        assert!(last <= readable && readable <= all);
        last = readable;
    }
    assert!(last > all / 2, "{last} of {all}");
}

#[test]
fn a_dropped_recorder_leaves_a_complete_file() {
    let mut bytes = Vec::new();
    let mut fall = Fall::new();
    let mut recorder = Recorder::new(Cursor::new(&mut bytes), RecordOptions::poses()).unwrap();
    fall.describe(&mut recorder).unwrap();
    fall.run(&mut recorder, 5).unwrap();
    drop(recorder);
    assert_eq!(read::<FrameTransforms>(&bytes, "/tf").len(), 5);
    assert!(mcap::Summary::read(&bytes).unwrap().unwrap().stats.is_some());
}

#[test]
fn a_pose_that_is_not_a_number_keeps_its_last_value() {
    let mut bytes = Vec::new();
    let mut fall = Fall::new();
    let mut recorder = Recorder::new(Cursor::new(&mut bytes), RecordOptions::contacts()).unwrap();
    fall.describe(&mut recorder).unwrap();
    fall.run(&mut recorder, 3).unwrap();
    let mut report = fall.report();
    report.contacts[0].force = Vector::NAN;
    fall.world.bodies.get_mut(fall.bodies[1]).unwrap().set_translation(Vector::NAN, true);
    for _ in 0..3 {
        recorder.record(&fall.world, &report).unwrap();
    }
    let statistics = recorder.finish().unwrap();
    assert_eq!((statistics.poses_refused, statistics.contacts_refused), (1, 3));

    let poses = read::<FrameTransforms>(&bytes, "/tf");
    let translation = |step: usize| poses[step].1.transforms[2].translation.unwrap();
    assert!(translation(2).y.is_finite());
    assert_eq!(translation(5), translation(2));
    assert!(read::<Metrics>(&bytes, "/metrics").iter().all(|(_, m)| m.potential_energy.is_finite()));
    let log = read::<Log>(&bytes, "/log");
    assert_eq!(log.iter().filter(|(_, line)| line.message.contains("ball_2 is not finite")).count(), 1);
}

/// It stood at the origin.
#[test]
fn issue_a_body_has_no_pose_before_its_first_finite_one() {
    let mut bytes = Vec::new();
    let mut fall = Fall::new();
    let [first, second] = fall.bodies;
    let mut recorder = Recorder::new(Cursor::new(&mut bytes), RecordOptions::poses()).unwrap();
    fall.describe(&mut recorder).unwrap();
    fall.world.bodies[first].set_translation(Vector::NAN, true);
    for step in 0..4 {
        if step == 2 {
            fall.world.bodies[first].set_translation(Vector::X, true);
        }
        recorder.record(&fall.world, &fall.report()).unwrap();
    }
    fall.world.remove_body(second);
    recorder.record(&fall.world, &fall.report()).unwrap();
    recorder.finish().unwrap();
    let frames: Vec<Vec<_>> = read::<FrameTransforms>(&bytes, "/tf")
        .into_iter()
        .map(|(_, message)| {
            message.transforms.into_iter().map(|t| (t.child_frame_id, t.translation.unwrap().x)).collect()
        })
        .collect();
    let [world, ball, ball_2] = ["world", "ball", "ball_2"].map(str::to_owned);
    let without = vec![(world.clone(), 0.0), (ball_2.clone(), 0.0)];
    let with = vec![(world.clone(), 0.0), (ball.clone(), 1.0), (ball_2, 0.0)];
    let alone = vec![(world, 0.0), (ball, 1.0)];
    assert_eq!(frames, [without.clone(), without, with.clone(), with, alone]);
}

#[test]
fn a_removed_body_leaves_the_scene() {
    let mut bytes = Vec::new();
    let mut fall = Fall::new();
    let mut recorder = Recorder::new(Cursor::new(&mut bytes), RecordOptions::poses()).unwrap();
    fall.describe(&mut recorder).unwrap();
    fall.run(&mut recorder, 2).unwrap();
    fall.world.remove_body(fall.bodies[0]);
    fall.run(&mut recorder, 2).unwrap();
    recorder.finish().unwrap();
    let scene = read::<SceneUpdate>(&bytes, "/scene");
    let names: Vec<Vec<_>> =
        scene.iter().map(|(_, s)| s.entities.iter().map(|e| e.id.as_str()).collect()).collect();
    assert_eq!(names, [vec!["ball", "ball_2"], vec!["ball_2"]]);
    assert_eq!(read::<FrameTransforms>(&bytes, "/tf")[3].1.transforms.len(), 2);
}

#[test]
fn broken_descriptions_are_refused_by_name() {
    let fall = Fall::new();
    let mut recorder = Recorder::new(Cursor::new(Vec::new()), RecordOptions::poses()).unwrap();
    let [body, _] = fall.bodies;
    let nan = [Vector::NAN; 3];
    let broken = [
        BodyDescription::new(body, "cup").mesh(&nan, &[[0, 1, 2]]),
        BodyDescription::new(body, "cup").mesh(&TRIANGLE.0, &[[0, 1, 3]]),
        BodyDescription::new(body, "cup").scale(f32::NAN),
        BodyDescription::new(body, "cup").color([2.0, 0.0, 0.0, 1.0]),
    ];
    for description in &broken {
        assert!(recorder.add_body(description).unwrap_err().to_string().contains("`cup`"));
    }
    recorder.add_body(&BodyDescription::new(body, "cup")).unwrap();
    assert!(recorder.add_body(&BodyDescription::new(body, "again")).is_err());
}

#[test]
fn an_unwritable_path_is_named() {
    let error = Recorder::create("/nowhere/at/all.mcap", RecordOptions::poses()).err().unwrap();
    assert!(error.to_string().contains("/nowhere/at/all.mcap"), "{error}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_an_error_at_every_later_step() {
    let mut fall = Fall::new();
    let options = RecordOptions::contacts().chunk_size(1024);
    let mut recorder = match Recorder::create("/dev/full", options) {
        Ok(recorder) => recorder,
        Err(error) => return assert!(error.to_string().contains("/dev/full")),
    };
    let described = fall.describe(&mut recorder);
    let error = described.and_then(|()| fall.run(&mut recorder, 1000)).unwrap_err();
    assert!(error.to_string().contains("/dev/full"), "{error}");
    assert!(fall.run(&mut recorder, 1).is_err());
    assert!(recorder.finish().is_err());
}
