//! Where on its way a fast pair is measured.
//!
//! Deep inside an overlap one can no longer tell on which side a body came in, and how much the volume shrinks on the way
//! back. A pair that moves far is therefore measured a little after it first touches. Where one shape may hold the other it is the
//! second contact that counts, if the pair goes deep into that: what slides over a floor is stopped by the wall.

use crate::IstShape;
use crate::candidates::Candidate;
use crate::dispatcher::time_of_impact;
use crate::lookahead::Displacement;
use ist::{BallKind, ContactSample, ImpactOptions};
use rapier3d::math::Real;
use rapier3d::parry::shape::Shape;

/// Pairs are looked at along their way where that is longer than this many times the solids' thickness. Not tuned.
const FAR: f64 = 0.5;

/// And then first where they overlap by this share of the thickness, or by the next multiples of it. Not tuned.
const STRIDE: f64 = 0.25;

/// A contact whose depth, by its volumes and cross-sections, is less than this share of a stride has just begun.
///
/// A row of five cubes of 0.2 m is hit at 20 m/s by one of 20 times their weight: they go up to 0.22 m into each other with
/// 0.25, 0.20 with 0.3, 0.19 with 0.5, and 0.15 with 0.6 to 0.8. With 0.8 a ladder that slides down a wall goes 1 cm into it.
const SHALLOW: f64 = 0.7;

/// How far from contact a cast may end, as a share of the thickness. Less than the stride, so that the first pose after it
/// overlaps; it bounds the work for bodies that slide along others. Not tuned.
const TOLERANCE: f64 = 0.05;

/// The same for pairs that a motor or the user drives together. They may be at rest just before contact, and what they feel may not be
/// that of a place deep inside: a piston that presses with a thousand newtons would stay 1 cm above a cube of 0.2 m, as the force falls
/// to nothing over twice the depth at which it was measured. They also are looked at along their way where that is short. Not tuned.
const GENTLE: f64 = 0.01;

/// What a pair goes in by in the rest of its way, in parts of the thickness, from which on a further contact counts. Not tuned.
const DEEP: f64 = 0.5;

/// Cosine (of 49°) of the angle between normals from which on they belong to different contacts.
///
/// Cups of 0.2 m with walls of 1 and 2 cm and one, three or ten marbles of 5 cm are shaken by 5 cm at 4, 5 and 6 Hz, ten seconds each. Of
/// the 84 marbles 58 get out if further contacts are not looked for, 28 with 0.5, 19 with 0.65, 21 with 0.8.
const OTHER_WAY: f32 = 0.65;

/// What is held by another is smaller than this many times it. A choice: among bodies of about one size, as in heaps, second contacts are
/// not looked for.
const HELD: Real = 0.5;

/// Most poses along the way at which an overlap is measured.
const MOST_PROBES: usize = 16;

/// The shares of the candidate's displacements at which it should be measured, until it overlaps: 0 to 1, ascending; none
/// where it touches nothing on its way. `skin` is the sum of the contact skins (m).
pub(crate) fn shares(
    shapes: [&dyn Shape; 2],
    candidate: &Candidate,
    skin: Real,
) -> impl Iterator<Item = f64> + use<> {
    let far = reach(shapes, &candidate.displacements) / thickness(shapes);
    let is_fast = far > FAR;
    let first_contact = |tolerance: f64| first_contact(shapes, candidate, skin, tolerance);
    let probes = if is_driven(candidate, far) {
        first_contact(0.5 * GENTLE).map(|contact| Probes { contact, even: 0.0, doubling: GENTLE / far })
    } else if is_fast && !candidate.is_at_end {
        // Where a pair touches already the way begins in contact.
        let contact = if candidate.touched { Some(0.0) } else { first_contact(TOLERANCE) };
        contact.map(|contact| Probes { contact, even: STRIDE / far, doubling: 0.0 })
    } else {
        Some(Probes { contact: 1.0, even: 0.0, doubling: 0.0 })
    };
    probes.into_iter().flat_map(Probes::shares)
}

/// Where a way is looked at: from contact on in even strides, or in strides of doubled lengths.
#[derive(Clone, Copy, Debug)]
struct Probes {
    contact: f64,
    even: f64,
    doubling: f64,
}

impl Probes {
    /// Ascending, 1 being the last.
    fn shares(self) -> impl Iterator<Item = f64> {
        let Self { contact, even, doubling } = self;
        let further = even.max(1.0 / MOST_PROBES as f64);
        let share = move |i: i32| {
            let share = if even > 0.0 { contact + even + f64::from(i) * further } else { contact };
            (share + doubling * 2_f64.powi(i)).min(1.0)
        };
        let mut is_over = false;
        (0..=MOST_PROBES as i32)
            .map(share)
            .take_while(move |share| !std::mem::replace(&mut is_over, *share >= 1.0))
    }
}

