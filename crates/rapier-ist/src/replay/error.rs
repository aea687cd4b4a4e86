//! Why a recording is not replayed, or not to its end.

use std::fmt;
use std::io;
use std::path::PathBuf;

/// Why a file is not replayed at all.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The file cannot be read.
    #[error("cannot read the recording {}: {source}; name a file that exists and is readable", path.display())]
    Read {
        /// The file asked for.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// What was read is no MCAP file.
    #[error(
        "{origin} is no recording: it does not begin as an MCAP file does; name a file that a Recorder wrote"
    )]
    NotMcap {
        /// The file, or `the given data`.
        origin: String,
    },
}

/// How far a recording goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReplayEnd {
    /// To its end: it was finished.
    Complete,
    /// It stops in the middle, as that of a killed run does.
    Truncated {
        /// Size of what could be used (bytes).
        at: u64,
    },
    /// Something in it is not as it was written; what comes after that is left out.
    Damaged {
        /// Where the damaged part begins (bytes from the start).
        at: u64,
        /// What is wrong.
        what: String,
    },
}

impl fmt::Display for ReplayEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Complete => write!(f, "complete"),
            Self::Truncated { at } => write!(f, "cut off after byte {at}, as a killed run leaves it"),
            Self::Damaged { at, what } => {
                write!(f, "damaged from byte {at} on: {what}; copy it again or use what comes before")
            }
        }
    }
}
