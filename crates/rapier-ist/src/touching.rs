//! Which pairs are in contact from step to step.

use crate::report::key;
use crate::{ContactState, StepReport, WorldParts};
use rapier3d::geometry::ColliderHandle;

/// Pairs in contact after the last step, sorted by handles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Touching(Vec<[ColliderHandle; 2]>);

impl Touching {
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Compares the contacts of `report` with those of the step before, and writes there which are new and which
    /// have stopped.
    ///
    /// Pairs of which nothing is awake are not looked at by the step: they stay in contact as long as they exist.
    pub(crate) fn update(&mut self, world: &WorldParts<'_>, report: &mut StepReport) {
        for contact in &mut report.contacts {
            let known = self.0.binary_search_by_key(&key(contact.colliders()), |pair| key(*pair)).is_ok();
            contact.state = if known { ContactState::Persisted } else { ContactState::Started };
        }
        let StepReport { contacts, stopped, .. } = report;
        let now = |pair: &[ColliderHandle; 2]| {
            contacts.binary_search_by_key(&key(*pair), |contact| key(contact.colliders())).is_ok()
        };
        self.0.retain(|pair| {
            let gone = !now(pair);
            let kept = gone && asleep(world, *pair);
            if gone && !kept {
                stopped.push(*pair);
            }
            kept
        });
        self.0.extend(contacts.iter().map(|contact| contact.colliders()));
        self.0.sort_unstable_by_key(|pair| key(*pair));
    }
}

/// Whether both colliders take part in the simulation and the body of neither is awake.
pub(crate) fn asleep(world: &WorldParts<'_>, pair: [ColliderHandle; 2]) -> bool {
    pair.into_iter().all(|handle| {
        let Some(collider) = world.colliders.get(handle).filter(|collider| collider.is_enabled()) else {
            return false;
        };
        let body = collider.parent().and_then(|parent| world.bodies.get(parent));
        body.is_none_or(|body| body.is_enabled() && (body.is_fixed() || body.is_sleeping()))
    })
}
