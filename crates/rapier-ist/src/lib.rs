//! Dynamic non-convex bodies that simply collide: volume-penalty contacts for Rapier.

#[cfg(feature = "mcap")]
pub mod record;
mod report;

pub use report::{PairContact, StepReport};
