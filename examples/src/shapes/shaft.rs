//! A round shaft with a shoulder.

use super::revolution::revolve;
use glam::DVec2;
use packer::TriangleMesh;

/// A shaft about the y axis that stands on a thicker one: what is put on it rests on the shoulder. Its upper end is a cone that
/// guides a bore onto it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaft {
    /// Radius and height of the part below the shoulder (m); the foot is at y = 0.
    pub foot: [f64; 2],
    /// Radius of the part above the shoulder, less than that of the foot, and its height without the cone (m).
    pub journal: [f64; 2],
    /// Radius of the flat end, less than that of the journal, and height of the cone (m).
    pub tip: [f64; 2],
}

impl Shaft {
    /// The solid, with `segments` facets around the axis (≥ 3).
    #[must_use]
    pub fn mesh(&self, segments: u32) -> TriangleMesh {
        let mut profile = vec![DVec2::ZERO];
        let mut height = 0.0;
        // The last point of a part and the first of the next make the shoulder.
        for [radius, length] in [self.foot, self.journal] {
            profile.push(DVec2::new(radius, height));
            height += length;
            profile.push(DVec2::new(radius, height));
        }
        height += self.tip[1];
        profile.extend([DVec2::new(self.tip[0], height), DVec2::new(0.0, height)]);
        revolve(&profile, segments)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::check::{Expected, assert_solid};

    /// Two prisms and a frustum, over the polygon of the facets.
    #[test]
    fn is_two_cylinders_and_a_cone() {
        let shaft = Shaft { foot: [0.2, 0.1], journal: [0.1, 0.4], tip: [0.04, 0.05] };
        let segments = 48;
        let angle = std::f64::consts::TAU / f64::from(segments);
        let polygon = 0.5 * f64::from(segments) * angle.sin();
        let cone = 0.05 / 3.0 * (0.1 * 0.1 + 0.1 * 0.04 + 0.04 * 0.04);
        let volume = polygon * (0.2 * 0.2 * 0.1 + 0.1 * 0.1 * 0.4 + cone);
        assert_solid(&shaft.mesh(segments), &Expected { volume, tolerance: 1e-12, euler: 2 });
    }
}
