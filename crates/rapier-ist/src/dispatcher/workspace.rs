//! Memory of the dispatcher's queries.

use super::patch::Patch;
use super::regions::Regions;
use ist::{ContactSample, OverlapWorkspace, ProximityWorkspace};
use std::cell::RefCell;

/// Scratch memory of one thread.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    pub(super) overlap: OverlapWorkspace,
    pub(super) proximity: ProximityWorkspace,
    pub(super) samples: Vec<ContactSample>,
    pub(super) regions: Regions,
    pub(super) patches: Vec<Patch>,
}

thread_local! {
    /// The dispatcher's methods take no workspace, and a query must not allocate.
    static WORKSPACE: RefCell<Workspace> = RefCell::default();
}

/// Runs `query` with this thread's memory; with fresh memory inside of another query.
pub(super) fn with_workspace<T>(query: impl FnOnce(&mut Workspace) -> T) -> T {
    WORKSPACE.with(|workspace| match workspace.try_borrow_mut() {
        Ok(mut workspace) => query(&mut workspace),
        Err(_) => query(&mut Workspace::default()),
    })
}
