//! Steepest ascent of the lower envelope of a few linear functions, within a trust ball.
//!
//! The clearance near a point is the minimum of the distances to a few obstacles. Linearised, its ascent
//! direction is the shortest vector of the convex hull of the active gradients (P. Wolfe, 1975; the same
//! sub-problem as in the GJK distance algorithm): along it the active distances grow alike until the next
//! obstacle becomes active. Where the hull contains the origin no direction gains: the maximum is reached,
//! and with four active obstacles it is a Voronoi vertex.

use glam::DVec3;

/// Distance to one obstacle, linearised: `value + gradient·x`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) value: f64,
    pub(super) gradient: DVec3,
}

/// Where the ascent ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Top {
    pub(super) step: DVec3,
    /// The envelope at `step`.
    pub(super) value: f64,
    /// Whether the trust ball stopped the ascent.
    pub(super) at_boundary: bool,
}

/// Climbs from the origin; the trust ball has centre `center` and radius `radius` and contains the origin.
pub(super) fn climb(planes: &[Plane], center: DVec3, radius: f64) -> Top {
    let mut step = DVec3::ZERO;
    let mut active = Active::default();
    let Some((first, plane)) = planes.iter().enumerate().min_by(|a, b| a.1.value.total_cmp(&b.1.value))
    else {
        return Top { step, value: 0.0, at_boundary: false };
    };
    let mut value = plane.value;
    active.push(first, plane.gradient);
    // Each turn adds an obstacle; more than a dozen turns happen only among nearly equal planes.
    for _ in 0..16 {
        let direction = active.reduce();
        let rate = direction.length_squared();
        if rate < 1e-9 {
            break;
        }
        // Distance to the trust ball's surface along the direction.
        let from_center = step - center;
        let b = from_center.dot(direction);
        let c = from_center.length_squared() - radius * radius;
        let boundary = (-b + (b * b - rate * c).max(0.0).sqrt()) / rate;
        let (mut length, mut next) = (boundary, None);
        for (index, plane) in planes.iter().enumerate() {
            let closing = rate - plane.gradient.dot(direction);
            if closing > 1e-9 * rate && !active.contains(index) {
                let gap = (plane.value + plane.gradient.dot(step) - value).max(0.0);
                if gap < length * closing {
                    (length, next) = (gap / closing, Some(index));
                }
            }
        }
        step += direction * length;
        value += rate * length;
        match next {
            None => return Top { step, value, at_boundary: true },
            Some(index) => active.push(index, planes[index].gradient),
        }
    }
    Top { step, value, at_boundary: false }
}

/// At most four active obstacles.
#[derive(Default)]
struct Active {
    count: usize,
    indices: [usize; 4],
    gradients: [DVec3; 4],
}

impl Active {
    fn contains(&self, index: usize) -> bool {
        self.indices[..self.count].contains(&index)
    }

    fn push(&mut self, index: usize, gradient: DVec3) {
        // Four affinely independent gradients hold the origin inside, where the ascent has ended; five can
        // only come from rounding. The oldest gives way then.
        if self.count == 4 {
            self.indices.rotate_left(1);
            self.gradients.rotate_left(1);
            self.count = 3;
        }
        self.indices[self.count] = index;
        self.gradients[self.count] = gradient;
        self.count += 1;
    }

    /// Shortest vector of the hull of the gradients; keeps only those that span its face.
    fn reduce(&mut self) -> DVec3 {
        let count = self.count;
        let newest = 1_u32 << (count - 1);
        let mut best = (f64::INFINITY, newest, self.gradients[count - 1]);
        // Subsets with the newest first: the older ones alone gave a longer vector already.
        for subset in (1..1_u32 << count).filter(|s| s & newest != 0) {
            if let Some(point) = self.affine_minimum(subset) {
                let length = point.length_squared();
                if length < best.0 {
                    best = (length, subset, point);
                }
            }
        }
        let mut kept = Self::default();
        for i in (0..count).filter(|i| best.1 & (1 << i) != 0) {
            kept.push(self.indices[i], self.gradients[i]);
        }
        *self = kept;
        best.2
    }

    /// The point nearest to the origin in the affine hull of a subset, if it lies inside the convex hull.
    fn affine_minimum(&self, subset: u32) -> Option<DVec3> {
        let mut points = [DVec3::ZERO; 4];
        let mut n = 0;
        for i in (0..self.count).filter(|i| subset & (1 << i) != 0) {
            points[n] = self.gradients[i];
            n += 1;
        }
        let [a, b, c, d] = points;
        match n {
            1 => Some(a),
            2 => {
                let ab = b - a;
                let t = -a.dot(ab) / ab.length_squared();
                (t > 0.0 && t < 1.0).then(|| a + ab * t)
            }
            3 => {
                let normal = (b - a).cross(c - a);
                let squared = normal.length_squared();
                let foot = normal * (a.dot(normal) / squared);
                let inside = |p: DVec3, q: DVec3| (p - foot).cross(q - foot).dot(normal) > 0.0;
                (squared > 1e-18 && inside(a, b) && inside(b, c) && inside(c, a)).then_some(foot)
            }
            _ => {
                let volume = (b - a).dot((c - a).cross(d - a));
                let same_side = |p: DVec3, q: DVec3, r: DVec3| -p.dot((q - p).cross(r - p)) * volume;
                let inside = volume.abs() > 1e-12
                    && same_side(a, b, c) > 0.0
                    && same_side(a, c, d) > 0.0
                    && same_side(a, d, b) > 0.0
                    && same_side(b, d, c) > 0.0;
                inside.then_some(DVec3::ZERO)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planes(list: &[(f64, DVec3)]) -> Vec<Plane> {
        list.iter().map(|(value, gradient)| Plane { value: *value, gradient: gradient.normalize() }).collect()
    }

    #[test]
    fn the_top_of_a_tetrahedron_is_its_incentre() {
        // Faces at distance 1 from (0.1, 0.2, -0.1), seen from the origin.
        let top = DVec3::new(0.1, 0.2, -0.1);
        let normals = [
            DVec3::new(1., 1., 1.),
            DVec3::new(1., -1., -1.),
            DVec3::new(-1., 1., -1.),
            DVec3::new(-1., -1., 1.),
        ];
        let list: Vec<_> = normals.iter().map(|n| (1.0 - n.normalize().dot(top), *n)).collect();
        let found = climb(&planes(&list), DVec3::ZERO, 10.0);
        assert!(!found.at_boundary);
        assert!(found.step.distance(top) < 1e-9, "{found:?}");
        assert!((found.value - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_slab_is_climbed_to_its_middle_plane() {
        let list = [(0.2, DVec3::X), (0.8, DVec3::NEG_X)];
        let found = climb(&planes(&list), DVec3::ZERO, 10.0);
        assert!((found.value - 0.5).abs() < 1e-12 && (found.step.x - 0.3).abs() < 1e-12);
    }

    #[test]
    fn the_trust_ball_ends_the_climb() {
        let found = climb(&planes(&[(0.2, DVec3::X)]), DVec3::ZERO, 0.25);
        assert!(found.at_boundary && (found.value - 0.45).abs() < 1e-12);
    }

    #[test]
    fn two_opposite_obstacles_and_a_slope_lead_along_the_valley() {
        let list = [(1.0, DVec3::X), (1.0, DVec3::NEG_X), (0.5, DVec3::new(0.0, 1.0, 0.0))];
        let found = climb(&planes(&list), DVec3::ZERO, 10.0);
        assert!((found.value - 1.0).abs() < 1e-9, "{found:?}");
    }
}
