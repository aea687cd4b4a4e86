//! What the examples share: generated meshes, a headless renderer and a palette.

pub mod palette;
pub mod render;
pub mod shapes;
