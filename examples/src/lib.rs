//! What the examples, tests and benchmarks share: generated meshes, scenes, figures, a headless renderer.

pub mod figures;
pub mod output;
pub mod palette;
pub mod render;
pub mod scenes;
pub mod shapes;
pub mod waiting;
