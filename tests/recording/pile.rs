//! The recording of a pile, read back with the format's own reader, with [`Replay`], and as a running run leaves it.

use foxglove::Decode;
use foxglove::messages::{FrameTransforms, SceneUpdate};
use rapier_ist::record::{RecordOptions, Recorder};
use rapier_ist::replay::{Replay, ReplayEnd};
use rapier_ist_examples::recording::describe;
use rapier_ist_tests::small_pile;
use std::collections::BTreeMap;
use std::io::Cursor;

/// Records `steps` steps of a small pile.
fn record(steps: usize) -> Vec<u8> {
    let mut pile = small_pile().unwrap();
    let mut file = Cursor::new(Vec::new());
    let mut recorder = Recorder::new(&mut file, RecordOptions::everything()).unwrap();
    describe(&mut recorder, &pile).unwrap();
    for _ in 0..steps {
        pile.step();
        recorder.record(&pile.world, pile.plugin.report()).unwrap();
    }
    recorder.finish().unwrap();
    file.into_inner()
}

#[test]
fn holds_every_pose_and_every_mesh() {
    let bytes = record(60);
    let mut messages: BTreeMap<String, usize> = BTreeMap::new();
    let mut last = 0;
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        assert_eq!(message.channel.message_encoding, "protobuf");
        assert!(message.log_time >= last, "log times never decrease");
        last = message.log_time;
        *messages.entry(message.channel.topic.clone()).or_default() += 1;
        match message.channel.topic.as_str() {
            "/tf" => {
                let frames = FrameTransforms::decode(message.data.as_ref()).unwrap();
                let bodies = frames.transforms.iter().filter(|t| t.parent_frame_id == "world");
                assert_eq!(bodies.count(), 7, "the bowl and six bodies");
            }
            "/scene" => {
                let scene = SceneUpdate::decode(message.data.as_ref()).unwrap();
                assert_eq!(scene.entities.len(), 7);
            }
            _ => {}
        }
    }
    assert!(messages["/tf"] >= 60);
    assert!(messages.contains_key("/contacts") && messages.contains_key("/scene/contacts"));
    assert!(last.abs_diff(1_000_000_000) < 1000, "60 steps of 1/60 s end at {last} ns");
}

#[test]
fn equal_runs_give_equal_files() {
    assert!(record(40) == record(40));
}

#[test]
fn replays_every_pose_mesh_packing_and_contact() {
    let replay = Replay::from_bytes(&record(60)).unwrap();
    assert_eq!((replay.end(), replay.step_count()), (&ReplayEnd::Complete, 60));
    assert!(replay.defects().is_empty());
    let mut pile = small_pile().unwrap();
    let mut contacts = 0;
    for step in replay.steps() {
        let report = pile.step().clone();
        for (index, body) in pile.bodies.iter().enumerate() {
            let place = replay.body_index(&format!("{}_{index}", pile.models[body.model].name)).unwrap();
            let pose = step.pose(place).unwrap();
            let expected = pile.world.bodies[body.handle].position();
            assert_eq!(pose.translation, expected.translation);
            assert!((pose.rotation * glam::Vec3::X).distance(expected.rotation * glam::Vec3::X) < 1e-6);
        }
        assert_eq!(step.contacts().len(), report.contacts.len());
        for (index, (contact, expected)) in step.contacts().iter().zip(&report.contacts).enumerate() {
            assert_eq!((contact.volume, contact.force), (expected.volume, expected.force));
            let forces: Vec<_> = contact.patches.iter().map(|patch| patch.force).collect();
            let patches: Vec<_> = report.patches_of(index).iter().map(|patch| patch.force).collect();
            assert_eq!(forces, patches);
        }
        contacts += report.contacts.len();
    }
    assert!(contacts > 0, "something touched something");
    for (index, body) in pile.bodies.iter().enumerate() {
        let model = &pile.models[body.model];
        let place = replay.body_index(&format!("{}_{index}", model.name)).unwrap();
        let recorded = &replay.bodies()[place];
        let mesh = recorded.mesh.as_ref().unwrap();
        assert_eq!(mesh.triangles, model.solid.mesh().triangles);
        let packing = recorded.packing.as_ref().unwrap();
        assert_eq!((packing.packing.as_ref(), packing.scale), (&model.packing, body.size));
    }
    assert!(replay.bodies()[replay.body_index("bowl").unwrap()].mesh.is_some());
}
