//! Recordings of a small scene, read back whole, cut off and damaged.

use super::*;
use crate::record::test_scene::{Fall, STEPS, TRIANGLE, recording};
use crate::record::{ChunkCompression, RecordOptions, Recorder, UpAxis};
use mcap::records::op;
use rapier3d::prelude::*;
use std::io::Cursor;

fn options() -> RecordOptions {
    RecordOptions::everything().chunk_size(2000).metadata("seed", 7)
}

/// Compressions, and every how many bytes they are tried: all of them for the one that is the default.
const COMPRESSIONS: [(ChunkCompression, usize); 3] =
    [(ChunkCompression::None, 7), (ChunkCompression::Lz4, 7), (ChunkCompression::Zstd, 1)];

#[test]
fn all_that_was_recorded_is_there() {
    for (compression, _) in COMPRESSIONS {
        let (bytes, statistics) = recording(options().compression(compression).timings(true));
        let replay = Replay::from_bytes(&bytes).unwrap();
        assert_eq!((replay.end(), replay.defects().len()), (&ReplayEnd::Complete, 0));
        assert_eq!(replay.step_count() as u64, statistics.steps + 1);
        assert_eq!(replay.up(), UpAxis::Y);
        assert_eq!(replay.parameter("seed"), Some("7"));
        assert_eq!(replay.metadata()["simulation"]["gravity"], "-0 -9.81 -0");
        let lines: Vec<_> = replay.log().iter().map(|line| line.message.as_str()).collect();
        assert_eq!(lines, ["start with 2 bodies", "end after 30 steps"]);

        let [first, second] = replay.bodies() else { panic!("{} bodies", replay.bodies().len()) };
        assert_eq!([&first.name, &second.name], ["ball", "ball_2"]);
        let mesh = second.mesh.as_ref().unwrap();
        assert_eq!(mesh.vertices, TRIANGLE.0.map(|vertex| 2.0 * vertex));
        assert_eq!((mesh.triangles.as_slice(), mesh.color), (&TRIANGLE.1[..], [1.0, 0.5, 0.0, 1.0]));
        assert_eq!(second.spheres, [(Vector::Y * 0.5, 1.0)]);
        let packing = second.packing.as_ref().unwrap();
        assert_eq!((packing.packing.as_ref(), packing.scale), (&Fall::new().packing, 2.0));

        let step = replay.step(3).unwrap();
        let [contact] = step.contacts() else { panic!("{} contacts", step.contacts().len()) };
        let report = Fall::new().report();
        assert_eq!(contact.bodies, [Some(0), Some(1)]);
        assert_eq!((contact.volume, contact.depth), (report.contacts[0].volume, report.contacts[0].depth));
        assert_eq!(
            (contact.centroid, contact.force),
            (report.contacts[0].centroid, report.contacts[0].force)
        );
        assert_eq!(contact.patches.len(), 2);
        for (patch, expected) in contact.patches.iter().zip(&report.patches) {
            assert_eq!((patch.volume, patch.depth), (expected.volume, expected.depth));
            assert_eq!((patch.centroid, patch.force), (expected.centroid, expected.force));
            assert_eq!(
                (patch.torque, patch.relative_velocity),
                (expected.torque, expected.relative_velocity)
            );
        }
        let metrics = step.metrics().unwrap();
        assert_eq!((metrics.step, metrics.contact_count, metrics.deepest_overlap), (3, 1, 0.5));
        assert_eq!(metrics.timings.unwrap().query_seconds, 0.125);
        assert!(replay.step(0).unwrap().metrics().is_none());
    }
}

#[test]
fn poses_are_those_of_the_world() {
    let (bytes, _) = recording(options());
    let replay = Replay::from_bytes(&bytes).unwrap();
    let mut fall = Fall::new();
    for step in replay.steps() {
        for (body, handle) in fall.bodies.iter().enumerate() {
            let expected = *fall.world.bodies[*handle].position();
            let pose = step.pose(body).unwrap();
            assert_eq!(pose.translation, expected.translation);
            assert!(pose.rotation.angle_between(expected.rotation) < 1e-3);
            assert!((pose.rotation * Vector::X).distance(expected.rotation * Vector::X) < 1e-6);
            assert_eq!(replay.pose_at(body, step.time()), Some(pose));
            assert_eq!(replay.step_at(step.time()).unwrap().index(), step.index());
        }
        fall.world.step();
    }
}

