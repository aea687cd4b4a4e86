//! Properties that hold for arbitrary bytes, one module per fuzz target of `fuzz/`.
//!
//! Every `check` takes bytes and makes of them what it needs: files as they are, scenes and solids by the crate `arbitrary`.
//! It panics where a promise is broken. The fuzz targets call these functions, and so does the test `fuzzing`, with seeds,
//! with inputs that once failed and with pseudo-random bytes.

pub mod ist_reader;
pub mod mcap_replay;
pub mod mesh_readers;
mod numbers;
pub mod overlap;
pub mod plugin_steps;
pub mod proximity;
mod solids;

/// A fuzz target: its name, which is also that of its folder of seeds, and its property.
pub type Target = (&'static str, fn(&[u8]));

/// All of them.
pub const TARGETS: [Target; 6] = [
    ("ist_reader", ist_reader::check),
    ("mcap_replay", mcap_replay::check),
    ("mesh_readers", mesh_readers::check),
    ("overlap", overlap::check),
    ("plugin_steps", plugin_steps::check),
    ("proximity", proximity::check),
];
