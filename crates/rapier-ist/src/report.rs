//! What the plugin says about the contacts of a step.

use rapier3d::geometry::ColliderHandle;
use rapier3d::math::{Real, Vector};

/// All volume contacts of one step; with [`crate::IstPlugin::substeps`], of its last substep.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct StepReport {
    /// One entry per pair of colliders that overlap, sorted by handles. Forces on a body add up to what changed its velocity,
    /// except between bodies whose contacts were too stiff to be solved, as in packings of coincident spheres.
    pub contacts: Vec<PairContact>,
    /// The parts of [`Self::contacts`] that push in about the same direction, sorted by pair. A body in a groove has
    /// two patches. Forces of the patches of a pair add up to the pair's, and so do volumes.
    pub patches: Vec<PatchContact>,
    /// Pairs that were in contact in the step before and no longer are, sorted by handles: separated, removed,
    /// disabled, or no longer allowed to touch. Pairs that fell asleep have not stopped.
    pub stopped: Vec<[ColliderHandle; 2]>,
    /// Pairs whose overlap was looked for: their boxes meet, they may collide, and one of them is awake. With
    /// [`crate::IstPlugin::substeps`], the sum over all of them.
    pub candidates: usize,
    /// Whether the world's query dispatcher did not know [`crate::IstShape`] and was replaced; see
    /// [`crate::IstPlugin::step_parts`].
    pub dispatcher_replaced: bool,
    /// Wall time of the search for candidates and of the overlap queries (s).
    pub query_seconds: f64,
    /// Wall time of the penalty solve (s).
    pub solve_seconds: f64,
    /// Wall time of the whole step, Rapier's part included (s).
    pub step_seconds: f64,
}

/// Whether a contact is new.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ContactState {
    /// The pair was not in contact in the step before.
    #[default]
    Started,
    /// It was.
    Persisted,
}

/// Contact between two overlapping colliders, world frame. Volume and depth are those at the poses of the solve, which
/// lie in the step; the centroid is moved back to its start with the bodies' centres of mass.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct PairContact {
    /// The collider with the smaller handle.
    pub collider_a: ColliderHandle,
    /// The other collider.
    pub collider_b: ColliderHandle,
    /// Whether the contact is new.
    pub state: ContactState,
    /// Overlap volume (m³), counted from where contact begins, as in
    /// [`flush_contact_samples`](ist::InnerSphereTree::flush_contact_samples).
    pub volume: f32,
    /// The greatest [depth](PatchContact::depth) of a patch (m).
    pub depth: f32,
    /// Centroid of the overlap (m).
    pub centroid: Vector,
    /// Mean force on B during the step (N).
    pub force: Vector,
    /// Mean torque on B about [`Self::centroid`] (N·m).
    pub torque: Vector,
    /// Velocity of B relative to A at the centroid before the step (m/s).
    pub relative_velocity: Vector,
}

/// The part of a contact that pushes in about the same direction, world frame.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct PatchContact {
    /// Index of its pair in [`StepReport::contacts`].
    pub pair: usize,
    /// Overlap volume (m³).
    pub volume: f32,
    /// Penetration depth V/A (m), with A the patch's cross-section, which is the derivative of V by the way, and at
    /// most the extent of the overlap along the patch's push: a body wholly inside another has no cross-section.
    pub depth: f32,
    /// Centroid of this part of the overlap (m).
    pub centroid: Vector,
    /// Direction in which it pushes B, friction aside, of unit length; zero where it does not push.
    pub normal: Vector,
    /// Mean force on B during the step (N).
    pub force: Vector,
    /// Mean torque on B about [`Self::centroid`] (N·m).
    pub torque: Vector,
    /// Velocity of B relative to A at the centroid before the step (m/s).
    pub relative_velocity: Vector,
}

impl StepReport {
    /// The patches of the pair at `index` in [`Self::contacts`]; none where there is no such pair. O(log n).
    #[must_use]
    pub fn patches_of(&self, index: usize) -> &[PatchContact] {
        let from = self.patches.partition_point(|patch| patch.pair < index);
        let to = self.patches.partition_point(|patch| patch.pair <= index);
        &self.patches[from..to]
    }

    /// The contact of two colliders, in any order. O(log n).
    #[must_use]
    pub fn contact(&self, a: ColliderHandle, b: ColliderHandle) -> Option<&PairContact> {
        let pair = key(if a.into_raw_parts() < b.into_raw_parts() { [a, b] } else { [b, a] });
        let index = self.contacts.binary_search_by_key(&pair, |contact| key(contact.colliders())).ok()?;
        self.contacts.get(index)
    }

    /// Forgets everything and keeps the memory.
    pub(crate) fn clear(&mut self) {
        let mut cleared = Self {
            contacts: std::mem::take(&mut self.contacts),
            patches: std::mem::take(&mut self.patches),
            stopped: std::mem::take(&mut self.stopped),
            ..Self::default()
        };
        cleared.clear_contacts();
        cleared.stopped.clear();
        *self = cleared;
    }

    pub(crate) fn clear_contacts(&mut self) {
        self.contacts.clear();
        self.patches.clear();
    }
}

impl PairContact {
    /// Both colliders, the smaller handle first.
    #[must_use]
    pub fn colliders(&self) -> [ColliderHandle; 2] {
        [self.collider_a, self.collider_b]
    }
}

impl PatchContact {
    /// The part of [`Self::force`] along [`Self::normal`] (N); the rest is friction.
    #[must_use]
    pub fn normal_force(&self) -> Real {
        self.force.dot(self.normal)
    }
}

/// Order of pairs in reports.
pub(crate) fn key(pair: [ColliderHandle; 2]) -> [(u32, u32); 2] {
    pair.map(ColliderHandle::into_raw_parts)
}
