//! Contacts of a step: as data and as force arrows.

use super::WORLD_FRAME;
use super::convert::{color, quaternion, timestamp, vector};
use super::messages::{Contact, Contacts, Patch};
use crate::{PairContact, PatchContact, StepReport};
use foxglove::messages::{ArrowPrimitive, Pose, SceneEntity, SceneUpdate};
use rapier3d::math::{Rotation, Vector};

/// Vermilion: apart from every colour of the usual palettes.
const ARROW_COLOR: [f32; 4] = [0.84, 0.37, 0.0, 1.0];
/// An arrow longer than this many body radii would hide the scene it explains.
const MAX_ARROW_RADII: f64 = 8.0;

/// How forces become arrows.
#[derive(Clone, Copy)]
pub(super) struct ArrowScale {
    /// Arrow length per force (m/N).
    pub(super) length_per_newton: f64,
    /// Mean radius of the bodies (m), which sets the thickness.
    pub(super) body_radius: f64,
}

/// The contacts that can be written, with their places in the report.
pub(super) fn finite_contacts(report: &StepReport) -> impl Iterator<Item = (usize, &PairContact)> {
    report.contacts.iter().enumerate().filter(|(_, contact)| is_finite(contact))
}

/// Whether every number of the contact can be written.
fn is_finite(contact: &PairContact) -> bool {
    let vectors = [contact.centroid, contact.force, contact.torque, contact.relative_velocity];
    contact.volume.is_finite() && contact.depth.is_finite() && vectors.iter().all(|v| v.is_finite())
}

/// The contacts as data, each with its patches, bodies named by `name`.
pub(super) fn contact_list(
    report: &StepReport,
    name: impl Fn(rapier3d::geometry::ColliderHandle) -> String,
) -> Contacts {
    let contact = |(index, contact): (usize, &PairContact)| Contact {
        body_a: name(contact.collider_a),
        body_b: name(contact.collider_b),
        volume: contact.volume.into(),
        depth: contact.depth.into(),
        centroid: Some(vector(contact.centroid)),
        force: Some(vector(contact.force)),
        torque: Some(vector(contact.torque)),
        relative_velocity: Some(vector(contact.relative_velocity)),
        patches: report.patches_of(index).iter().filter_map(patch).collect(),
    };
    Contacts { contacts: finite_contacts(report).map(contact).collect() }
}

/// The patch as data; none for one that is not finite.
fn patch(patch: &PatchContact) -> Option<Patch> {
    let vectors = [patch.centroid, patch.force, patch.torque, patch.relative_velocity];
    let finite = patch.volume.is_finite() && patch.depth.is_finite() && vectors.iter().all(|v| v.is_finite());
    finite.then(|| Patch {
        volume: patch.volume.into(),
        depth: patch.depth.into(),
        centroid: Some(vector(patch.centroid)),
        force: Some(vector(patch.force)),
        torque: Some(vector(patch.torque)),
        relative_velocity: Some(vector(patch.relative_velocity)),
    })
}

/// The forces on the second bodies as arrows from the centroids.
///
/// The entity's name never changes, so each step's arrows replace those of the step before, also by none.
pub(super) fn force_arrows(report: &StepReport, scale: ArrowScale, time: u64) -> SceneUpdate {
    let entity = SceneEntity {
        timestamp: Some(timestamp(time)),
        frame_id: WORLD_FRAME.to_owned(),
        id: "contact forces".to_owned(),
        arrows: finite_contacts(report).filter_map(|(_, contact)| arrow(contact, scale)).collect(),
        ..Default::default()
    };
    SceneUpdate { deletions: Vec::new(), entities: vec![entity] }
}

/// One arrow; none for a force of zero.
fn arrow(contact: &PairContact, scale: ArrowScale) -> Option<ArrowPrimitive> {
    let direction = contact.force.try_normalize()?;
    let radius = scale.body_radius;
    let length = (f64::from(contact.force.length()) * scale.length_per_newton).min(MAX_ARROW_RADII * radius);
    // The head keeps its size until the arrow is too short for it.
    let head_length = (0.3 * radius).min(0.5 * length);
    // An arrow without rotation points along +x.
    let rotation = Rotation::from_rotation_arc(Vector::X, direction);
    Some(ArrowPrimitive {
        pose: Some(Pose {
            position: Some(vector(contact.centroid)),
            orientation: Some(quaternion(rotation)),
        }),
        shaft_length: length - head_length,
        shaft_diameter: 0.06 * radius,
        head_length,
        head_diameter: 0.15 * radius,
        color: Some(color(ARROW_COLOR)),
    })
}