#[test]
fn between_steps_poses_are_between() {
    let (bytes, _) = recording(options());
    let replay = Replay::from_bytes(&bytes).unwrap();
    let (a, b) = (replay.step(10).unwrap(), replay.step(11).unwrap());
    let middle = replay.pose_at(1, 0.5 * (a.time() + b.time())).unwrap();
    let (from, to) = (a.pose(1).unwrap(), b.pose(1).unwrap());
    assert!(middle.translation.distance(0.5 * (from.translation + to.translation)) < 1e-6);
    // Half a turn twice is the whole turn.
    let half = from.rotation.inverse() * middle.rotation;
    let whole = from.rotation.inverse() * to.rotation;
    assert!((half * half * Vector::X).distance(whole * Vector::X) < 1e-5);

    let last = replay.step(STEPS as usize).unwrap();
    assert_eq!(replay.duration(), last.time());
    assert_eq!(replay.pose_at(1, -1.0), replay.step(0).unwrap().pose(1));
    assert_eq!(replay.pose_at(1, f64::INFINITY), last.pose(1));
    assert_eq!(replay.pose_at(1, f64::NAN), None);
    assert_eq!(replay.pose_at(2, 0.0), None, "there are two bodies");
    assert_eq!(replay.step_at(last.time() + 1.0).unwrap().index(), STEPS as usize);
    assert_eq!(replay.step_at(-1.0).unwrap().index(), 0);
    assert_eq!(replay.step_at(0.5 * (a.time() + b.time())).unwrap().index(), 10);
    assert!(replay.step_at(f64::NAN).is_none());
}

#[test]
fn a_removed_body_has_no_pose_from_then_on() {
    let mut bytes = Cursor::new(Vec::new());
    let mut fall = Fall::new();
    let mut recorder = Recorder::new(&mut bytes, options().up(UpAxis::Z)).unwrap();
    fall.describe(&mut recorder).unwrap();
    fall.run(&mut recorder, 2).unwrap();
    fall.world.remove_body(fall.bodies[0]);
    fall.run(&mut recorder, 2).unwrap();
    recorder.finish().unwrap();
    let replay = Replay::from_bytes(bytes.get_ref()).unwrap();
    assert_eq!(replay.up(), UpAxis::Z);
    let there: Vec<Vec<usize>> =
        replay.steps().map(|step| step.poses().map(|(body, _)| body).collect()).collect();
    assert_eq!(there, [vec![0, 1], vec![0, 1], vec![1], vec![1]]);
    let [second, third] = [1, 2].map(|index| replay.step(index).unwrap().time());
    let before = replay.step(1).unwrap().pose(0);
    assert_eq!(replay.pose_at(0, 0.5 * (second + third)), before, "it stays until the next step");
    assert_eq!(replay.pose_at(0, third), None);
    assert!(replay.bodies()[0].mesh.is_some(), "it can still be drawn at earlier times");
}

/// Whether `part` replays the first steps of `whole`, and nothing else.
fn is_beginning(part: &Replay, whole: &Replay) -> bool {
    part.step_count() <= whole.step_count()
        && part.steps().zip(whole.steps()).all(|(a, b)| {
            let contacts = a.contacts().is_empty() || a.contacts() == b.contacts();
            a.nanoseconds() == b.nanoseconds() && a.poses().eq(b.poses()) && contacts
        })
}

#[test]
fn cut_off_at_any_byte_it_replays_up_to_there() {
    for (compression, stride) in COMPRESSIONS {
        let (bytes, _) = recording(options().compression(compression));
        let whole = Replay::from_bytes(&bytes).unwrap();
        let mut steps = 0;
        for length in (0..bytes.len()).step_by(stride) {
            let replay = Replay::from_bytes(&bytes[..length]).unwrap();
            let &ReplayEnd::Truncated { at } = replay.end() else { panic!("{length}: {}", replay.end()) };
            assert!(at <= length as u64);
            assert!(is_beginning(&replay, &whole), "{length}");
            assert!(replay.step_count() >= steps, "a longer part replays no less");
            // A chunk of 2000 bytes has less than four steps of this scene.
            assert!(replay.step_count() - steps <= 4);
            steps = replay.step_count();
        }
        assert_eq!(steps, whole.step_count());
    }
}

#[test]
fn a_flipped_bit_is_noticed_and_nothing_wrong_is_replayed() {
    for (compression, stride) in COMPRESSIONS {
        let (bytes, _) = recording(options().compression(compression));
        let whole = Replay::from_bytes(&bytes).unwrap();
        // What comes after the data, such as the summary, is not read.
        let data_end = bytes.len() - bytes_after_data(&bytes);
        for position in (mcap::MAGIC.len()..bytes.len()).step_by(stride) {
            let mut damaged = bytes.clone();
            damaged[position] ^= 1 << (position % 8);
            let replay = Replay::from_bytes(&damaged).unwrap();
            assert!(is_beginning(&replay, &whole), "{position}: {}", replay.end());
            if position < data_end {
                assert_ne!(replay.end(), &ReplayEnd::Complete, "{position}");
            }
        }
    }
}

