//! Closed manifold meshes with known volumes, generated instead of loaded.
//!
//! All lengths are in metres, y is up, and triangles run counter-clockwise seen from outside. Every surface is
//! one closed manifold without self-intersection for the parameters its function asks for; segment counts below
//! the least that makes a solid are raised to it.

mod bowl;
#[cfg(test)]
mod check;
mod cross;
mod cuboid;
mod grid;
mod nut;
mod revolution;
mod ring;
mod screw_thread;
mod shaft;
mod sphere;
mod spur_gear;
mod torus_knot;

pub use bowl::bowl;
pub use cross::cross;
pub use cuboid::cuboid;
pub use nut::hexagonal_nut;
pub use ring::ring;
pub use screw_thread::ScrewThread;
pub use shaft::Shaft;
pub use sphere::sphere;
pub use spur_gear::SpurGear;
pub use torus_knot::torus_knot;
