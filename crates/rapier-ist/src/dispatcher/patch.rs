//! A region of the overlap as up to four contact points.

use ist::ContactSample;
use rapier3d::glamx::{DMat2, DVec2};
use rapier3d::math::{Pose, Real, Vector};

/// Contact points that push along one normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// From the first shape to the second.
    pub(super) normal: Vector,
    points: [PatchPoint; 4],
    count: usize,
}

/// One place of a patch.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PatchPoint {
    /// Half way between the surfaces (m).
    pub(super) middle: Vector,
    /// Distance (m) of the surfaces along the normal; negative where they overlap.
    pub(super) distance: Real,
}

impl PatchPoint {
    /// On the surfaces of the first shape and of the second.
    pub(super) fn ends(&self, normal: Vector) -> [Vector; 2] {
        let half = normal * (0.5 * self.distance);
        [self.middle - half, self.middle + half]
    }
}

impl Patch {
    /// A patch of one point, between `ends` and `distance` apart along `normal`.
    pub(super) fn single(ends: [Vector; 2], normal: Vector, distance: Real) -> Self {
        let mut points = [PatchPoint::default(); 4];
        points[0] = PatchPoint { middle: ends[0].midpoint(ends[1]), distance };
        Self { normal, points, count: 1 }
    }

    /// The patch of all of `samples`; `None` without volume.
    ///
    /// Points are the samples farthest out in four directions. Their mean depth is V/A, with the volume V and the
    /// cross-section A, and depths differ as in a linear field with the volume's first moments: bodies that lean are
    /// deeper where they lean to.
    pub(super) fn of(samples: &[ContactSample]) -> Option<Self> {
        let sum = |of: &dyn Fn(&ContactSample) -> Vector| samples.iter().map(of).sum::<Vector>();
        let volume: Real = samples.iter().map(|s| s.volume).sum();
        let push = sum(&|s| s.volume * s.normal);
        let normal =
            (push / push.abs().max_element()).try_normalize().or(samples.first().map(|s| s.normal))?;
        if volume.is_nan() || volume <= 0.0 {
            return None;
        }
        let area: Real = samples.iter().map(|s| cross_section(s, normal)).sum();
        // A body wholly inside another has a volume and no cross-section: its own size bounds the depth.
        let depth = (volume / area.max(Real::MIN_POSITIVE)).min(libm::cbrtf(volume));
        let centroid = sum(&|s| (s.volume / volume) * s.point);
        let (corners, count) = corners(samples, centroid, normal);
        let mean = corners[..count].iter().sum::<Vector>() / count as Real;
        let slope = slope(samples, centroid, normal);
        let rises = corners.map(|corner| slope.dot(corner - mean));
        // No point is farther out of the other body than its surface.
        let lowest = rises[..count].iter().copied().fold(0.0, Real::min);
        let share = if depth + lowest < 0.0 { depth / -lowest } else { 1.0 };
        let point = |i: usize| PatchPoint { middle: corners[i], distance: -(depth + share * rises[i]) };
        Some(Self { normal, points: [0, 1, 2, 3].map(point), count })
    }

    pub(super) fn points(&self) -> &[PatchPoint] {
        &self.points[..self.count]
    }

    /// Least distance of its points.
    pub(super) fn least_distance(&self) -> Real {
        self.points().iter().map(|point| point.distance).fold(Real::MAX, Real::min)
    }

    /// With all surfaces `more` farther apart.
    pub(super) fn moved_apart(self, more: Real) -> Self {
        let points = self.points.map(|point| PatchPoint { distance: point.distance + more, ..point });
        Self { points, ..self }
    }

    /// Seen in the frame in which its own stands at `pose`, from the other shape.
    pub(super) fn swapped(self, pose: &Pose) -> Self {
        let points = self.points.map(|point| PatchPoint { middle: *pose * point.middle, ..point });
        Self { normal: -(pose.rotation * self.normal), points, ..self }
    }
}

/// Area (m²) that a sample shows along `normal`.
fn cross_section(sample: &ContactSample, normal: Vector) -> Real {
    sample.vector_area.dot(normal).max(0.0)
}

/// The sample points farthest from `center` across `normal`, opposite of that, and to both sides; each once.
fn corners(samples: &[ContactSample], center: Vector, normal: Vector) -> ([Vector; 4], usize) {
    let across = |s: &ContactSample| (s.point - center).reject_from_normalized(normal);
    let highest = |height: &dyn Fn(Vector) -> Real| {
        let heights = samples.iter().map(|s| height(across(s)));
        let best = heights.enumerate().fold((0, Real::NEG_INFINITY), |best, (i, height)| {
            if height > best.1 { (i, height) } else { best }
        });
        best.0
    };
    let first = highest(&|v| v.length_squared());
    let along = samples.get(first).map_or(Vector::ZERO, across).normalize_or_zero();
    let side = normal.cross(along);
    let found = [first, highest(&|v| -v.dot(along)), highest(&|v| v.dot(side)), highest(&|v| -v.dot(side))];
    let mut corners = [center; 4];
    let mut count = 0;
    for (position, &index) in found.iter().enumerate() {
        if let (Some(sample), false) = (samples.get(index), found[..position].contains(&index)) {
            corners[count] = sample.point;
            count += 1;
        }
    }
    (corners, count.max(1))
}

