//! The point nearest to the origin beyond a set of planes.
//!
//! R. Seidel, *Small-dimensional linear programming and convex hulls made easy* (1991), for the least distance instead of
//! a linear function: planes are added one by one. If the point found so far lies beyond the next plane, it stays; if not,
//! the new point lies in that plane, and the problem repeats there in one dimension less. Planes come in the order given and
//! not in a random one: cubic in their number in the worst case, near linear as a rule.

use glam::DVec3;

/// Points y with `normal·y ≥ level` lie beyond the plane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plane {
    /// Unit vector.
    pub(super) normal: DVec3,
    pub(super) level: f64,
}

/// Squared sine of the angle under which two planes count as parallel.
const PARALLEL: f64 = 1e-20;

/// The point nearest to the origin that falls short of none of `planes` by more than `slack`; `None` where there is none, or
/// rounding hides it.
pub(super) fn nearest_beyond<'a>(
    planes: impl Iterator<Item = &'a Plane> + Clone,
    slack: f64,
) -> Option<DVec3> {
    let mut y = DVec3::ZERO;
    for (i, plane) in planes.clone().enumerate() {
        if plane.normal.dot(y) < plane.level - slack {
            y = nearest_in_plane(plane, planes.clone().take(i), slack)?;
        }
    }
    Some(y)
}

/// The same among the points of `plane`.
fn nearest_in_plane<'a>(
    plane: &Plane,
    others: impl Iterator<Item = &'a Plane> + Clone,
    slack: f64,
) -> Option<DVec3> {
    let mut y = plane.level * plane.normal;
    for (j, other) in others.clone().enumerate() {
        if other.normal.dot(y) < other.level - slack {
            y = nearest_in_line([plane, other], others.clone().take(j), slack)?;
        }
    }
    Some(y)
}

/// The same among the points that two planes share.
fn nearest_in_line<'a>(
    [a, b]: [&Plane; 2],
    others: impl Iterator<Item = &'a Plane>,
    slack: f64,
) -> Option<DVec3> {
    let direction = a.normal.cross(b.normal);
    let sine_squared = direction.length_squared();
    if sine_squared < PARALLEL {
        return None;
    }
    // The point of the line nearest to the origin is a combination of the normals.
    let cosine = a.normal.dot(b.normal);
    let foot =
        ((a.level - cosine * b.level) * a.normal + (b.level - cosine * a.level) * b.normal) / sine_squared;
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for other in others {
        let (slope, missing) = (other.normal.dot(direction), other.level - other.normal.dot(foot));
        if slope > 0.0 {
            low = low.max((missing - slack) / slope);
        } else if slope < 0.0 {
            high = high.min((missing - slack) / slope);
        } else if missing > slack {
            return None;
        }
    }
    (low <= high).then(|| foot + direction * 0.0_f64.max(low).min(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_combination_of_planes_gives_a_nearer_point(
            list in prop::collection::vec((prop::array::uniform3(-1.0_f64..1.0), 0.0_f64..2.0), 1..12),
            inside in prop::array::uniform3(-3.0_f64..3.0),
        ) {
            // Planes that a given point lies beyond, so that there is a solution.
            let inside = DVec3::from(inside);
            let planes: Vec<Plane> = list
                .iter()
                .filter_map(|(normal, depth)| Some((DVec3::from(*normal).try_normalize()?, depth)))
                .map(|(normal, depth)| Plane { normal, level: normal.dot(inside) - depth })
                .collect();
            let y = nearest_beyond(planes.iter(), 1e-9).unwrap();
            prop_assert!(planes.iter().all(|plane| plane.normal.dot(y) >= plane.level - 2e-9));
            prop_assert!(y.length() <= inside.length() + 1e-9);
            // The set is convex: the point is nearest if and only if no point of the set lies on its near side. Tested with
            // points on the way to the given one and around.
            for i in 0..200 {
                let turn = DVec3::new((i as f64 * 0.7).sin(), (i as f64 * 1.3).cos(), (i as f64 * 2.1).sin());
                let point = y + 0.05 * turn;
                if planes.iter().all(|plane| plane.normal.dot(point) >= plane.level) {
                    prop_assert!(point.length() >= y.length() - 1e-7, "{} {}", point.length(), y.length());
                }
            }
        }
    }

    #[test]
    fn one_two_and_three_planes() {
        let plane = |normal: DVec3, level| Plane { normal, level };
        let planes =
            [plane(DVec3::X, 1.0), plane(DVec3::Y, 2.0), plane(DVec3::Z, -1.0), plane(DVec3::Z, 3.0)];
        let expected =
            [DVec3::X, DVec3::new(1.0, 2.0, 0.0), DVec3::new(1.0, 2.0, 0.0), DVec3::new(1.0, 2.0, 3.0)];
        for count in 1..=4 {
            let y = nearest_beyond(planes[..count].iter(), 0.0).unwrap();
            assert!(y.distance(expected[count - 1]) < 1e-12, "{count}");
        }
        let against = [plane(DVec3::X, 1.0), plane(DVec3::NEG_X, 1.0)];
        assert_eq!(nearest_beyond(against.iter(), 0.0), None);
    }
}
