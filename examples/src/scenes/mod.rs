//! Scenes, built once for examples, tests and benchmarks.

mod floating;
mod inside;
mod model;
mod pile;
mod recovery;
mod rings;
mod swing;
mod water;

pub use floating::{Floating, Rest};
pub use inside::Inside;
pub use model::{Model, ShapeKind, single_precision};
pub use pile::{Pile, PileBody, PileOptions, asset_folder};
pub use recovery::{Outcome, Recovery};
pub use rings::{Chain, RING_MAJOR, RING_MINOR, Ring, Stack, ring_shape};
pub use swing::Swing;
pub use water::{Submerged, Water};