/// Gradient across `normal` of the linear depth field with the samples' volume and first moments over their cross-sections:
/// `S b = (V/A) (c − x)`, with the cross-section's centroid x and covariance S, and the volume's centroid c.
fn slope(samples: &[ContactSample], centroid: Vector, normal: Vector) -> Vector {
    let (u, v) = normal.any_orthonormal_pair();
    let place = |s: &ContactSample| {
        let offset = s.point - centroid;
        DVec2::new(f64::from(offset.dot(u)), f64::from(offset.dot(v)))
    };
    let weight = |s: &ContactSample| f64::from(cross_section(s, normal));
    let (mut area, mut volume, mut moment) = (0.0, 0.0, DVec2::ZERO);
    for s in samples {
        area += weight(s);
        volume += f64::from(s.volume);
        moment += weight(s) * place(s);
    }
    let center = moment / area;
    let mut covariance = DMat2::ZERO;
    for s in samples {
        let (share, arm) = (weight(s) / area, place(s) - center);
        // Every sample is a disc of its own.
        let own = DMat2::from_diagonal(DVec2::splat(weight(s) / (4.0 * std::f64::consts::PI)));
        covariance += (DMat2::from_cols(arm * arm.x, arm * arm.y) + own) * share;
    }
    let slope = covariance.inverse() * (-center * (volume / area));
    let slope = u * slope.x as Real + v * slope.y as Real;
    if slope.is_finite() { slope } else { Vector::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns of depth `depth` on a grid of 11 × 5 cells of 1 cm, pushing up.
    fn columns(depth: impl Fn(Real, Real) -> Real) -> Vec<ContactSample> {
        let cell = |i: usize| {
            let (x, z) = (0.01 * (i % 11) as Real - 0.05, 0.01 * (i / 11) as Real - 0.02);
            let volume = 1e-4 * depth(x, z);
            let point = Vector::new(x, 0.0, z);
            ContactSample {
                point,
                normal: Vector::Y,
                volume,
                vector_area: Vector::Y * 1e-4,
                outward: Vector::Y,
            }
        };
        (0..55).map(cell).collect()
    }

    #[test]
    fn a_level_patch_has_its_corners_and_one_depth() {
        let patch = Patch::of(&columns(|_, _| 0.002)).unwrap();
        assert_eq!((patch.normal, patch.points().len()), (Vector::Y, 4));
        for point in patch.points() {
            let corner = (point.middle.x.abs() - 0.05).abs().max((point.middle.z.abs() - 0.02).abs());
            assert!(corner < 1e-6 && (point.distance + 0.002).abs() < 1e-6, "{point:?}");
        }
    }

    #[test]
    fn a_leaning_patch_is_deeper_where_it_leans_to_and_means_volume_over_area() {
        let depth = |x: Real, z: Real| 0.002 + 0.01 * x - 0.02 * z;
        let samples = columns(depth);
        let patch = Patch::of(&samples).unwrap();
        for point in patch.points() {
            // The disc of each column widens the footprint a little.
            let expected = depth(point.middle.x, point.middle.z);
            assert!((point.distance + expected).abs() < 1e-4, "{point:?}, {expected}");
        }
        let mean = patch.points().iter().map(|point| -point.distance).sum::<Real>() / 4.0;
        let volume: Real = samples.iter().map(|s| s.volume).sum();
        assert!((mean - volume / 55e-4).abs() < 1e-6, "{mean}");
    }

    #[test]
    fn depths_are_never_negative_and_keep_their_mean() {
        // All of the volume at one end.
        let patch = Patch::of(&columns(|x, _| if x > 0.045 { 0.01 } else { 1e-6 })).unwrap();
        assert!(patch.points().iter().all(|point| point.distance <= 1e-9));
        let mean = patch.points().iter().map(|point| -point.distance).sum::<Real>() / 4.0;
        assert!((mean - (0.01 + 1e-5) / 11.0).abs() < 1e-6, "{mean}");
    }

    #[test]
    fn few_samples_give_few_points() {
        let samples = columns(|_, _| 0.002);
        for count in [1, 2, 3] {
            let patch = Patch::of(&samples[..count]).unwrap();
            assert_eq!(patch.points().len(), count.min(2), "a row has two ends");
        }
        assert!(Patch::of(&[]).is_none());
        let contained = ContactSample { vector_area: Vector::ZERO, ..samples[0] };
        let patch = Patch::of(&[contained]).unwrap();
        assert!((patch.least_distance() + contained.volume.cbrt()).abs() < 1e-6);
    }

    #[test]
    fn a_swapped_patch_has_the_same_ends_in_the_other_order() {
        let pose = Pose::translation(0.1, 0.2, 0.3);
        let patch = Patch::of(&columns(|x, _| 0.002 + 0.01 * x)).unwrap();
        let swapped = patch.swapped(&pose);
        for (point, other) in patch.points().iter().zip(swapped.points()) {
            let ([p1, p2], [q1, q2]) = (point.ends(patch.normal), other.ends(swapped.normal));
            assert!((pose * p1).distance(q2) < 1e-6 && (pose * p2).distance(q1) < 1e-6);
            assert!(((p2 - p1).dot(patch.normal) - point.distance).abs() < 1e-7);
        }
    }
}
