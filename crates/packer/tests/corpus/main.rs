//! Broken and extreme meshes and files. Each ends in its named error or in a packing that is certified against the
//! mesh by brute force; none panics, hangs, or leaves a partly written file.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

#[path = "../common/mod.rs"]
mod common;

mod certificate;
mod files;
mod meshes;
mod random;
mod shapes;

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// Most that any case may take. A guard against hanging: all but a few take milliseconds.
const PATIENCE: Duration = Duration::from_secs(60);

/// Runs `case` on a thread of its own; its panic or its hanging is the failure of the test, with its name.
fn guarded<T: Send + 'static>(name: &str, case: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = channel();
    let thread = std::thread::spawn(move || {
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(case));
        // Nobody listens any more where the case took too long.
        let _ = sender.send(result);
    });
    match receiver.recv_timeout(PATIENCE) {
        Ok(Ok(value)) => {
            thread.join().unwrap();
            value
        }
        Ok(Err(_)) => panic!("{name}: panicked"),
        Err(RecvTimeoutError::Timeout) => panic!("{name}: still running after {PATIENCE:?}"),
        Err(RecvTimeoutError::Disconnected) => panic!("{name}: ended without a result"),
    }
}

/// Name of the variant of an error.
fn variant(error: &impl std::fmt::Debug) -> String {
    let text = format!("{error:?}");
    text.split([' ', '(', '{']).next().unwrap_or_default().to_owned()
}
