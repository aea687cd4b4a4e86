//! How much the plugin remembers.

/// Entries of the tables that [`IstPlugin`](crate::IstPlugin) keeps from step to step.
///
/// What is gone from the world is forgotten in the next step, so that a world to which bodies come and from which they go can
/// run for ever.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Remembered {
    /// Pairs of colliders whose forces are known: those that touched in the last step.
    pub pairs: usize,
    /// Pairs of colliders in contact, those asleep included.
    pub touching: usize,
    /// Colliders with a stiffness of their own.
    pub stiffnesses: usize,
    /// Triangle meshes that bodies are near.
    pub meshes: usize,
}

impl Remembered {
    /// Entries of all tables.
    #[must_use]
    pub fn total(&self) -> usize {
        self.pairs + self.touching + self.stiffnesses + self.meshes
    }
}
