//! The reader of recordings.
//!
//! Whatever the bytes: an error, or a recording of which every part can be asked for. A recording of which up to three bytes
//! are damaged, or that is cut off, replays as a beginning of the whole one.

use super::numbers::{below, raw};
use super::solids::one_ball;
use arbitrary::Unstructured;
use rapier_ist::record::{BodyDescription, ChunkCompression, RecordError, RecordOptions, Recorder};
use rapier_ist::replay::{Replay, ReplayEnd};
use rapier_ist::{IstPlugin, IstShape};
use rapier3d::prelude::*;
use std::io::Cursor;
use std::sync::OnceLock;

/// Opcode and length in front of a record.
const PREFIX: usize = 1 + 8;
const ATTACHMENT: u8 = 0x09;
const CHUNK: u8 = 0x06;
const DATA_END: u8 = 0x0F;
/// Where a chunk's checksum stands in its record's body, after two times and a size.
const CHUNK_CHECKSUM: std::ops::Range<usize> = 24..28;

/// The bytes as a recording; and a recording that they damage, with its checksums and without.
pub fn check(data: &[u8]) {
    explore(data);
    explore(&unsealed(data.to_vec()));
    let u = &mut Unstructured::new(data);
    let recordings = recordings();
    let Some((bytes, whole)) = recordings.get(usize::from(below(u, 3))) else { return };
    let flips = below(u, 4);
    let mut damaged = bytes.clone();
    for _ in 0..flips {
        let at = raw::<u32>(u) as usize % damaged.len();
        damaged[at] ^= raw::<u8>(u);
    }
    if below(u, 4) == 0 {
        damaged.truncate(raw::<u32>(u) as usize % damaged.len());
    }
    if let Ok(replay) = Replay::from_bytes(&damaged) {
        assert_is_beginning(&replay, whole);
        exercise(&replay);
    }
    edit(&mut damaged, u);
    explore(&damaged);
    explore(&unsealed(damaged));
}

/// More damage: bytes set, pieces moved to other places.
fn edit(bytes: &mut Vec<u8>, u: &mut Unstructured) {
    while !u.is_empty() && !bytes.is_empty() {
        let at = raw::<u32>(u) as usize % bytes.len();
        let length = usize::from(raw::<u8>(u)).min(bytes.len() - at);
        match below(u, 4) {
            0 => bytes[at] = raw(u),
            1 => drop(bytes.drain(at..at + length)),
            2 => {
                let piece = bytes[at..at + length].to_vec();
                let to = raw::<u32>(u) as usize % bytes.len();
                bytes.splice(to..to, piece);
            }
            _ => {
                let piece: Vec<u8> = (0..length % 16).map(|_| raw(u)).collect();
                bytes.splice(at..at, piece);
            }
        }
    }
}

/// Reads whatever there is.
fn explore(bytes: &[u8]) {
    if let Ok(replay) = Replay::from_bytes(bytes) {
        exercise(&replay);
    }
}

/// The same with checksums that are zero, which stands for none, or right.
fn unsealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut at = mcap::MAGIC.len();
    while let Some((opcode, length)) = prefix_at(&bytes, at) {
        let Some(body) = bytes.get_mut(at + PREFIX..).and_then(|rest| rest.get_mut(..length)) else { break };
        match opcode {
            CHUNK => {
                if let Some(checksum) = body.get_mut(CHUNK_CHECKSUM) {
                    checksum.fill(0);
                }
            }
            DATA_END => body.fill(0),
            ATTACHMENT => {
                if let Some((data, checksum)) = body.split_last_chunk_mut() {
                    *checksum = crc32fast::hash(data).to_le_bytes();
                }
            }
            _ => {}
        }
        at += PREFIX + length;
    }
    bytes
}

fn prefix_at(bytes: &[u8], at: usize) -> Option<(u8, usize)> {
    let (opcode, length) = bytes.get(at..at.checked_add(PREFIX)?)?.split_first()?;
    Some((*opcode, u64::from_le_bytes(length.try_into().ok()?).try_into().ok()?))
}

