//! Recordings of a simulation as MCAP files that Foxglove and Rerun open.
//!
//! ```
//! use rapier_ist::StepReport;
//! use rapier_ist::record::{BodyDescription, RecordOptions, Recorder};
//! use rapier3d::prelude::*;
//!
//! # fn main() -> Result<(), rapier_ist::record::RecordError> {
//! let mut world = PhysicsWorld::new();
//! let ball = world.insert_body(RigidBodyBuilder::dynamic().additional_mass(1.0));
//!
//! # let mut file = Vec::new();
//! # let mut recorder =
//! #     Recorder::new(std::io::Cursor::new(&mut file), RecordOptions::contacts().metadata("seed", 42))?;
//! # /*
//! let mut recorder = Recorder::create("fall.mcap", RecordOptions::contacts().metadata("seed", 42))?;
//! # */
//! recorder.add_body(&BodyDescription::new(ball, "ball"))?;
//! recorder.record_start(&world)?;
//! for _ in 0..60 {
//!     world.step();
//!     recorder.record(&world, &StepReport::default())?;
//! }
//! let statistics = recorder.finish()?;
//! assert_eq!(statistics.steps, 60);
//! # Ok(())
//! # }
//! ```
//!
//! [`RecordOptions::poses`] leaves out contacts, their arrows and metrics; `/NAME/spheres` and the packings come with
//! [`RecordOptions::everything`] only.
//!
//! | topic | schema | when |
//! |---|---|---|
//! | `/tf` | `foxglove.FrameTransforms` | every recorded step: the pose of every body in the frame `world` |
//! | `/scene` | `foxglove.SceneUpdate` | when a body is described or removed: all meshes, in body frames |
//! | `/NAME/spheres` | `foxglove.PointCloud` | once per body with a packing: centres and radii (m) |
//! | `/scene/contacts` | `foxglove.SceneUpdate` | every recorded step: force arrows |
//! | `/contacts` | `rapier_ist.Contacts` | every recorded step: overlap volume, depth, force, torque of each pair and of its patches |
//! | `/metrics` | `rapier_ist.Metrics` | every recorded step: energies, deepest overlap |
//! | `/log` | `foxglove.Log` | start, end, and what went wrong in between |
//!
//! Everything is protobuf, because Rerun opens Foxglove's schemas in that encoding only. The log time of step *k*
//! is *k* times the time step in whole nanoseconds, and no wall time gets into the file unless
//! [`RecordOptions::timings`] asks for it: equal runs give equal bytes.
//!
//! Viewers draw z upwards. The frame `map` is theirs; `world`, Rapier's, stands in it as
//! [`RecordOptions::up`] says.

mod background;
mod body;
mod contacts;
mod convert;
mod error;
#[cfg(test)]
mod fault_tests;
mod file;
pub(crate) mod messages;
mod metrics;
mod names;
mod options;
mod poses;
mod recorder;
mod scene;
mod sink;
#[cfg(test)]
pub(crate) mod test_scene;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod writer_tests;

pub use body::BodyDescription;
pub use error::RecordError;
pub use options::{ChunkCompression, RecordOptions, UpAxis};
pub use recorder::{RecordStatistics, Recorder};

/// The frame of Rapier's coordinates.
pub(crate) const WORLD_FRAME: &str = "world";
/// The frame that viewers start from: fixed and z-up, after ROS REP 105.
pub(crate) const ROOT_FRAME: &str = "map";
/// In the metadata of a channel with spheres: the attachment with the packing.
pub(crate) const PACKING_KEY: &str = "packing";
/// In the metadata of a channel with spheres: the body's size relative to the packing.
pub(crate) const SCALE_KEY: &str = "scale";
