//! Scenes, built once for examples, tests and benchmarks.

mod assembly;
mod bolt;
mod contact_wrench;
mod floating;
mod gears;
mod hand;
mod inside;
mod model;
mod part;
mod pile;
mod recovery;
mod rings;
mod soaked_chain;
mod soaked_pile;
mod swing;
mod turning;
mod water;

pub use assembly::Assembly;
pub use bolt::Bolt;
pub use floating::{Floating, Rest};
pub use gears::Gears;
pub use hand::Hand;
pub use inside::Inside;
pub use model::{Model, ShapeKind, single_precision};
pub use part::Part;
pub use pile::{Pile, PileBody, PileOptions, asset_folder};
pub use recovery::{Outcome, Recovery};
pub use rings::{Chain, RING_MAJOR, RING_MINOR, Ring, Stack, ring_shape};
pub use soaked_chain::SoakedChain;
pub use soaked_pile::SoakedPile;
pub use swing::Swing;
pub use turning::Turning;
pub use water::{Submerged, Water};
