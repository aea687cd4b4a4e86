//! Contact samples by connected regions that push in one direction.
//!
//! A region grows from the largest sample that is not in one yet, over samples near each other. What pushes in about the
//! same direction as the first belongs to it: the walls of a groove that meet at its bottom are two regions, and a ring
//! around a peg has several.

use ist::ContactSample;
use rapier3d::math::{Real, Vector};

/// Samples whose normals agree with the region's first to within 45° may join it.
const SAME_DIRECTION: Real = 0.7;

/// Samples are near each other within this many times the sum of their radii. The lenses of two equal balls have half the
/// balls' radius, and those of neighbours may be two balls' radii apart.
const NEAR: Real = 2.0;

/// More regions than this are noise of a body deep inside another; the ones around the smallest samples are left out.
const MOST_REGIONS: usize = 16;

/// Memory of a division.
#[derive(Debug, Default)]
pub(super) struct Regions {
    radii: Vec<Real>,
    /// Samples by falling volume.
    seeds: Vec<u32>,
    is_taken: Vec<bool>,
    stack: Vec<u32>,
    region: Vec<ContactSample>,
}

impl Regions {
    /// Calls `act` with the samples of every region, the one around the largest sample first. Sorts `samples` by place.
    ///
    /// Takes O(n log n + n m) time for n samples with m others as near each other along one axis.
    pub(super) fn divide(&mut self, samples: &mut [ContactSample], mut act: impl FnMut(&[ContactSample])) {
        let axis = longest_axis(samples);
        samples.sort_unstable_by(|a, b| a.point[axis].total_cmp(&b.point[axis]));
        self.radii.clear();
        self.radii.extend(samples.iter().map(radius));
        let widest = self.radii.iter().copied().fold(0.0, Real::max);
        self.is_taken.clear();
        self.is_taken.resize(samples.len(), false);
        let mut seeds = std::mem::take(&mut self.seeds);
        seeds.clear();
        seeds.extend(0..samples.len() as u32);
        let volume = |i: u32| samples[i as usize].volume;
        seeds.sort_unstable_by(|&i, &j| volume(j).total_cmp(&volume(i)).then(i.cmp(&j)));
        let mut count = 0;
        for &seed in &seeds {
            if self.is_taken[seed as usize] || count == MOST_REGIONS {
                continue;
            }
            self.grow(samples, seed, (axis, widest));
            count += 1;
            act(&self.region);
        }
        self.seeds = seeds;
    }

    /// Finds the region of the sample `seed` among those that are in none.
    fn grow(&mut self, samples: &[ContactSample], seed: u32, (axis, widest): (usize, Real)) {
        let direction = samples[seed as usize].normal;
        self.region.clear();
        self.is_taken[seed as usize] = true;
        self.stack.push(seed);
        while let Some(index) = self.stack.pop() {
            let index = index as usize;
            let sample = samples[index];
            self.region.push(sample);
            let reach = NEAR * (self.radii[index] + widest);
            let in_reach = |other: &usize| (samples[*other].point[axis] - sample.point[axis]).abs() <= reach;
            let above = (index + 1..samples.len()).take_while(in_reach);
            let below = (0..index).rev().take_while(in_reach);
            for other in above.chain(below) {
                let near = NEAR * (self.radii[index] + self.radii[other]);
                let joins = !self.is_taken[other]
                    && samples[other].normal.dot(direction) >= SAME_DIRECTION
                    && samples[other].point.distance_squared(sample.point) <= near * near;
                if joins {
                    self.is_taken[other] = true;
                    self.stack.push(other as u32);
                }
            }
        }
    }
}

/// Radius (m) of the ball whose shallow cap has the sample's volume V and cross-section A: A²/(4πV). Wholly inside, where
/// there is no cross-section, that of a ball of its volume.
fn radius(sample: &ContactSample) -> Real {
    let area = sample.vector_area.length();
    let cap = area * (area / (4.0 * std::f32::consts::PI * sample.volume));
    cap.max(libm::cbrtf(sample.volume * 0.75 / std::f32::consts::PI))
}

fn longest_axis(samples: &[ContactSample]) -> usize {
    let (mut mins, mut maxs) = (Vector::splat(Real::MAX), Vector::splat(Real::MIN));
    for sample in samples {
        (mins, maxs) = (mins.min(sample.point), maxs.max(sample.point));
    }
    (maxs - mins).max_position()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cap of a ball of radius 0.01 m, 1 mm high.
    fn cap(point: Vector, normal: Vector) -> ContactSample {
        let vector_area = normal * (std::f32::consts::PI * 0.001 * 0.019);
        let volume = std::f32::consts::PI * 1e-6 * (0.03 - 0.001) / 3.0;
        ContactSample { point, normal, volume, vector_area, outward: normal }
    }

    fn sizes(mut samples: Vec<ContactSample>) -> Vec<usize> {
        let mut sizes = Vec::new();
        Regions::default().divide(&mut samples, |region| sizes.push(region.len()));
        sizes.sort_unstable();
        sizes
    }

    #[test]
    fn rows_of_caps_with_a_gap_between_them_are_two_regions() {
        let row = |from: Real, count: usize| {
            (0..count).map(move |i| cap(Vector::new(from + 0.02 * i as Real, 0.0, 0.0), Vector::Y))
        };
        assert_eq!(sizes(row(0.0, 5).chain(row(0.2, 3)).collect()), [3, 5]);
        assert_eq!(sizes(row(0.0, 5).chain(row(0.11, 3)).collect()), [8]);
    }

    #[test]
    fn walls_that_meet_are_two_regions() {
        let wall = |side: Real| {
            (0..4).map(move |i| {
                let along = 0.01 * i as Real;
                cap(Vector::new(side * along, along, 0.0), Vector::new(-side, 1.0, 0.0).normalize())
            })
        };
        assert_eq!(sizes(wall(1.0).chain(wall(-1.0)).collect()), [4, 4]);
    }

    #[test]
    fn order_does_not_matter_and_numbers_are_bounded() {
        let mut far: Vec<_> = (0..40).map(|i| cap(Vector::X * i as Real, Vector::Y)).collect();
        assert_eq!(sizes(far.clone()), [1; MOST_REGIONS]);
        far.reverse();
        assert_eq!(sizes(far), [1; MOST_REGIONS]);
        assert!(sizes(Vec::new()).is_empty());
    }
}
