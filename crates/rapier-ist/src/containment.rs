//! A way out for a body that is inside another.
//!
//! A small body wholly inside a large one overlaps in the whole of itself wherever it is. What is left of the volume's
//! derivative then leads it into the gaps between the large body's spheres, where it would stay. So all samples push
//! in one direction, the mean of the outward normals, which no place inside leaves without force.

use ist::{ContactSample, InnerSphereTree};
use rapier3d::math::Real;

/// Share of the smaller body from which on the directions of the samples give way to their mean, and share at which they
/// have.
///
/// Bunny of 0.2 m inside one of 1 m, 300 spheres each: without this 42 of 73 poses are left.
const CONTAINED: [Real; 2] = [0.8, 0.95];

/// Turns the normals of `samples` to a common direction as far as one of the solids contains the other.
pub(crate) fn agree_on_direction([a, b]: [&InnerSphereTree; 2], samples: &mut [ContactSample]) {
    let smaller = a.solid().volume.min(b.solid().volume) as Real;
    let volume: Real = samples.iter().map(|sample| sample.volume).sum();
    let weight = ((volume / smaller - CONTAINED[0]) / (CONTAINED[1] - CONTAINED[0])).clamp(0.0, 1.0);
    let sum: rapier3d::math::Vector = samples.iter().map(|sample| sample.volume * sample.outward).sum();
    let Some(mean) = (sum / volume).try_normalize().filter(|_| weight > 0.0) else { return };
    for sample in samples {
        sample.normal = sample.normal.lerp(mean, weight).try_normalize().unwrap_or(mean);
        // As far as the direction is the mean, nothing is a bump.
        sample.outward = sample.outward.lerp(sample.normal, weight).normalize_or_zero();
    }
}
