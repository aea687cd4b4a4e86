//! Parts of a contact that give way together.
//!
//! A sample deep inside an overlap keeps its volume when the bodies separate a little, a sample at the rim loses all
//! of it, and only together do they tell how stiff the contact is: its force falls to zero over the depth
//! `D = V/A`, with A the cross-section (minus the derivative of the volume along the normal). Every sample is
//! given the depth of its patch, so that all of them let go at the same speed; with a depth of their own, rim
//! samples would let go first and leave those inside to push without any damping.
//!
//! Samples are in one patch where they push in about the same direction: a body in a groove has two.

use ist::ContactSample;
use rapier3d::glamx::{DVec3, Vec3};

/// Samples whose normals agree with the patch's first to within 50° join it; the walls of a right-angled groove
/// stay apart.
const SAME_DIRECTION: f32 = 0.64;

/// More directions than this are noise of a body deep inside another.
const MOST_PATCHES: usize = 8;

/// Least cross-section in units of V^⅔: that of a body wholly inside another, which no small motion lets out. A
/// convex overlap has 2 to 5.
const LEAST_CROSS_SECTION: f64 = 0.2;

/// Samples that push in about the same direction.
#[derive(Clone, Debug)]
pub(crate) struct Patch<'a> {
    pub(crate) samples: Vec<&'a ContactSample>,
    /// Volume over cross-section (m).
    pub(crate) depth: f64,
    /// Extent of the overlap along the push (m): what is reported is no deeper.
    pub(crate) extent: f64,
}

/// Sorts `samples` into patches, in the order of their first samples.
pub(crate) fn patches(samples: &[ContactSample]) -> Vec<Patch<'_>> {
    let mut groups: Vec<(Vec3, Vec<&ContactSample>)> = Vec::new();
    for sample in samples.iter().filter(|sample| sample.volume > 0.0) {
        let agreement = |group: &(Vec3, Vec<&ContactSample>)| group.0.dot(sample.normal);
        let best = (0..groups.len()).max_by(|&i, &j| agreement(&groups[i]).total_cmp(&agreement(&groups[j])));
        match best {
            Some(i) if agreement(&groups[i]) >= SAME_DIRECTION || groups.len() == MOST_PATCHES => {
                groups[i].1.push(sample)
            }
            _ => groups.push((sample.normal, vec![sample])),
        }
    }
    groups.into_iter().map(|(_, samples)| Patch::of(samples)).collect()
}

impl<'a> Patch<'a> {
    fn of(samples: Vec<&'a ContactSample>) -> Self {
        let push: DVec3 = samples.iter().map(|s| s.normal.as_dvec3() * f64::from(s.volume)).sum();
        let direction = push.normalize_or_zero();
        Self { depth: depth(&samples, direction), extent: extent(&samples, direction), samples }
    }
}

fn depth(samples: &[&ContactSample], direction: DVec3) -> f64 {
    let volume: f64 = samples.iter().map(|s| f64::from(s.volume)).sum();
    let area: DVec3 = samples.iter().map(|s| s.vector_area.as_dvec3()).sum();
    let size = libm::cbrt(volume);
    volume / area.dot(direction).max(LEAST_CROSS_SECTION * size * size).max(f64::MIN_POSITIVE)
}

/// From the lowest sample to the highest, and the largest of them itself: two balls share no lens that is thicker than
/// a ball of its volume.
fn extent(samples: &[&ContactSample], direction: DVec3) -> f64 {
    let heights = || samples.iter().map(|s| s.point.as_dvec3().dot(direction));
    let spread = heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min);
    let largest = samples.iter().map(|s| f64::from(s.volume)).fold(0.0, f64::max);
    spread + libm::cbrt(largest * 6.0 / core::f64::consts::PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(normal: Vec3, volume: f32, area: f32) -> ContactSample {
        ContactSample { point: Vec3::ZERO, normal, volume, vector_area: normal * area, outward: normal }
    }

    #[test]
    fn walls_of_a_groove_are_two_patches() {
        let (left, right) = (Vec3::new(1.0, 1.0, 0.0).normalize(), Vec3::new(-1.0, 1.0, 0.0).normalize());
        let samples = [sample(left, 0.2, 1.0), sample(right, 0.1, 1.0), sample(left, 0.1, 2.0)];
        let patches = patches(&samples);
        assert_eq!(patches.iter().map(|p| p.samples.len()).collect::<Vec<_>>(), [2, 1]);
        assert!((patches[0].depth - 0.1).abs() < 1e-6 && (patches[1].depth - 0.1).abs() < 1e-6);
    }

    #[test]
    fn a_body_wholly_inside_is_as_deep_as_it_is_large() {
        let samples = [sample(Vec3::Y, 0.001, 0.0)];
        let patches = patches(&samples);
        assert!((patches[0].depth - 0.1 / LEAST_CROSS_SECTION).abs() < 1e-6);
        assert!((patches[0].extent - 0.1240701).abs() < 1e-6, "diameter of the ball of a litre");
    }

    #[test]
    fn the_extent_of_a_spike_is_its_length() {
        let mut samples = [sample(Vec3::Y, 1e-6, 0.0); 11];
        for (i, sample) in samples.iter_mut().enumerate() {
            sample.point = Vec3::new(0.3, 0.01 * i as f32, -0.2);
        }
        let patches = patches(&samples);
        assert!((patches[0].extent - 0.1124070).abs() < 1e-6, "ten gaps of 1 cm and a ball of 1 cm³");
    }
}
