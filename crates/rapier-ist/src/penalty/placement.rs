//! Where a contact that was measured at the predicted poses acts on the bodies as they are.

use super::body::SolverBody;
use crate::lookahead::Displacement;
use crate::query::Contact;
use ist::ContactSample;
use rapier3d::glamx::DVec3;

/// Cosine (of 40°) of the angle between a bump's normal and its surface's down to which they are one. What differs more is deep in an
/// overlap or at an edge.
///
/// Share of its acceleration that a nut has on its thread, of 1 m/s that a frictionless slab has on a plate after a second, and the fastest turn
/// of 73 bunnies that leave another: 1.00, 0.89 m/s and 19 rad/s with 0.64, 0.98, 0.89 and 14 with 0.77, 0.95, 0.89 and 13 with
/// 0.87, 0.52, 0.72 and 14 with 0.94.
const SAME_SURFACE: f32 = 0.77;

/// Leads from the poses at which a contact was measured to the present ones.
///
/// A contact goes back with the centres of mass, but it does not turn back with the bodies: its arms about these are those
/// at the predicted poses, as its normals are. Arms that turn back leave normals that are turned forward by comparison: a ball that
/// rolls would be slowed down, and a ring that is squeezed onto a shaft would turn ever faster.
pub(super) struct Placement {
    /// Centroid of the overlap, world frame.
    pub(super) origin: DVec3,
    /// How far the contact has gone with the bodies (m).
    way: DVec3,
    /// Displacements to the poses at which it was measured.
    to_contact: [Displacement; 2],
    /// What follows them, of a pair that was measured early on its way.
    behind: Option<[Displacement; 2]>,
    /// How far bodies that turn as one seem to part in the step (m), see [`turning`].
    pub(super) turning: DVec3,
}

impl Placement {
    pub(super) fn of(states: [&SolverBody; 2], contact: &Contact) -> Self {
        let volume: f64 = contact.samples.iter().map(|s| f64::from(s.volume)).sum();
        let moment: DVec3 = contact.samples.iter().map(|s| s.point.as_dvec3() * f64::from(s.volume)).sum();
        let (all, to_contact) = (contact.candidate.displacements, contact.displacements);
        let way = way(states, to_contact);
        let origin = moment / volume.max(f64::MIN_POSITIVE) - way;
        let behind = (all != to_contact).then(|| [all[0] - to_contact[0], all[1] - to_contact[1]]);
        Self { origin, way, to_contact, behind, turning: turning(all, self::way(states, all)) }
    }

    /// From [`Self::origin`] to where `point` of the contact acts.
    pub(super) fn arm(&self, point: DVec3) -> DVec3 {
        point - self.way - self.origin
    }

    /// How far the second body moves relative to the first along the normal of `sample` (m) by the displacements that lead to the overlap
    /// that is taken to have been measured.
    ///
    /// Of a pair that was measured early, that includes what it slides from there on: how a bump goes on says nothing of
    /// those behind it.
    pub(super) fn moved(&self, sample: &ContactSample) -> f64 {
        let at = sample.point.as_dvec3() - self.way;
        let relative = |[a, b]: [Displacement; 2]| b.at(at) - a.at(at);
        let slides = self.behind.map_or(0.0, |behind| sliding(sample, relative(behind)));
        relative(self.to_contact).dot(sample.normal.as_dvec3()) + slides
    }
}

/// What a velocity, or a way, along the surfaces has along the normal of a sample: the spheres are bumps on them. The surfaces'
/// normal is the one that the spheres carry, where that agrees with the sample's.
pub(super) fn sliding(sample: &ContactSample, velocity: DVec3) -> f64 {
    let (normal, out) = (sample.normal, sample.outward);
    let out = if out.dot(normal) >= SAME_SURFACE { out.as_dvec3() } else { normal.as_dvec3() };
    (velocity - out * velocity.dot(out)).dot(normal.as_dvec3())
}

/// How far a contact goes with two bodies that have the given displacements (m).
///
/// Both must feel a force at one point, so that angular momentum is kept exactly, but their centres of mass move by different ways.
/// What that does to the torques falls to the body whose rotation it changes less.
fn way(states: [&SolverBody; 2], displacements: [Displacement; 2]) -> DVec3 {
    let ease = states.map(SolverBody::ease_of_turning);
    let total: f64 = ease.iter().sum();
    if total > 0.0 {
        displacements[0].translation() * (ease[0] / total)
            + displacements[1].translation() * (ease[1] / total)
    } else {
        DVec3::ZERO
    }
}

/// How far the second body seems to move relative to the first (m) at the velocities of the end of the step, where both turn as one.
///
/// Bodies go a step along the chords of their ways, and a contact is taken to be where it is before the step. With the places c of
/// the centres of mass, the angular velocity ω and the time step h that is `h² ω × (ω × (c_b − c_a)) / 2`; before the step, at the
/// velocities of the last chords, it is as much the other way. In a drum that presses on what is in it with its weight that is half of what
/// gravity moves a body by in a step. Each body sees the contact go by other ways than its own, and turns the
/// surface there:
///
/// `(θ_a × (w − w_a) − θ_b × (w − w_b)) / 2`
///
/// with the rotation vectors θ, the ways of the centres of mass and that of the contact, w.
fn turning(displacements: [Displacement; 2], way: DVec3) -> DVec3 {
    let [a, b] = displacements.map(|body| body.rotation().cross(way - body.translation()));
    0.5 * (a - b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::penalty::Screw;
    use rapier3d::glamx::{DQuat, Vec3};

    fn sample(normal: Vec3, outward: Vec3) -> ContactSample {
        ContactSample { point: Vec3::ZERO, normal, volume: 1.0, vector_area: normal, outward }
    }

    #[test]
    fn bodies_that_turn_as_one_part_by_what_is_told() {
        let (centers, axis) =
            ([DVec3::new(0.3, -1.0, 0.2), DVec3::new(-0.4, 0.5, 2.0)], DVec3::new(0.6, 0.0, 0.8));
        for angle in [0.01, 0.1] {
            let chord = |c: DVec3| DQuat::from_axis_angle(axis, angle) * c - c;
            let moved =
                centers.map(|c| Displacement::new(c, Screw { linear: chord(c), angular: axis * angle }));
            let place = DVec3::new(0.1, 0.7, -0.3);
            let parted = moved[1].at(place) - moved[0].at(place);
            for way in [DVec3::ZERO, moved[0].translation(), DVec3::splat(0.05)] {
                let error = (parted - turning(moved, way)).length();
                assert!(
                    error < angle.powi(3) && parted.length() > angle * angle / 2.0,
                    "{error} of {parted}"
                );
            }
        }
    }

    #[test]
    fn what_slides_up_a_bump_does_not_approach() {
        let (up, side) = (Vec3::Y, Vec3::new(0.6, 0.8, 0.0));
        let bump = sample(side, up);
        assert!((sliding(&bump, DVec3::X) - 0.6).abs() < 1e-6);
        assert!(sliding(&bump, DVec3::Y).abs() < 1e-6, "the surfaces approach");
        assert!(sliding(&sample(up, up), DVec3::new(1.0, 2.0, 3.0)).abs() < 1e-6, "no bump");
        for unknown in [Vec3::ZERO, -up, Vec3::X] {
            assert_eq!(sliding(&sample(up, unknown), DVec3::ONE), 0.0, "{unknown}");
        }
    }
}
