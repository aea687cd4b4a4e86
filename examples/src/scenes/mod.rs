//! Scenes, built once for examples, tests and benchmarks.

mod model;
mod pile;

pub use model::{Model, ShapeKind, single_precision};
pub use pile::{Pile, PileBody, PileOptions, asset_folder};