/// More than one bit may be wrong: a chunk whose kind had become that of a header was passed over, and what followed was
/// replayed as if nothing were missing.
#[test]
fn issue_a_chunk_taken_for_a_header_is_missing() {
    let (bytes, _) = recording(options().compression(ChunkCompression::None));
    let whole = Replay::from_bytes(&bytes).unwrap();
    let mut position = mcap::MAGIC.len();
    let mut chunks = 0;
    while bytes[position] != op::DATA_END {
        let length = u64::from_le_bytes(bytes[position + 1..position + 9].try_into().unwrap());
        if bytes[position] == op::CHUNK {
            chunks += 1;
            let mut damaged = bytes.clone();
            damaged[position] = op::HEADER;
            let replay = Replay::from_bytes(&damaged).unwrap();
            assert!(is_beginning(&replay, &whole), "{position}: {}", replay.end());
            assert!(matches!(replay.end(), ReplayEnd::Damaged { at, .. } if *at == position as u64));
        }
        position += 9 + length as usize;
    }
    assert!(chunks > 3);
}

/// The parser of attachments panicked.
#[test]
fn issue_names_of_an_attachment_reach_into_its_checksum() {
    let string = [4_u32.to_le_bytes(), *b"name"].concat();
    let times_and_names = [vec![0; 16], string.clone(), string].concat();
    // Of the eight bytes that tell how much data there is the last four are the checksum.
    for data_length in 0..9 {
        let mut body = times_and_names.clone();
        body.resize(body.len() + data_length, 0);
        body.extend(crc32fast::hash(&body).to_le_bytes());
        let record = [&[op::ATTACHMENT][..], &(body.len() as u64).to_le_bytes(), &body].concat();
        let replay = Replay::from_bytes(&[mcap::MAGIC, &record].concat()).unwrap();
        match replay.end() {
            ReplayEnd::Damaged { at, what } => {
                assert_eq!(*at, mcap::MAGIC.len() as u64);
                assert!(what.contains("attachment") && data_length != 8, "{data_length}: {what}");
            }
            // Eight zeros and the checksum are an attachment without data.
            end => {
                let at = (mcap::MAGIC.len() + record.len()) as u64;
                assert_eq!((end, data_length), (&ReplayEnd::Truncated { at }, 8));
            }
        }
    }
}

/// Bytes from the data end record's body on: the footer, in front of the last magic bytes, says where the summary begins.
fn bytes_after_data(bytes: &[u8]) -> usize {
    let footer = &bytes[bytes.len() - mcap::MAGIC.len() - 20..];
    bytes.len() - u64::from_le_bytes(footer[..8].try_into().unwrap()) as usize + 4
}

#[test]
fn other_data_is_refused_by_name() {
    let error = Replay::from_bytes(b"solid ascii stl").unwrap_err().to_string();
    assert!(error.contains("the given data") && error.contains("MCAP"), "{error}");
    let error = Replay::open("/nowhere/at/all.mcap").unwrap_err().to_string();
    assert!(error.contains("/nowhere/at/all.mcap") && error.contains("name a file"), "{error}");
    let empty = Replay::from_bytes(&[]).unwrap();
    assert_eq!((empty.step_count(), empty.duration()), (0, 0.0));
    assert!(empty.step_at(0.0).is_none() && empty.pose_at(0, 0.0).is_none());
}

#[test]
fn foreign_messages_are_told_and_left_out() {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut bytes).unwrap();
    let channel = |writer: &mut mcap::Writer<_>, topic| {
        writer.add_channel(0, topic, "json", &std::collections::BTreeMap::new()).unwrap()
    };
    for topic in ["/tf", "/scene", "/contacts", "/metrics", "/log", "/a/spheres", "/camera"] {
        let channel_id = channel(&mut writer, topic);
        let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 5, publish_time: 5 };
        writer.write_to_known_channel(&header, b"{\"json\": [1, 2, 3]}").unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let replay = Replay::from_bytes(bytes.get_ref()).unwrap();
    assert_eq!(replay.end(), &ReplayEnd::Complete);
    assert_eq!(replay.defects().len(), 6, "{:?}", replay.defects());
    assert!(replay.defects()[0].contains("/tf at 5 ns"));
    assert_eq!((replay.step_count(), replay.bodies().len()), (0, 0));
}
