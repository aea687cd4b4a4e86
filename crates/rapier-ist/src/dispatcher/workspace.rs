//! Memory of the plugin's and the dispatcher's queries.

use super::patch::Patch;
use super::regions::Regions;
use ist::{ContactSample, OverlapWorkspace, ProximityWorkspace};
use std::cell::RefCell;

/// Scratch memory of one thread.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    pub(crate) overlap: OverlapWorkspace,
    pub(super) proximity: ProximityWorkspace,
    pub(super) samples: Vec<ContactSample>,
    pub(super) regions: Regions,
    pub(super) patches: Vec<Patch>,
}

thread_local! {
    /// The dispatcher's methods take no workspace, and a query must not allocate. Nor can the plugin hand one to each of the threads
    /// that share its pairs: made anew for every share, workspaces took 4 % of the queries' time.
    static WORKSPACE: RefCell<Workspace> = RefCell::default();
}

/// Runs `query` with this thread's memory; with fresh memory inside of another query.
pub(crate) fn with_workspace<T>(query: impl FnOnce(&mut Workspace) -> T) -> T {
    WORKSPACE.with(|workspace| match workspace.try_borrow_mut() {
        Ok(mut workspace) => query(&mut workspace),
        Err(_) => query(&mut Workspace::default()),
    })
}
