//! Dynamic non-convex bodies that simply collide: volume-penalty contacts for Rapier.

mod against_shape;
mod candidates;
mod dispatcher;
mod hooks;
mod lookahead;
mod model;
mod penalty;
mod plugin;
mod query;
#[cfg(feature = "mcap")]
pub mod record;
mod report;
mod response;
mod shape;

pub use dispatcher::IstDispatcher;
pub use model::{ContactModel, Stiffness, VolumePenalty};
pub use plugin::IstPlugin;
pub use report::{PairContact, StepReport};
pub use shape::IstShape;

// The README's code, compiled with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
