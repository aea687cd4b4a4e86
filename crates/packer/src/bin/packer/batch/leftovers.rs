//! Temporary files of killed runs.
//!
//! The name of a temporary file holds the hash of the path of the mesh it was for. A run removes those of its own
//! shard only, and so leaves alone what the other shards are writing. Should the same shard run twice at once, by
//! mistake or because a cluster thought it dead, the one whose file was taken away writes it again
//! (`output::write_tagged`).

use super::shard::{Shard, hash_of_tag};
use crate::output::UNFINISHED;
use anyhow::Context;
use std::io::ErrorKind;
use std::path::Path;
use walkdir::WalkDir;

/// Removes what earlier runs of `shard` left unfinished below `folder`.
pub(super) fn remove(folder: &Path, shard: Shard) -> anyhow::Result<()> {
    // What cannot be listed holds nothing that this run could write either: its outputs will say so.
    for entry in WalkDir::new(folder).into_iter().filter_map(Result::ok) {
        let hash =
            entry.file_name().to_str().and_then(|name| name.strip_prefix(UNFINISHED)).and_then(hash_of_tag);
        let is_ours = entry.file_type().is_file() && hash.is_some_and(|hash| shard.owns(hash));
        if !is_ours {
            continue;
        }
        match std::fs::remove_file(entry.path()) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(error).with_context(|| {
                    format!("cannot remove the unfinished file {}", entry.path().display())
                });
            }
            _ => {}
        }
    }
    Ok(())
}
