//! How long a thread has waited for a processor, so that a slow measurement can be told from an interrupted one.

use std::fs::File;

/// The calling thread's time in the queue of the scheduler, from `/proc/thread-self/schedstat`.
#[derive(Debug)]
pub struct Waiting(Option<File>);

impl Waiting {
    /// For the calling thread. Where the system does not tell, all times are zero.
    #[must_use]
    pub fn of_this_thread() -> Self {
        Self(File::open("/proc/thread-self/schedstat").ok())
    }

    /// Whether the system tells.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.0.is_some()
    }

    /// Microseconds since the thread began during which it could have run and did not.
    #[must_use]
    pub fn microseconds(&self) -> f64 {
        // "time on a processor, time in the queue, number of turns", in nanoseconds.
        self.0.as_ref().and_then(read).map_or(0.0, |nanoseconds| nanoseconds as f64 * 1e-3)
    }
}

#[cfg(unix)]
fn read(file: &File) -> Option<u64> {
    use std::os::unix::fs::FileExt;
    let mut text = [0; 96];
    let len = file.read_at(&mut text, 0).ok()?;
    std::str::from_utf8(&text[..len]).ok()?.split_whitespace().nth(1)?.parse().ok()
}

#[cfg(not(unix))]
fn read(_: &File) -> Option<u64> {
    None
}