/// Whether one of the shapes may hold the other, which can then touch it in two places that have nothing to do with each other.
pub(crate) fn may_hold(shapes: [&dyn Shape; 2]) -> bool {
    let [a, b] = shapes.map(|shape| shape.compute_local_bounding_sphere().radius);
    let (larger, share) = if a > b { (shapes[0], b / a) } else { (shapes[1], a / b) };
    let is_hollow = larger.as_shape::<IstShape>().is_some()
        || larger.as_composite_shape().is_some()
        || larger.as_heightfield().is_some();
    is_hollow && share < HELD
}

/// Whether `next`, measured at the `share` of the candidate's displacements, has a contact that `first` has not, and into which the
/// pair goes deep in the rest of its way: what slides over the floor of a container reaches its wall.
pub(crate) fn has_another(
    shapes: [&dyn Shape; 2],
    candidate: &Candidate,
    share: f64,
    [first, next]: [&[ContactSample]; 2],
) -> bool {
    let [a, b] = candidate.displacements;
    let least = DEEP * thickness(shapes);
    next.iter().any(|s| {
        let point = s.point.as_dvec3();
        let rest = (b.at(point) - a.at(point)) * (1.0 - share);
        rest.dot(s.normal.as_dvec3()) < -least && first.iter().all(|f| f.normal.dot(s.normal) < OTHER_WAY)
    })
}

/// Whether `samples`, measured on the candidate's way, are of a contact that has just begun, so that it is better measured at the next look:
/// where the way is long and looked at in short strides.
pub(crate) fn is_shallow(shapes: [&dyn Shape; 2], candidate: &Candidate, samples: &[ContactSample]) -> bool {
    let thickness = thickness(shapes);
    let far = reach(shapes, &candidate.displacements) / thickness;
    if is_driven(candidate, far) || far <= FAR || far > STRIDE * MOST_PROBES as f64 {
        return false;
    }
    let volume: f64 = samples.iter().map(|s| f64::from(s.volume)).sum();
    let area: f64 = samples.iter().map(|s| f64::from(s.vector_area.length())).sum();
    2.0 * volume < SHALLOW * STRIDE * thickness * area
}

/// Whether a motor or the user drives the pair into a contact of which nothing is known yet; `far` (in thicknesses) is its way.
fn is_driven(candidate: &Candidate, far: f64) -> bool {
    candidate.is_driven && candidate.was_apart && (candidate.touched || far <= FAR)
}

/// Radius (m) below which the thinner solid holds half of its volume.
fn thickness(shapes: [&dyn Shape; 2]) -> f64 {
    let solids = shapes.into_iter().filter_map(|shape| shape.as_shape::<IstShape>());
    solids.map(|solid| f64::from(solid.thickness())).fold(f64::INFINITY, f64::min)
}

/// How far (m) in front of their surfaces contact between them begins.
fn contact_offset(shapes: [&dyn Shape; 2]) -> Real {
    let solids = shapes.into_iter().filter_map(|shape| shape.as_shape::<IstShape>());
    solids.map(|solid| solid.tree().contact_offset()).sum()
}

/// Longest way (m) of a point of one shape relative to the other.
fn reach(shapes: [&dyn Shape; 2], displacements: &[Displacement; 2]) -> f64 {
    let own = usize::from(shapes[0].as_shape::<IstShape>().is_none());
    let radius = shapes[own].compute_local_bounding_sphere().radius;
    displacements[own].reach(&displacements[1 - own], radius)
}

/// Share of the displacements after which the pair first touches, but for `tolerance` (share of the thickness).
fn first_contact(shapes: [&dyn Shape; 2], candidate: &Candidate, skin: Real, tolerance: f64) -> Option<f64> {
    let motions = [0, 1].map(|i| candidate.displacements[i].motion(&candidate.poses[i]));
    let options = ImpactOptions {
        balls: BallKind::Inner,
        max_time: 1.0,
        target_distance: skin + contact_offset(shapes),
        tolerance: (tolerance * thickness(shapes)) as Real,
        ..ImpactOptions::default()
    };
    time_of_impact(shapes, motions, options).map(f64::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shares(contact: f64, even: f64, doubling: f64) -> Vec<f64> {
        Probes { contact, even, doubling }.shares().collect()
    }

    #[test]
    fn ways_are_looked_at_to_their_end() {
        assert_eq!(shares(1.0, 0.0, 0.0), [1.0]);
        assert_eq!(shares(0.25, 0.25, 0.0), [0.5, 0.75, 1.0]);
        assert_eq!(shares(0.5, 0.0, 0.125), [0.625, 0.75, 1.0]);
        // Short strides are short only at first.
        let many = shares(0.0, 1e-3, 0.0);
        assert!(many.len() == MOST_PROBES + 1 && many[0] == 1e-3 && many.last() == Some(&1.0), "{many:?}");
        assert_eq!(shares(0.0, 0.0, 1e-3).last(), Some(&1.0));
    }
}
