//! What can go wrong while recording.

use std::io;
use std::path::PathBuf;

/// Why a recording cannot be made or continued.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The file cannot be created.
    #[error("cannot create the recording {}: {source}; choose a folder that exists and is writable", path.display())]
    Create {
        /// The file asked for.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// Writing failed, for example because the disk is full.
    #[error(
        "cannot write to {target}: {source}; what was written before stays readable, record to another place"
    )]
    Write {
        /// The file, or `the given writer`.
        target: String,
        /// What the operating system said.
        source: io::Error,
    },
    /// A body's description cannot be drawn.
    #[error("body `{name}`: {what}")]
    Body {
        /// The name it was described with.
        name: String,
        /// What is wrong with it, and what to do.
        what: &'static str,
    },
}
