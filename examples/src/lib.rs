//! What the examples, tests and benchmarks share: generated meshes, scenes, their runs, figures, a headless renderer.

pub mod accuracy;
pub mod animation;
pub mod figures;
pub mod output;
pub mod pair;
pub mod palette;
pub mod playback;
pub mod player;
pub mod plot;
pub mod poses;
pub mod recording;
pub mod render;
pub mod run;
pub mod scenes;
pub mod shapes;
pub mod submerged;
pub mod waiting;
