//! The recording of a pile, read back.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use foxglove::Decode;
use foxglove::messages::{FrameTransforms, SceneUpdate};
use rapier_ist::record::{BodyDescription, RecordOptions, Recorder};
use rapier_ist_examples::scenes::{Pile, PileOptions, single_precision};
use std::collections::BTreeMap;
use std::io::Cursor;

/// Records `steps` steps of a small pile.
fn record(steps: usize) -> Vec<u8> {
    let options = PileOptions { bodies: 6, spheres: 100, ..PileOptions::default() };
    let mut pile = Pile::new(&options, |_| ()).unwrap();
    let mut file = Cursor::new(Vec::new());
    let mut recorder = Recorder::new(&mut file, RecordOptions::everything()).unwrap();
    let (vertices, triangles) = single_precision(&pile.bowl_solid);
    recorder.add_body(&BodyDescription::new(pile.bowl, "bowl").mesh(&vertices, &triangles)).unwrap();
    for body in &pile.bodies {
        let model = &pile.models[body.model];
        let (vertices, triangles) = single_precision(&model.solid);
        let description = BodyDescription::new(body.handle, &model.name).mesh(&vertices, &triangles);
        recorder.add_body(&description.spheres(&model.packing).scale(body.size)).unwrap();
    }
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
