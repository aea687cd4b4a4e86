//! Dynamic non-convex bodies that simply collide: volume-penalty contacts for Rapier.

mod report;

pub use report::{PairContact, StepReport};
