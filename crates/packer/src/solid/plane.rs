//! Coordinates in the plane of a triangle.

use glam::{DVec2, DVec3};

/// Coordinates `(u, v)` of the point `a + u·(b − a) + v·(c − a)` in the plane of the triangle `abc`: the triangle
/// is where `u ≥ 0`, `v ≥ 0` and `u + v ≤ 1`.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrianglePlane {
    origin: DVec3,
    u: DVec3,
    v: DVec3,
    /// Length: twice the area.
    normal: DVec3,
}

/// A triangle lower than this share of its longest side has no plane: rounding of its corners turns it at will.
const FLATTEST: f64 = 1e-10;
/// What lies nearer than this share of its height to a side of a triangle lies on the side.
const MARGIN: f64 = 1e-9;

impl TrianglePlane {
    /// None where the triangle is too flat to have one.
    pub(super) fn new([a, b, c]: &[DVec3; 3]) -> Option<Self> {
        let (u, v) = (*b - *a, *c - *a);
        let normal = u.cross(v);
        let longest = u.length_squared().max(v.length_squared()).max(b.distance_squared(*c));
        (normal.length() > FLATTEST * longest).then_some(Self { origin: *a, u, v, normal })
    }

    /// Normal, twice the area long.
    pub(super) fn normal(&self) -> DVec3 {
        self.normal
    }

    /// Coordinates of the foot of the perpendicular from `p`.
    pub(super) fn project(&self, p: DVec3) -> DVec2 {
        let p = p - self.origin;
        let along = |normal: DVec3| normal.dot(self.normal) / self.normal.length_squared();
        DVec2::new(along(p.cross(self.v)), along(self.u.cross(p)))
    }

    pub(super) fn point(&self, at: DVec2) -> DVec3 {
        self.origin + self.u * at.x + self.v * at.y
    }
}

/// How far inside the triangle `at` lies, as a share of its heights; negative outside.
pub(super) fn margin(at: DVec2) -> f64 {
    at.x.min(at.y).min(1.0 - at.x - at.y)
}

/// Whether `at` lies inside the triangle and not on one of its sides.
pub(super) fn is_within(at: DVec2) -> bool {
    margin(at) > MARGIN
}

/// The part of a segment that runs through the inside of the triangle, if there is one.
pub(super) fn clip(segment: [DVec2; 2]) -> Option<[DVec2; 2]> {
    within(segment, 0.0).filter(|inside| is_within(inside[0].lerp(inside[1], 0.5)))
}

/// Whether a part of a segment runs along the border of the triangle, or inside.
pub(super) fn runs_along(segment: [DVec2; 2]) -> bool {
    within(segment, 2.0 * MARGIN).is_some()
}

/// The part of the segment `from`–`to` that lies in the triangle, enlarged by `slack` of its heights, if that is longer than rounding.
fn within([from, to]: [DVec2; 2], slack: f64) -> Option<[DVec2; 2]> {
    // Cyrus and Beck: each side leaves an interval of the parameter.
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    let heights = |at: DVec2| [at.x + slack, at.y + slack, 1.0 - at.x - at.y + slack];
    for (a, b) in heights(from).into_iter().zip(heights(to)) {
        if a < 0.0 && b < 0.0 {
            return None;
        }
        if a < 0.0 {
            first = first.max(a / (a - b));
        } else if b < 0.0 {
            last = last.min(a / (a - b));
        }
    }
    let inside = [from.lerp(to, first), from.lerp(to, last)];
    (first < last && inside[0].distance(inside[1]) > MARGIN + 8.0 * slack).then_some(inside)
}
