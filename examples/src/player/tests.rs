use super::*;
use rapier_ist::StepReport;
use rapier_ist::record::{BodyDescription, RecordOptions, Recorder};
use rapier3d::prelude::*;
use std::io::Cursor;

#[test]
fn base64_is_that_of_the_standard() {
    let pairs = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
    for (plain, encoded) in pairs {
        assert_eq!(base64(plain.as_bytes()), encoded);
    }
    assert_eq!(base64(&[0xff, 0xfe, 0xfd]), "//79");
}

/// Two bodies of one shape, the larger one falling.
fn replay() -> Replay {
    let mut world = PhysicsWorld::new();
    let fixed = world.insert_body(RigidBodyBuilder::fixed());
    let falling = world.insert_body(
        RigidBodyBuilder::dynamic().translation(Vector::Y * 2.0).angvel(Vector::Z).additional_mass(1.0),
    );
    let mut bytes = Cursor::new(Vec::new());
    let mut recorder = Recorder::new(&mut bytes, RecordOptions::everything()).unwrap();
    let vertices = [Vector::ZERO, Vector::X, Vector::Y, Vector::Z];
    let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    for (handle, scale) in [(fixed, 1.0), (falling, 1.7)] {
        let body = BodyDescription::new(handle, "tetrahedron").mesh(&vertices, &triangles).scale(scale);
        recorder.add_body(&body).unwrap();
    }
    recorder.record_start(&world).unwrap();
    for _ in 0..30 {
        world.step();
        recorder.record(&world, &StepReport::default()).unwrap();
    }
    recorder.finish().unwrap();
    Replay::from_bytes(bytes.get_ref()).unwrap()
}

#[test]
fn the_numbers_are_those_of_the_recording() {
    let replay = replay();
    let recording = Recording::new(&replay, "fall").unwrap();
    let description = serde_json::to_value(&recording.description).unwrap();
    assert_eq!(description["meshes"].as_array().unwrap().len(), 1, "one shape in two sizes");
    let offset = description["poses"].as_u64().unwrap() as usize;
    for step in replay.steps() {
        for (index, body) in description["bodies"].as_array().unwrap().iter().enumerate() {
            let at = offset + 14 * (2 * step.index() + index);
            let (numbers, _) = recording.numbers[at..at + 14].as_chunks::<2>();
            let pose = step.pose(index).unwrap();
            let range = body["range"].as_f64().unwrap();
            for axis in 0..3 {
                let position = f64::from(u16::from_le_bytes(numbers[axis])) / 65535.0 * range
                    + body["lower"][axis].as_f64().unwrap();
                assert!((position - f64::from(pose.translation[axis])).abs() < 1e-4);
            }
            let rotation = [3, 4, 5, 6].map(|k| f32::from(i16::from_le_bytes(numbers[k])) / 32767.0);
            let rotation = Rotation::from_array(rotation).normalize();
            assert!((rotation * Vector::X).distance(pose.rotation * Vector::X) < 2e-4);
        }
    }
}

#[test]
fn the_page_holds_all_parts_and_needs_no_network() {
    let page = page(&replay(), "a </script> title").unwrap();
    for mark in ["/*STYLE*/", "/*DESCRIPTION*/", "/*NUMBERS*/", "/*SCRIPTS*/", "http:", "https:", "src="] {
        assert!(!page.contains(mark), "{mark}");
    }
    assert_eq!(page.matches("</script>").count(), 3, "the title ends none");
    assert!(page.contains("a \\u003c/script> title") && page.trim_end().ends_with("</html>"));
}

#[test]
fn a_recording_without_steps_is_refused() {
    let empty = Replay::from_bytes(&[]).unwrap();
    assert!(super::page(&empty, "empty").unwrap_err().to_string().contains("no step"));
}
