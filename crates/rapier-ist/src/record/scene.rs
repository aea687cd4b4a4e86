//! The `/scene`: every body's mesh in one message.

use super::convert::timestamp;
use foxglove::messages::scene_entity_deletion::Type;
use foxglove::messages::{SceneEntity, SceneEntityDeletion, SceneUpdate};

/// The meshes of all bodies, and whether the file has them yet.
///
/// They go into one message, not one per body, and again into one when a body comes or goes: a viewer that jumps
/// to a later time gets no more than the last message of a topic.
#[derive(Default)]
pub(super) struct Scene {
    update: SceneUpdate,
    changed: bool,
}

impl Scene {
    pub(super) fn add(&mut self, entity: SceneEntity) {
        self.update.entities.push(entity);
        self.changed = true;
    }

    /// Removes the mesh of the body `name`.
    pub(super) fn remove(&mut self, name: &str) {
        let before = self.update.entities.len();
        self.update.entities.retain(|entity| entity.id != name);
        self.changed |= self.update.entities.len() != before;
    }

    /// The message that replaces whatever the topic showed before, if something changed since the last call.
    pub(super) fn take_update(&mut self, time: u64) -> Option<&SceneUpdate> {
        if !std::mem::take(&mut self.changed) {
            return None;
        }
        self.update.deletions = vec![SceneEntityDeletion {
            timestamp: Some(timestamp(time)),
            r#type: Type::All as i32,
            id: String::new(),
        }];
        Some(&self.update)
    }
}