/// Asks a replay for everything, also at times and for bodies that are not there.
fn exercise(replay: &Replay) {
    let bodies = replay.bodies().len();
    let mut last = 0;
    for step in replay.steps() {
        assert!(step.nanoseconds() >= last, "steps go back in time");
        last = step.nanoseconds();
        for (body, pose) in step.poses() {
            assert!(body < bodies);
            assert!(same(step.pose(body), Some(pose)));
        }
        for contact in step.contacts() {
            assert!(contact.bodies.iter().flatten().all(|body| *body < bodies));
        }
        let _ = step.metrics();
    }
    for (index, body) in replay.bodies().iter().enumerate() {
        assert_eq!(replay.body_index(&body.name), Some(index));
    }
    for time in [0.0, -1.0, 0.01, replay.duration(), f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::NAN] {
        for body in 0..=bodies {
            let pose = replay.pose_at(body, time);
            assert!(pose.is_none() || (body < bodies && !time.is_nan()));
        }
        let _ = replay.step_at(time);
    }
    assert!(replay.step(replay.step_count()).is_none());
    let _ = (replay.parameter("seed"), replay.log(), replay.up(), replay.defects(), replay.end().to_string());
}

/// Equal, with NaN equal to itself.
fn same(a: Option<Pose>, b: Option<Pose>) -> bool {
    format!("{a:?}") == format!("{b:?}")
}

fn assert_is_beginning(part: &Replay, whole: &Replay) {
    assert!(part.step_count() <= whole.step_count(), "{}", part.end());
    for (a, b) in part.steps().zip(whole.steps()) {
        let what = format!("step {} of a replay with {}", a.index(), part.end());
        assert_eq!(a.nanoseconds(), b.nanoseconds(), "{what}");
        assert!(a.poses().eq(b.poses()), "{what}");
        assert!(a.contacts().is_empty() || a.contacts() == b.contacts(), "{what}");
    }
}

/// A recording with each compression, and its replay.
fn recordings() -> &'static [(Vec<u8>, Replay)] {
    static RECORDINGS: OnceLock<Vec<(Vec<u8>, Replay)>> = OnceLock::new();
    RECORDINGS.get_or_init(|| {
        let compressions = [ChunkCompression::None, ChunkCompression::Lz4, ChunkCompression::Zstd];
        let recordings = compressions.map(|compression| match recording(compression) {
            Ok(bytes) => match Replay::from_bytes(&bytes) {
                Ok(replay) if replay.end() == &ReplayEnd::Complete => (bytes, replay),
                other => unreachable!("a recording that was just written: {other:?}"),
            },
            Err(error) => unreachable!("a recording in memory: {error}"),
        });
        recordings.into()
    })
}

/// Two balls that fall onto a fixed one, in chunks of a few steps.
///
/// # Errors
/// Those of the recorder, which a recording in memory does not have.
pub fn recording(compression: ChunkCompression) -> Result<Vec<u8>, RecordError> {
    let mut world = PhysicsWorld::new();
    let mut plugin = IstPlugin::install(&mut world);
    let packing = one_ball();
    let shape = IstShape::from_packing(&packing);
    let bodies = [0.0, 1.95, 3.9].map(|y| {
        let body = if y > 0.0 { RigidBodyBuilder::dynamic() } else { RigidBodyBuilder::fixed() };
        world.insert(body.translation(Vector::new(0.1 * y, y, 0.0)), shape.clone().into_collider()).0
    });
    let mut bytes = Vec::new();
    let options = RecordOptions::everything().chunk_size(700).compression(compression).metadata("seed", 7);
    let mut recorder = Recorder::new(Cursor::new(&mut bytes), options)?;
    let (vertices, triangles) = ([Vector::ZERO, Vector::X, Vector::Y], [[0, 1, 2]]);
    for body in bodies {
        let described = BodyDescription::new(body, "ball").mesh(&vertices, &triangles).spheres(&packing);
        recorder.add_body(&described)?;
    }
    recorder.record_start(&world)?;
    for _ in 0..8 {
        let report = plugin.step(&mut world).clone();
        recorder.record(&world, &report)?;
    }
    recorder.finish()?;
    Ok(bytes)
}
