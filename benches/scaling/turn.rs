//! How far a solid is turned against itself.

use crate::solids::Case;
use std::f32::consts::PI;
use std::fmt;

/// A rotation that a solid of any number of spheres can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Turn {
    /// By so much (rad). The more spheres, the more radii they move.
    Angle(f32),
    /// So far that its farthest point moves by so many radii of its mean sphere, which makes neighbours look alike whatever
    /// the number of spheres.
    Radii(f32),
}

impl Turn {
    /// For the solid of `case` (rad).
    pub(crate) fn angle(self, case: &Case) -> f32 {
        match self {
            Self::Angle(angle) => angle,
            Self::Radii(radii) => {
                let volume = case.tree.solid().volume as f32 / case.tree.len() as f32;
                radii * (0.75 / PI * volume).cbrt() / case.tree.bounding_ball().1
            }
        }
    }
}

impl fmt::Display for Turn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Angle(angle) => write!(f, "turned by {angle} rad against itself"),
            Self::Radii(radii) => {
                write!(f, "turned against itself by {radii} radii of its mean sphere at its farthest point")
            }
        }
    }
}
