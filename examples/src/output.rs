//! What the examples leave behind: an exit status, and files that are there as a whole or not at all.

use anyhow::{Context, Result, ensure};
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

/// Exit status of an example: 0, or 2 after telling what was wrong.
#[must_use]
pub fn exit_code(result: Result<()>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Refuses a path that cannot be written, before any work is done for it.
///
/// # Errors
/// Names the folder that is missing.
pub fn check_folder_of(path: &Path) -> Result<()> {
    let folder = folder_of(path);
    ensure!(
        folder.is_dir(),
        "cannot write {}: the folder {} does not exist; create it first",
        path.display(),
        folder.display()
    );
    ensure!(!path.is_dir(), "cannot write {}: it is a folder; name a file in it", path.display());
    Ok(())
}

/// Writes `bytes` to a temporary file beside `path` and renames it.
///
/// # Errors
/// Where the folder cannot be written or the disk is full; `path` is then as it was.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let write = || -> Result<()> {
        let mut file = tempfile::NamedTempFile::new_in(folder_of(path))?;
        file.write_all(bytes)?;
        file.persist(path)?;
        Ok(())
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
