//! Compression and writing on a thread of its own.

use super::file::{Entry, McapFile, Written};
use std::io::{self, Seek, Write};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::{self, JoinHandle};

/// Entries that may wait for the thread. A step puts up to four: 64 are a quarter of a second at 60 Hz.
const QUEUE: usize = 64;

/// The thread that owns the file. Entries reach it in order, so the file's bytes are those that a file written on
/// the calling thread would have.
pub(super) struct Background {
    /// `None` once the thread has ended or is being waited for.
    entries: Option<SyncSender<Entry>>,
    /// Buffers of written messages, to be filled again.
    emptied: Receiver<Vec<u8>>,
    thread: Option<JoinHandle<io::Result<Written>>>,
}

impl Background {
    pub(super) fn spawn<W: Write + Seek + Send + 'static>(file: McapFile<W>) -> io::Result<Self> {
        let (entries, queue) = sync_channel(QUEUE);
        let (emptied_by_thread, emptied) = channel();
        let thread = thread::Builder::new()
            .name("rapier-ist recorder".into())
            .spawn(move || write_all(file, &queue, &emptied_by_thread))?;
        Ok(Self { entries: Some(entries), emptied, thread: Some(thread) })
    }

    /// Puts an entry into the queue; waits while the queue is full.
    ///
    /// An error of the file comes with one of the calls after the entry that caused it.
    pub(super) fn put(&mut self, entry: Entry) -> io::Result<()> {
        let queued = self.entries.as_ref().is_some_and(|entries| entries.send(entry).is_ok());
        if queued { Ok(()) } else { self.join().map(|_| ()) }
    }

    /// An emptied buffer, if there is one.
    pub(super) fn spare_buffer(&self) -> Option<Vec<u8>> {
        self.emptied.try_recv().ok()
    }

    /// Ends the queue, waits until it is written and completes the file.
    pub(super) fn join(&mut self) -> io::Result<Written> {
        self.entries = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) => Err(io::Error::other("the thread that writes the recording panicked")),
            None => Err(io::Error::other("the thread that writes the recording has ended")),
        }
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        // Without it the process could end before the file is complete. Who drops a recorder asks for no errors.
        let _ = self.join();
    }
}

/// The thread: writes until the queue ends, then completes the file; ends early on an error, which closes the queue.
fn write_all<W: Write + Seek>(
    mut file: McapFile<W>,
    queue: &Receiver<Entry>,
    emptied: &Sender<Vec<u8>>,
) -> io::Result<Written> {
    for entry in queue {
        file.put(&entry)?;
        if let Entry::Message { data, .. } = entry {
            // Nobody takes buffers back any more while the recorder is being finished.
            let _ = emptied.send(data);
        }
    }
    file.finish()
}
