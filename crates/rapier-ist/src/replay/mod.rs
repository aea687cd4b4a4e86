//! Recordings read back: bodies with their meshes and packings, poses at any time, contacts, energies, parameters.
//!
//! ```
//! use rapier_ist::StepReport;
//! use rapier_ist::record::{BodyDescription, RecordOptions, Recorder};
//! use rapier_ist::replay::Replay;
//! use rapier3d::prelude::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut world = PhysicsWorld::new();
//! let ball = world.insert_body(RigidBodyBuilder::dynamic().additional_mass(1.0));
//! let mut file = std::io::Cursor::new(Vec::new());
//! let mut recorder = Recorder::new(&mut file, RecordOptions::poses().metadata("seed", 42))?;
//! recorder.add_body(&BodyDescription::new(ball, "ball"))?;
//! recorder.record_start(&world)?;
//! for _ in 0..60 {
//!     world.step();
//!     recorder.record(&world, &StepReport::default())?;
//! }
//! recorder.finish()?;
//!
//! let replay = Replay::from_bytes(file.get_ref())?; // or Replay::open("fall.mcap")
//! let ball = replay.body_index("ball").ok_or("no ball")?;
//! let fallen = replay.pose_at(ball, 0.5).ok_or("no pose")?;
//! assert!((fallen.translation.y + 0.5 * 9.81 * 0.5 * 0.5).abs() < 0.05);
//! assert_eq!(replay.parameter("seed"), Some("42"));
//! # Ok(())
//! # }
//! ```
//!
//! A recording that ends early, as that of a killed run does, replays up to its last whole chunk; so does one that is
//! damaged, up to the damage. [`Replay::end`] tells which it is. Chunks and attachments that are replayed were checked against the
//! file's checksums.
//!
//! A replay holds everything in memory: 48 bytes for each body and step, and the contacts.

mod body;
mod builder;
mod contact;
mod container;
mod error;
mod interpolate;
mod reader;
mod scene;
#[cfg(test)]
mod tests;
mod timeline;

pub use body::{ReplayBody, ReplayMesh, ReplayPacking};
pub use contact::{ReplayContact, ReplayMetrics, ReplayPatch, ReplayTimings};
pub use error::{ReplayEnd, ReplayError};
pub use reader::{LogLine, Replay, ReplayStep};
